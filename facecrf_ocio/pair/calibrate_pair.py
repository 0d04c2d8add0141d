"""Start here: linear and encoded picture of one exposure in, the camera's response out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.checks import typed
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.pair.align import MIN_CORRELATION, Aligned, align
from facecrf_ocio.pair.continue_alike import SEEN, continued_alike
from facecrf_ocio.pair.extrapolate import continued
from facecrf_ocio.pair.fit_channel import ChannelFit, fit_channel
from facecrf_ocio.pair.flat_pixels import Samples, choose_samples
from facecrf_ocio.pair.pair_confidence import pair_confidence
from facecrf_ocio.photo.camera_picture import camera_picture
from facecrf_ocio.photo.given import GivenPhoto, photo_given
from facecrf_ocio.response.model import CURVE_SIZE, ResponseModel, dorf_model, strictly_increasing
from facecrf_ocio.values import (
    CHANNELS,
    Estimate,
    Float,
    InverseCRF,
    Outcome,
    Photo,
)
from facecrf_ocio.wording.assumption_words import RELATIVE_TO_WHITE, primaries_assumed

MIN_SAMPLES = 300  # [px] eight for each unknown of a channel's fit
MIN_SPAN = 0.25
"""Codes that the samples must span to tell of a curve."""
MAX_RESIDUAL_CODES = 12.0  # [8-bit code] beyond which one curve does not explain the pair
_ANOTHER = "give the two pictures of one exposure, neither of them retouched"


@dataclass(frozen=True, slots=True, eq=False)
class PairEstimate:
    """The response of a camera and how it was found.

    Attributes
    ----------
    estimate
        As `calibrate` gives it; its band is the residual of the fit.
    matrix
        (3, 3) gains and color matrix that the camera applied to `linear` before its curve.
    residual_codes
        Per channel, robust standard deviation of the residual in 8-bit code values.
    aligned
        The two pictures on one grid.
    """

    estimate: Estimate
    matrix: Float
    residual_codes: tuple[float, float, float]
    aligned: Aligned


@typed
def calibrate_pair(
    linear: GivenPhoto, encoded: GivenPhoto | None = None, *, model: ResponseModel | None = None
) -> PairEstimate:
    """Fit the inverse camera response that leads from one picture to the other.

    Parameters
    ----------
    linear
        Linear light, taken as such whatever the file says of itself; camera raw or a linear image.
        As `calibrate` takes photos, and so is `encoded`.
    encoded
        What the camera made of the same exposure. Size, crop, orientation and lens
        correction may differ. The picture in the raw file (`camera_picture`) by default.
    model
        Response model, for the shape and the band where the pictures have no values.

    Raises
    ------
    PhotoError
        If they are not linear and encoded pictures of one exposure, or too much is clipped.
    """
    model = model or dorf_model()
    linear = photo_given(linear)
    encoded = _picture_beside(linear) if encoded is None else photo_given(encoded)
    _check_kinds(linear, encoded)
    aligned = align(linear, encoded)
    if aligned.correlation < MIN_CORRELATION:
        raise _mismatch(
            linear, encoded, f"their contents agree by {aligned.correlation:.2f} of 1 only"
        )
    samples = choose_samples(aligned)
    _check_samples(encoded, samples)
    fits = continued_alike([_fit(samples[c], c, model) for c in range(3)], samples, model)
    red, green, blue = (fit.residual_codes for fit in fits)
    worst = max(red, green, blue)
    if worst > MAX_RESIDUAL_CODES:
        raise _mismatch(linear, encoded, f"no curve joins them, it is {worst:.0f} codes of 255 off")
    matrix = np.array([fit.mixing for fit in fits])
    found = InverseCRF(
        np.linspace(0.0, 1.0, CURVE_SIZE), strictly_increasing([fit.linear for fit in fits])
    )
    estimate = Estimate(
        Outcome.CALIBRATED,
        "pair",
        f"fitted to {sum(len(s.encoded) for s in samples)} samples of a linear picture, "
        f"residual R {red:.1f} G {green:.1f} B {blue:.1f} codes of 255",
        found=found,
        confidence=pair_confidence(samples, fits, found),
        assumptions=_assumptions(encoded, matrix),
    )
    return PairEstimate(estimate, matrix, (red, green, blue), aligned)


def _picture_beside(linear: Photo) -> Photo:
    if linear.path is None:
        raise PhotoError(None, "has no file that could hold the camera's picture", _ANOTHER)
    return camera_picture(linear.path)


def _fit(samples: Samples, channel: int, model: ResponseModel) -> ChannelFit:
    """Fit twice, the second time with a typical curve that resembles what the first has found."""
    first = fit_channel(samples, channel, model.mean, model.grid.size)
    low, high = np.quantile(samples.encoded, SEEN)
    seen = (model.grid >= low) & (model.grid <= high)
    return fit_channel(samples, channel, continued(first.linear, seen, model), CURVE_SIZE)


def _check_kinds(linear: Photo, encoded: Photo) -> None:
    if linear.bit_depth is not None and linear.bit_depth < 10:
        raise PhotoError(
            linear.path,
            f"has {linear.bit_depth} bits, too coarse for linear light",
            "give the camera raw file, an EXR or a linear 16-bit TIFF first, the JPEG second",
        )
    if encoded.scene_linear:
        raise PhotoError(
            encoded.path,
            "is scene-linear, so it has no response to find",
            "give the camera raw file or linear image first, the camera's JPEG second",
        )


def _check_samples(encoded: Photo, samples: tuple[Samples, Samples, Samples]) -> None:
    for channel, chosen in zip(CHANNELS, samples, strict=True):
        if len(chosen.encoded) < MIN_SAMPLES or np.ptp(chosen.encoded) < MIN_SPAN:
            span = float(np.ptp(chosen.encoded)) if len(chosen.encoded) else 0.0
            raise PhotoError(
                encoded.path,
                f"has {len(chosen.encoded)} usable samples in {channel}, over {span:.2f} of the "
                "code values, which is too few to see a curve",
                "use a pair with light and dark areas, not clipped",
            )


def _mismatch(linear: Photo, encoded: Photo, evidence: str) -> PhotoError:
    name = "the linear one" if linear.path is None else linear.path.name
    return PhotoError(encoded.path, f"is not the picture that {name} shows ({evidence})", _ANOTHER)


def _assumptions(encoded: Photo, matrix: Float) -> tuple[str, ...]:
    rows = "; ".join(" ".join(f"{value:.4f}" for value in row) for row in matrix)
    return (
        primaries_assumed(encoded.primaries),
        RELATIVE_TO_WHITE,
        "the camera applied a 3 x 3 matrix and one curve per channel, alike over the whole photo; "
        f"rows of the matrix: {rows}",
    )
