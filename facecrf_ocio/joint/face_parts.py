"""What a face's own parts tell of its picture: that brightness is inverted, or channels swapped.

Eyes, nostrils and brows are darker than the skin around them whatever the skin, the light or the
curve, lips are redder than skin, and skin varies less in red than in blue. Where it is the other
way round, no camera's curve made the picture.

What counts how much was found by logistic regressions on portraits of unknown cameras and on
rendered heads, and on both inverted and swapped (`training/wrong_pictures.py`, docs/evidence).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from facecrf_ocio.face import regions
from facecrf_ocio.face.skin_mask import MIN_SATURATION, find_skin
from facecrf_ocio.face.view import FaceView
from facecrf_ocio.photo.raster.pixels import Float32, Pixels, code_values, packed
from facecrf_ocio.settings import FaceSettings
from facecrf_ocio.values import Bool, Float

_EYES = (regions.RIGHT_EYE, regions.LEFT_EYE)
_LIDS = (regions.RIGHT_LIDS, regions.LEFT_LIDS)
_NOSTRILS = (regions.RIGHT_NOSTRIL, regions.LEFT_NOSTRIL)
_BROWS = (regions.RIGHT_BROW, regions.LEFT_BROW)
_LIPS = (regions.LIPS,)
_RING = 0.06  # of the head's width: how far around a part its skin is looked at
_FEWEST, _FEWEST_RINGED = 8, 4  # [px] of a part, and of one with a ring, at 160 px a face
_SAMPLES = 192  # [px] of the long side at which the whole picture is looked at

_SQUASHED = 12.0  # [code of 255] of difference, from which on more of it hardly counts more
_DARK = 8.0  # [code of 255] below which a ratio of channels is rounding
# Of lids, the tenth and the ninth tenth of eyes, nostrils, brows and lips against skin; and how
# blue less green, and the log of red over blue, rise with brightness on skin.
BRIGHT = np.array([2.47, 1.92, 1.1, 3.56, 3.18, 0.54, 1.89, -1.35])
# Above it brightness is inverted. By 0.3, which parts 749 portraits from inverted ones, 8 of 35
# photos of dark faces at an event were: lids shine and eyes are white beside dark skin. By 4 none
# of these is, nor of 402 others; 77 % of inverted pictures are found (docs/evidence).
INVERTED = 4.0

# Of skin its log ratios of red and of blue to green; those less the ratios of eyes, lips, brows and
# picture; log ratios of variances of red and of blue to green; and those of the variances of red
# over green, and of red over blue, to that of blue over green.
COLORED = np.array(
    [*(6.21, -3.94, 1.59, -2.64, -10.52, -1.58, 4.91, 0.12, 1.46, -1.91), -3.86, 1.72, -2.73, 7.86]
)
# Log ratio of each from which on more of it hardly counts more.
_HARDLY = np.array([0.6, 0.6, *8 * [0.3], 0.5, 0.5, 1.0, 1.0])
_COLORLESS = 3e-4  # [log^2] variance that rounding and JPEG leave: two per cent of a code value
# By which another order must fit better; by 2, one in seven photos of a woman in gray studio light.
SWAPPED = 3.0
ORDERS = {  # of channels, all but red, green and blue
    (2, 1, 0): "red and blue exchanged",
    (1, 0, 2): "red and green exchanged",
    (0, 2, 1): "green and blue exchanged",
    (1, 2, 0): "each channel in another's place",
    (2, 0, 1): "each channel in another's place",
}
# Of lips or of skin around them, the least share of the hue of skin above. Beside most beards skin
# has it, beside the others lips; what covers a mouth covers both.
_SAME_HUE = 0.4
_HUE_TELLS = 0.2  # saturation of skin below which, in gray light, its hue is chance
_MARGIN = np.ones((5, 5), np.uint8)  # [px] two around, where skin blends with what it borders
_FEWEST_SKIN = 200  # [px] within that margin, or skin is taken whole


@dataclass(frozen=True, slots=True, eq=False)
class FaceColors:
    """Logs of a face's colors, of which the order of channels is told.

    Attributes
    ----------
    middle
        (5, 3) of skin, eyes, lips, brows and the whole picture.
    spread
        (3, 3) covariance of skin.
    """

    middle: Float
    spread: Float

    def in_order(self, order: Sequence[int]) -> FaceColors:
        """The same with channels in another order."""
        return FaceColors(self.middle[:, order], self.spread[np.ix_(order, order)])


def odd_parts(view: FaceView, pixels: Pixels, settings: FaceSettings) -> tuple[str, ...]:
    """Why a face's parts are not as a camera sees them, in clauses; none where they may be.

    Parameters
    ----------
    view
        The face at working size.
    pixels
        (H, W, 3) code values of the whole picture in [0, 1], or of 8 bits.
    settings
        By which skin is of one hue.
    """
    colors = face_colors(view, pixels)
    if colors is None:
        return ()
    found = []
    if BRIGHT @ brightness_told(view) > INVERTED:
        found.append(
            "eyes, nostrils and brows are bright beside the skin, as with brightness inverted"
        )
    order = _other_order(colors)
    if order and not _is_mouth_covered(view, settings):
        found.append(f"the face's colors are a face's with {order}: channels seem swapped")
    return tuple(found)


def brightness_told(view: FaceView) -> Float:
    """(8,) what tells inverted brightness; weighed by `BRIGHT`, log odds but for a constant."""
    codes = 255.0 * view.encoded
    luma = np.asarray(cv2.cvtColor(codes, cv2.COLOR_RGB2GRAY), np.float64)
    lids, eyes, nostrils, brows, lips = (
        _above_skin(view, luma, parts) for parts in (_LIDS, _EYES, _NOSTRILS, _BROWS, _LIPS)
    )
    above = np.array([lids[0], eyes[1], eyes[2], nostrils[0], brows[0], lips[0]])
    skin = view.geometry.bare_skin
    bright, (red, green, blue) = luma[skin], codes[skin].T.astype(np.float64)
    slopes = (
        _slope(bright, blue - green),
        _slope(np.log(bright + _DARK), np.log((red + 1.0) / (blue + 1.0))),
    )
    return np.array([*(above / (np.abs(above) + _SQUASHED)), *np.clip(slopes, -1.0, 1.0)])


def _above_skin(view: FaceView, luma: Float, parts: Sequence[Sequence[int]]) -> Float:
    """[code] (3,) mean and outer tenths of parts above the skin around each; 0 where unseen."""
    above = []
    for part in parts:
        inside = view.within(part)
        ring = _around(view, inside)
        if min(np.count_nonzero(inside), np.count_nonzero(ring)) >= _FEWEST_RINGED:
            seen = luma[inside]
            told = np.array([seen.mean(), *np.quantile(seen, (0.1, 0.9))])
            above.append(told - np.median(luma[ring]))
    return np.asarray(np.mean(above, axis=0)) if above else np.zeros(3)


def _around(view: FaceView, part: Bool) -> Bool:
    """(H, W) the bare skin around a part."""
    width = float(np.ptp(view.geometry.vertices[list(regions.CHEEK_EDGES), 0]))
    reach = max(1, round(_RING * width))
    square = cv2.getStructuringElement(cv2.MORPH_RECT, (2 * reach + 1, 2 * reach + 1))
    return (cv2.dilate(part.astype(np.uint8), square) > 0) & view.geometry.bare_skin


def _slope(x: Float, y: Float) -> float:
    """Of the line through points that fits best; 0 where all x are one."""
    apart = x - x.mean()
    square = float(apart @ apart)
    return float(apart @ y) / square if square > 0.0 else 0.0


def face_colors(view: FaceView, pixels: Pixels) -> FaceColors | None:
    """Of a face at working size and its whole picture; None where it shows too little of a part."""
    bare = view.geometry.bare_skin
    parts = [bare, *(_within(view, part) for part in (_EYES, _LIPS, _BROWS))]
    if min(np.count_nonzero(part) for part in parts) < _FEWEST:
        return None
    logs = _logs(view.encoded)
    step = max(1, max(pixels.shape[:2]) // _SAMPLES)
    picture = _logs(code_values(packed(pixels[::step, ::step]), 8))
    middle = np.stack(
        [*(np.median(logs[part], axis=0) for part in parts), picture.mean(axis=(0, 1))]
    )
    inner = cv2.erode(bare.astype(np.uint8), _MARGIN) > 0
    skin = logs[inner if np.count_nonzero(inner) >= _FEWEST_SKIN else bare]
    return FaceColors(middle, np.cov(skin.T.astype(np.float64)))


def _other_order(colors: FaceColors) -> str:
    """The order of channels in which colors are a face's, empty if they are as given."""
    scores = {order: COLORED @ colors_told(colors.in_order(order)) for order in ORDERS}
    best = max(scores, key=lambda order: scores[order])
    return ORDERS[best] if scores[best] > COLORED @ colors_told(colors) + SWAPPED else ""


def colors_told(colors: FaceColors) -> Float:
    """(14,) what tells a face's colors; weighed by `COLORED`, log odds beside another order."""
    ratios = (colors.middle - colors.middle[:, 1:2])[:, [0, 2]]
    own = np.diag(colors.spread)
    variance = np.log(own + 3.0 * _COLORLESS)
    apart = np.add.outer(own, own) - 2.0 * colors.spread
    red_green, red_blue, blue_green = np.log(apart[[0, 0, 2], [1, 2, 1]] + _COLORLESS)
    told = np.array(
        [
            *ratios[0],
            *(ratios[0] - ratios[1:]).ravel(),
            *(variance[[0, 2]] - variance[1]),
            *(red_green - blue_green, red_blue - blue_green),
        ]
    )
    return np.asarray(told / (np.abs(told) + _HARDLY))


def _is_mouth_covered(view: FaceView, settings: FaceSettings) -> bool:
    """Whether lips and what is around them have another hue than skin above, in any order."""
    bare, lips = view.geometry.bare_skin, _within(view, _LIPS)
    eyes, mouth = (np.argwhere(part).mean(axis=0) for part in (_within(view, _EYES), lips))
    rows, columns = np.indices(bare.shape, np.float32)
    down = mouth - eyes
    middle = float(down @ (eyes + mouth)) / 2.0
    above = bare & (down[0] * rows + down[1] * columns < middle)
    hue, saturation, _ = cv2.split(cv2.cvtColor(view.encoded, cv2.COLOR_RGB2HSV))
    if not above.any() or np.median(saturation[above]) <= _HUE_TELLS:
        return False
    apart = hue - find_skin(view.encoded, above, settings).hue_mode
    turned = np.abs((apart + 180.0) % 360.0 - 180.0)
    same = (turned <= settings.hue_half_width) & (saturation > MIN_SATURATION)
    parts = [part for part in (lips, _around(view, lips)) if part.any()]
    return all(same[part].mean() < _SAME_HUE for part in parts)


def _logs(encoded: Float32) -> Float32:
    """Logs of code values; a code more in each keeps from that of nothing."""
    return np.asarray(np.log(255.0 * encoded + 1.0), np.float32)


def _within(view: FaceView, parts: Sequence[Sequence[int]]) -> Bool:
    return np.asarray(np.logical_or.reduce([view.within(part) for part in parts]))
