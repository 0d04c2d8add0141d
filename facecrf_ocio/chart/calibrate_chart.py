"""Start here: a photo of a color chart in, the camera's response out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from facecrf_ocio.chart.find_chart import by_corners, can_find, find_chart, turned
from facecrf_ocio.chart.fit_grays import GLARE, GrayFit, Grays, fit_grays
from facecrf_ocio.chart.light_field import log_light
from facecrf_ocio.chart.patches import Patches, glance, measure_patches
from facecrf_ocio.chart.reflectances import EDITIONS, GRAYS, reflectances
from facecrf_ocio.errors import PhotoError, SettingsError
from facecrf_ocio.joint.metadata import modern_leaning, phone_leaning
from facecrf_ocio.joint.prior import FamilyPrior, shipped_prior
from facecrf_ocio.joint.verdict import doubted, judge
from facecrf_ocio.response.coverage import coverage_at, coverage_counts
from facecrf_ocio.response.expected_stops import verdict_of
from facecrf_ocio.response.model import inverse_crf
from facecrf_ocio.values import (
    CHANNELS,
    Confidence,
    Estimate,
    Float,
    InStops,
    InverseCRF,
    Outcome,
    Photo,
)
from facecrf_ocio.wording.assumption_words import RELATIVE_TO_WHITE
from facecrf_ocio.wording.doubts import bent_by

FEWEST_GRAYS = 4
"""Patches of the gray row that must be neither clipped nor drowned, in every channel."""
LEAST_LIKENESS = 0.8
"""Correlation of log2 light, over all patches and channels, below which it is no such chart. Of
charts in light of any color it is 0.9 and more."""
MOST_RESIDUAL = 0.15
"""[stop] beyond which no curve joins the grays."""
MOST_UNUSUAL = 4.0
"""Root mean square of a channel's coefficients, which responses have 1 of, beyond which the grays
bend a curve that no camera has. Of 164 photos of charts by 46 models the farthest is at 3.0, of
charts with two grays spoiled all are above 5."""
_ROUNDS = 4  # between the curve and the light that falls on the chart
_REMEDY = (
    "photograph a ColorChecker Classic in even light, its white patch not clipped, all of it in "
    "the picture and 100 px wide or more, or give the corners of its patches, corners_xy=..."
)


@dataclass(frozen=True, slots=True, eq=False)
class ChartEstimate:
    """The response of a camera by a chart.

    Attributes
    ----------
    estimate
        As `calibrate` gives it; not calibrated where the grays do not tell.
    homography
        (3, 3) from the chart's grid to pixels, the gray row being its last.
    patches
        What they show.
    light
        (24,) log2 of the light on each patch.
    """

    estimate: Estimate
    homography: Float
    patches: Patches
    light: Float


def calibrate_chart(
    photo: Photo,
    corners_xy: npt.ArrayLike | None = None,
    *,
    edition: str = EDITIONS[0],
    prior: FamilyPrior | None = None,
) -> ChartEstimate:
    """Find the inverse camera response from the gray row of a ColorChecker Classic.

    Parameters
    ----------
    photo
        Encoded by its camera.
    corners_xy
        (4, 2) [px] outer corners of the four patches in the chart's corners, around it from any
        one; found by OpenCV without them.
    edition
        When the chart was made, one of `EDITIONS`.
    prior
        The shipped one by default.

    Raises
    ------
    PhotoError
        If there is no chart, or the photo is linear.
    SettingsError
        If the edition is not known.
    """
    if edition not in EDITIONS:
        raise SettingsError(f"no edition {edition!r}; known: {', '.join(EDITIONS)}")
    if photo.scene_linear or photo.named_curve:
        what = "is scene-linear" if photo.scene_linear else f"names its curve ({photo.named_curve})"
        raise PhotoError(photo.path, f"{what}, so it has no response to find", "give a JPEG")
    homography, patches = _chart(photo, _place(photo, corners_xy), reflectances(edition))
    prior = prior or shipped_prior()
    if patches.usable[GRAYS].sum(axis=0).min() < FEWEST_GRAYS:
        problem = f"fewer than {FEWEST_GRAYS} grays are neither clipped nor drowned"
        return ChartEstimate(_not_calibrated(problem), homography, patches, np.zeros(24))
    fit, found, light = _solve(photo, patches, reflectances(edition), prior)
    coefficients = np.array([one.mean for one in fit.channels])
    unlike = f"they are {fit.residual:.2f} stops off" if fit.residual > MOST_RESIDUAL else ""
    if not unlike and np.sqrt((coefficients**2).mean(axis=1)).max() > MOST_UNUSUAL:
        unlike = "it would be unlike every known response"
    if unlike:
        problem = f"no curve joins the grays, {unlike}"
        return ChartEstimate(_not_calibrated(problem), homography, patches, light)
    fall = float(np.ptp(light[GRAYS]))
    estimate = Estimate(
        Outcome.CALIBRATED,
        "chart",
        f"the gray row of a ColorChecker Classic, residual {fit.residual:.3f} stops",
        found=found,
        confidence=doubted(_confidence(fit, found, patches, prior), bent_by(photo.adapted)),
        coefficients=coefficients,
        assumptions=(
            RELATIVE_TO_WHITE,
            f"the patches reflect what X-Rite published for charts of {_made(edition)}",
            f"light differs by {fall:.2f} stops along the gray row, by slopes within the patches",
        ),
    )
    return ChartEstimate(estimate, homography, patches, light)


def _made(edition: str) -> str:
    return "November 2014 and later" if edition == EDITIONS[0] else "before November 2014"


def _place(photo: Photo, corners_xy: npt.ArrayLike | None) -> Float:
    if corners_xy is not None:
        corners = np.asarray(corners_xy, np.float64)
        if corners.shape != (4, 2) or not np.isfinite(corners).all():
            raise SettingsError("a chart has four corners, each x and y in pixels")
        return by_corners(corners)
    found = find_chart(photo.encoded)
    if found is None:
        what = "shows no chart of 24 patches" if can_find() else "shows a chart that nobody found"
        why = "" if can_find() else " (the installed OpenCV has no detector)"
        raise PhotoError(photo.path, what + why, _REMEDY)
    return found


def _chart(photo: Photo, place: Float, known: Float) -> tuple[Float, Patches]:
    """The way of four, a homography (3, 3), in which patches look most like (24, 3) known light."""
    seen = [(way, glance(photo.encoded, way)) for way in turned(place)]
    likely = [(_likeness(codes, known), way) for way, codes in seen if codes is not None]
    likeness, chosen = max(likely, key=lambda one: one[0], default=(-1.0, None))
    if chosen is not None and likeness < LEAST_LIKENESS:
        raise PhotoError(
            photo.path,
            f"shows something else there than a ColorChecker Classic (likeness {likeness:.2f})",
            _REMEDY,
        )
    patches = None if chosen is None else measure_patches(photo.encoded, chosen)
    if chosen is None or patches is None:
        raise PhotoError(photo.path, "shows the chart cut off or too small", _REMEDY)
    return chosen, patches


def _likeness(codes: Float, known: Float) -> float:
    """Mean correlation of codes (24, 3) with log2 light (24, 3) of a chart, over the channels."""
    stops, spread = np.log2(np.maximum(known, 0.02)), codes.std(axis=0)
    if spread.min() == 0.0:
        return -1.0
    rows = [np.corrcoef(codes[:, c], stops[:, c])[0, 1] for c in range(len(CHANNELS))]
    return float(np.mean(rows))


def _solve(
    photo: Photo, patches: Patches, known: Float, prior: FamilyPrior
) -> tuple[GrayFit, InverseCRF, Float]:
    """The curve and log2 light on the 24 patches, in turn: each needs the other."""
    leanings = modern_leaning(photo.camera, photo.primaries), phone_leaning(photo.camera)
    weights = prior.weights_for("auto", *leanings)
    roots = np.tile(prior.roots(weights @ prior.means), (len(CHANNELS), 1))
    light: Float = np.zeros(24)
    for _ in range(_ROUNDS):
        fit = fit_grays(_grays(patches, known, light), prior, weights, roots)
        coefficients = np.array([one.mean for one in fit.channels])
        found = inverse_crf(prior.grid, prior.samples(coefficients))
        roots = np.array([np.interp(prior.grid, found.encoded, np.sqrt(r)) for r in found.linear])
        light = log_light(patches, found)
    return fit, found, light


def _grays(patches: Patches, known: Float, light: Float) -> tuple[Grays, ...]:
    found = []
    for channel in range(len(CHANNELS)):
        used = GRAYS[patches.usable[GRAYS, channel]]
        found.append(
            Grays(
                patches.mean[used, channel],
                patches.deviation[used, channel],
                known[used, channel] * np.exp2(light[used]) + GLARE,
            )
        )
    return tuple(found)


def _confidence(
    fit: GrayFit, found: InverseCRF, patches: Patches, prior: FamilyPrior
) -> Confidence:
    wider = max(1.0, fit.strain)
    rows = [np.interp(found.encoded, prior.grid, prior.deviations(one)) for one in fit.channels]
    sigma = wider * np.array(rows)
    sigma[:, [0, -1]] = 0.0
    in_stops = _in_stops(fit, found, prior, wider)
    used = int(patches.usable[GRAYS].all(axis=1).sum())
    return Confidence(
        sigma,
        _coverage(patches, found),
        verdict_of(in_stops),
        (
            f"{used} grays of 6 are neither clipped nor drowned in all channels",
            "between and beyond the grays the curve is the likeliest of known responses",
        ),
        in_stops,
    )


def _in_stops(fit: GrayFit, found: InverseCRF, prior: FamilyPrior, wider: float) -> InStops:
    told = [
        judge(one, InverseCRF(found.encoded, np.roll(found.linear, -c, axis=0)), prior, wider)[0]
        for c, one in enumerate(fit.channels)
    ]
    return InStops(
        np.array([one.sigma[0] for one in told]),
        float(np.mean([one.mid for one in told])),
        float(np.mean([one.shadows for one in told])),
    )


def _coverage(patches: Patches, found: InverseCRF) -> Float:
    rows = []
    for channel in range(len(CHANNELS)):
        used = patches.mean[GRAYS[patches.usable[GRAYS, channel]], channel]
        rows.append(coverage_at(found.encoded, coverage_counts(used)))
    return np.array(rows)


def _not_calibrated(problem: str) -> Estimate:
    return Estimate(
        Outcome.NOT_CALIBRATED, "chart", f"the chart gives no curve: {problem}", _REMEDY
    )
