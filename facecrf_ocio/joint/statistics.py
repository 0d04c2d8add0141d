"""What a photo shows that depends on its response: statistics of the skin and of the whole photo.

Each cue is a vector of numbers measured in encoded values. What they say of the response is
learned (`messages.py`), together with how far it can be trusted.

Two more were tried and dropped, because on heads that were not trained on they made the estimate
worse: quantiles of the whole photo (what auto-exposure tells), which the networks took to recognize
the training pictures, and brightness as a quadratic of the mesh's normals.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face import regions
from facecrf_ocio.face.skin_mask import find_skin
from facecrf_ocio.face.view import MIN_SKIN_PIXELS, FaceView
from facecrf_ocio.joint.grain import measure_noise, noise_curve
from facecrf_ocio.joint.noise_counts import SECOND_DIFFERENCE, count_noise
from facecrf_ocio.joint.texture import noise_character
from facecrf_ocio.photo.pixels import in_8_bits
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Float, frozen

CUES = ("grain", "shading", "highlights", "pigments", "noise", "eyes")
SHADING_BINS = 12
PIGMENT_BINS = 4
NOISE_BINS = 8
HIGHLIGHT_QUANTILES = (0.9, 0.95, 0.98, 0.995)
EYE_QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
_DARKEST = 0.5 / 255.0
_QUANTIZATION = 0.3 / 255.0
_MIN_EYE_PIXELS = 20


@dataclass(frozen=True, slots=True, eq=False)
class Statistics:
    """The numbers of every cue that a photo has.

    Attributes
    ----------
    by_cue
        For each cue of `CUES` that the photo shows, its vector.
    encoded
        (N, 3) a sample of the encoded values that they rest on.
    """

    by_cue: Mapping[str, Float]
    encoded: Float


def photo_statistics(encoded: npt.NDArray[np.float32]) -> dict[str, Float]:
    """Statistics of a whole photo (H, W, 3), taken in 8 bits, that need no face: `grain`.

    Noise against level, and how far it is noise. Empty where every pixel is clipped.
    """
    counts = count_noise(encoded)
    curve = noise_curve(measure_noise(counts))
    if curve is None:
        return {}
    return {"grain": np.concatenate([curve, noise_character(counts)])}


def face_statistics(
    view: FaceView, settings: Settings, *, to_8_bits: bool = False
) -> Statistics | None:
    """Statistics of one face; None where it shows too little skin.

    Parameters
    ----------
    view
        The face at its working size, and as stored: only there is the noise the sensor's.
    settings
        For the skin mask.
    to_8_bits
        Round the native pixels to 8 bits, as those at working size have been by `cut_face`.
    """
    mask = find_skin(view.encoded, view.geometry.bare_skin, settings)
    if int(mask.skin.sum()) < MIN_SKIN_PIXELS:
        return None
    skin = np.asarray(view.encoded[mask.skin], dtype=np.float64)
    skin = skin[np.argsort(skin.mean(axis=1), kind="stable")]
    found = {
        "shading": _shading(skin),
        "highlights": _highlights(view.encoded[view.geometry.bare_skin].astype(np.float64)),
        "pigments": _pigments(skin),
    }
    noise = _noise(view.native, mask.skin, to_8_bits)
    if noise is not None:
        found["noise"] = noise
    eyes = _eyes(view, skin)
    if eyes is not None:
        found["eyes"] = eyes
    return Statistics(found, frozen(skin[:: max(1, len(skin) // 512)]))


def _shading(skin: Float) -> Float:
    """Mean color at each brightness of the skin.

    Under one light chromaticity does not change with shading in linear light; how it does change
    in encoded values tells the shape of `log g` (and the brightest and darkest skin its spread).
    """
    means = np.array([part.mean(axis=0) for part in np.array_split(skin, SHADING_BINS)])
    logs = np.log(np.maximum(means, _DARKEST))
    green = logs[:, 1]
    return np.concatenate([green, logs[:, 0] - green, logs[:, 2] - green, means.mean(axis=1)])


def _highlights(bare: Float) -> Float:
    """Color of the brightest bare skin, where reflected light is added to the skin's own."""
    luma = bare.mean(axis=1)
    limits = np.quantile(luma, HIGHLIGHT_QUANTILES)
    means = np.array([bare[luma >= limit].mean(axis=0) for limit in limits])
    middle = bare[luma >= np.quantile(luma, 0.4)].mean(axis=0)
    return np.concatenate([means.ravel(), middle])


def _pigments(skin: Float) -> Float:
    """Spread of skin color within each brightness: the pigments' contrasts in encoded logs."""
    numbers = []
    for part in np.array_split(skin, PIGMENT_BINS):
        logs = np.log(np.maximum(part, _DARKEST))
        opponent = np.stack([logs[:, 0] - logs[:, 1], logs[:, 2] - logs[:, 1]])
        spread = np.quantile(opponent, (0.1, 0.9), axis=1)
        widths = np.log(np.maximum(spread[1] - spread[0], 1e-3))
        deviation = opponent.std(axis=1)
        correlation = ((opponent - opponent.mean(axis=1, keepdims=True)).prod(axis=0)).mean()
        numbers += [*widths, correlation / max(float(deviation.prod()), 1e-6)]
    return np.array(numbers)


def _noise(
    native: npt.NDArray[np.float32], skin: npt.NDArray[np.bool_], to_8_bits: bool
) -> Float | None:
    """Log deviation of the noise at each brightness of the skin.

    From a second difference that smooth shading and its slope do not enter.
    """
    green = np.ascontiguousarray(native[..., 1])
    green = in_8_bits(green) if to_8_bits else green
    height, width = green.shape
    inside = cv2.resize(skin.astype(np.uint8), (width, height), interpolation=cv2.INTER_NEAREST)
    inside[[0, -1]] = 0
    inside[:, [0, -1]] = 0
    chosen = inside > 0
    if int(chosen.sum()) < MIN_SKIN_PIXELS:
        return None
    level = cv2.blur(green, (3, 3))[chosen]
    residue = cv2.filter2D(green, -1, SECOND_DIFFERENCE / 6.0)[chosen]
    np.abs(residue, out=residue)
    del green, inside, chosen  # of a large face they are a tenth of what a worker may take
    order = np.argsort(level, kind="stable")
    deviations = [
        1.4826 * np.median(part) + _QUANTIZATION
        for part in np.array_split(residue[order], NOISE_BINS)
    ]
    levels = [float(part.mean()) for part in np.array_split(level[order], NOISE_BINS)]
    return np.array([*np.log(deviations), *levels])


def _eyes(view: FaceView, skin: Float) -> Float | None:
    """Luma quantiles in the eyes, from pupil to sclera, beside the skin's."""
    mask = np.zeros(view.encoded.shape[:2], np.uint8)
    for outline in (regions.RIGHT_EYE, regions.LEFT_EYE):
        hull = np.rint((view.geometry.vertices[list(outline), :2] - 0.5) * 16.0)
        cv2.fillPoly(mask, [hull.astype(np.int32)], 1, shift=4)
    inside = view.encoded[mask > 0].astype(np.float64)
    if len(inside) < _MIN_EYE_PIXELS:
        return None
    quantiles = np.quantile(inside.mean(axis=1), EYE_QUANTILES)
    bright = inside[inside.mean(axis=1) >= quantiles[-2]].mean(axis=0)
    middle = np.quantile(skin.mean(axis=1), (0.1, 0.5, 0.9))
    return np.array([*quantiles, *bright, *middle])
