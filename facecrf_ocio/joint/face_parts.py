"""What a face's own parts tell of its picture: that brightness is inverted, or channels swapped.

Eyes and nostrils are darker than the skin around them whatever the skin, the light or the curve,
and skin is less blue against green than eyes, lips and most of what is around. Where it is the
other way round, no camera's curve made the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np

from facecrf_ocio.face import regions
from facecrf_ocio.face.view import FaceView
from facecrf_ocio.photo.raster.pixels import Float32, Pixels, code_values, packed
from facecrf_ocio.values import Bool, Float

_EYES = (regions.RIGHT_LIDS, regions.LEFT_LIDS)
_NOSTRILS = (regions.RIGHT_NOSTRIL, regions.LEFT_NOSTRIL)
_RING = 0.06  # of the head's width: how far around a part its skin is looked at
_FEWEST = 8  # [px] of a part and of its ring, at 160 px a face: fewer are noise
_BRIGHTER = 2.0  # [code of 255] by which eyes must be brighter at least, for rounding
# Of that, by how much nostrils may be darker: two of eight photos of a head of very dark skin have
# 0.25 and 0.80, of inverted pictures of 16 portraits the most is 0.17.
_DARKER = 0.2
# Of the range of eyes, between quantiles: with 0.1, 9 of 416 ordinary photos are told to be
# inverted, rendered heads of very dark skin all of them; with 0.2 one is.
_OF_RANGE, _ENDS = 0.2, (0.1, 0.9)
_CLIPPED = (6, 250)  # [code of 255] beyond these, a ratio of channels is not the light's
_SAMPLES = 192  # [px] of the long side at which the whole picture is looked at
# Sum of log ratios: with 0.04, 17 of the same 416 are told to be swapped, with 0.2 five.
_BLUER = 0.2


def odd_parts(view: FaceView, pixels: Pixels) -> tuple[str, ...]:
    """Why a face's parts are not as a camera sees them, in clauses; none where they may be.

    Parameters
    ----------
    view
        The face at working size.
    pixels
        (H, W, 3) code values of the whole picture in [0, 1], or of 8 bits.
    """
    found = []
    if _is_inverted(view):
        found.append("the eyes are brighter than the skin around them, as with brightness inverted")
    if _is_swapped(view, pixels):
        found.append(
            "the skin is more blue than green, and more so than eyes, lips and picture, as with "
            "channels swapped"
        )
    return tuple(found)


def _is_inverted(view: FaceView) -> bool:
    luma = 255.0 * np.asarray(cv2.cvtColor(view.encoded, cv2.COLOR_RGB2GRAY), np.float64)
    eyes, nostrils = (_above_skin(view, luma, parts) for parts in (_EYES, _NOSTRILS))
    seen = luma[_eyes(view)]
    if seen.size < _FEWEST:
        return False
    # The white of eyes is brighter than very dark skin, whose nostrils and pupils are darker.
    least = max(_BRIGHTER, _OF_RANGE * float(np.ptp(np.quantile(seen, _ENDS))))
    return eyes > least and nostrils > -_DARKER * eyes


def _above_skin(view: FaceView, luma: Float, parts: Sequence[Sequence[int]]) -> float:
    """[code] By how much parts are brighter than the skin around each; 0 where none is seen."""
    width = float(np.ptp(view.geometry.vertices[list(regions.CHEEK_EDGES), 0]))
    reach = max(1, round(_RING * width))
    around = cv2.getStructuringElement(cv2.MORPH_RECT, (2 * reach + 1, 2 * reach + 1))
    above = []
    for part in parts:
        inside = view.within(part)
        ring = (cv2.dilate(inside.astype(np.uint8), around) > 0) & view.geometry.bare_skin
        if min(np.count_nonzero(inside), np.count_nonzero(ring)) >= _FEWEST:
            above.append(float(luma[inside].mean() - np.median(luma[ring])))
    return float(np.mean(above)) if above else 0.0


def _is_swapped(view: FaceView, pixels: Pixels) -> bool:
    planes: Any = cv2.split(view.encoded)
    red, green, blue = planes
    darkest = np.asarray(cv2.min(cv2.min(red, green), blue))
    brightest = np.asarray(cv2.max(cv2.max(red, green), blue))
    low, high = (code / 255 for code in _CLIPPED)
    skin = view.geometry.bare_skin & (darkest > low) & (brightest < high)
    parts = (skin, _eyes(view), view.within(regions.LIPS))
    if min(np.count_nonzero(part) for part in parts) < _FEWEST:
        return False
    of_skin, of_eyes, of_lips = (
        float(np.median(_bluer(blue[part], green[part]))) for part in parts
    )
    step = max(1, max(pixels.shape[:2]) // _SAMPLES)
    some = code_values(packed(pixels[::step, ::step]), 8)
    of_picture = cv2.mean(some)
    picture = float(_bluer(np.array(of_picture[2]), np.array(of_picture[1])))
    return of_skin > 0 and 3 * of_skin - of_eyes - of_lips - picture > _BLUER


def _bluer(blue: Float32, green: Float32) -> Float:
    """Log ratios (N,) of encoded values (N,); a code more in each keeps from that of nothing."""
    return np.asarray(np.log((255.0 * blue + 1.0) / (255.0 * green + 1.0)))


def _eyes(view: FaceView) -> Bool:
    return view.within(regions.RIGHT_EYE) | view.within(regions.LEFT_EYE)
