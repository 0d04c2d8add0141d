"""Pictures that keep to few levels of brightness: posters, palettes, drawings, and JPEGs of them.

Light falls on a face in all shades between its brightest and its darkest, so that the histogram of
a photo's codes is smooth, whatever the camera's curve. Of a picture that was made with few levels
or colors it is a row of peaks, which a JPEG makes wide and does not join.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.photo.raster.pixels import Pixels, eight_bit, packed
from facecrf_ocio.settings import JointSettings
from facecrf_ocio.values import Float, Lacking

_REASON = "brightness keeps to few levels, as in a poster, a palette or a drawing"
ORIGINAL = "use the picture as the camera wrote it"
"""What to do about a picture that was made into something else."""
_MARGIN = 0.15  # share of the box on each side: hair, clothes and what is behind
_MOST_SIDE = 640  # [px] as large as the faces that limits were chosen on; more cost time alone
_MEDIAN = 5  # [px] which takes away noise, and a JPEG's rings around edges
# [codes] Deviations of two blurs of the histogram: the first closes the gaps of a photo whose
# contrast was raised in 8 bits, the second levels that are 8 to 32 codes apart, and no shading.
_FINE, _SMOOTH = 1, 5
# [px] and [codes] the same where grain was laid over the levels; gaps of a photo that was pushed in
# 8 bits are closed.
_GRAIN_MEDIAN, _GRAIN_FINE, _GRAIN_SMOOTH = 9, 2, 8
# Of that roughness, log codes of grain, and log pixels of the face's side; and what they must
# exceed. Grain hides levels, and of few pixels a histogram is rough by chance: found by a logistic
# regression on posters, on what they were made of, and on that with the same grain
# (`training/wrong_pictures.py`, docs/evidence).
GRAINY, MOST_GRAINY = np.array([46.52, 4.39, 1.39]), 20.49
_NO_GRAIN = 0.3  # [code] of a picture that rounding leaves none in
_GRAIN_SIDE = 320  # [px] as large as most faces that this was found on
_CLIPPED = (8, 247)  # [code of 255] beyond these, much of a photo is at one code
_ENDS = (0.02, 0.98)  # quantiles between which codes are looked at
_FEWEST_PIXELS = 500  # some ten for each code
_FEWEST_CODES = 36  # over fewer, a smooth histogram is not told from peaks


def few_levels(pixels: Pixels, box_xy: Float, settings: JointSettings) -> Lacking | str:
    """Why a face has too few levels to be a photo's; or that it may, empty where it has all.

    Parameters
    ----------
    pixels
        (H, W, 3) code values in [0, 1], or of 8 bits.
    box_xy
        (4,) x, y, width, height [px] of the face.
    """
    codes = face_codes(pixels, box_xy)
    found = roughness(codes)
    if found > settings.most_roughness:
        return Lacking(f"the face's {_REASON}", ORIGINAL)
    few = found > settings.sure_roughness or has_grainy_levels(codes)
    return f"its {_REASON}" if few else ""


def roughness(codes: npt.NDArray[np.uint8]) -> float:
    """By how much of its pixels a histogram departs from a smooth one, [0, 2].

    Of luma, red, green and blue of (h, w, 3) codes, in the mean: the levels of a poster are those
    of its channels, and of a palette those of its colors. A channel counts as smooth where it has
    too few pixels, or hardly differs.
    """
    return _of_channels(codes, _MEDIAN, _FINE, _SMOOTH)


def has_grainy_levels(codes: npt.NDArray[np.uint8]) -> bool:
    """Whether (h, w, 3) codes keep to few levels that grain was laid over."""
    return bool(GRAINY @ grain_told(codes) > MOST_GRAINY)


def grain_told(codes: npt.NDArray[np.uint8]) -> Float:
    """(3,) what tells levels under grain in (h, w, 3) codes: roughness, grain and size."""
    step = -(-max(codes.shape[:2]) // _GRAIN_SIDE)
    codes = packed(codes[::step, ::step])
    luma: Any = cv2.cvtColor(codes, cv2.COLOR_RGB2GRAY)
    grain = float(np.median(cv2.absdiff(luma, cv2.medianBlur(luma, _MEDIAN))))
    wide = _of_channels(codes, _GRAIN_MEDIAN, _GRAIN_FINE, _GRAIN_SMOOTH)
    return np.array([wide, np.log(grain + _NO_GRAIN), np.log(max(codes.shape[:2]))])


def _of_channels(codes: npt.NDArray[np.uint8], median: int, fine: int, smooth: int) -> float:
    luma = cv2.cvtColor(codes, cv2.COLOR_RGB2GRAY)
    channels = (luma, *cv2.split(codes))
    return float(np.mean([_of_channel(one, median, fine, smooth) for one in channels]))


def _of_channel(channel: Any, median: int, fine: int, smooth: int) -> float:
    quiet: Any = cv2.medianBlur(channel, median)
    counts = np.asarray(cv2.calcHist([quiet], [0], None, [256], [0, 256]).ravel(), np.float64)
    counts[: _CLIPPED[0] + 1] = counts[_CLIPPED[1] :] = 0.0
    total = counts.sum()
    if total < _FEWEST_PIXELS:
        return 0.0
    low, high = np.searchsorted(np.cumsum(counts) / total, _ENDS)
    if high - low < _FEWEST_CODES:
        return 0.0
    between = counts[low : high + 1]
    # What the wide blur takes off the one mode of a dim or plain face is put back (twicing).
    wide = _blurred(between, smooth)
    wide = 2 * wide - _blurred(wide, smooth)
    return float(np.abs(_blurred(between, fine) - wide).sum() / between.sum())


def _blurred(counts: Float, deviation: int) -> Float:
    reach = 3 * deviation
    bell = cv2.getGaussianKernel(2 * reach + 1, deviation).ravel()
    inner = counts[1:-1]  # reflected at both ends; NumPy's way takes longer than the rest
    ends = inner[reach - 1 :: -1], inner[: -reach - 1 : -1]
    return np.convolve(np.concatenate([ends[0], counts, ends[1]]), bell, "valid")


def face_codes(pixels: Pixels, box_xy: Float) -> npt.NDArray[np.uint8]:
    """(h, w, 3) codes of 8 bits in the middle of a face, of (H, W, 3) and its box (4,) [px]."""
    return eight_bit(packed(inside_face(pixels, box_xy)))


def inside_face(pixels: Pixels, box_xy: Float) -> Pixels:
    """(h, w, 3) the middle of a face, of (H, W, 3) and its box (4,) [px].

    Of a large one every second pixel, or third, and so on.
    """
    left, top, width, height = box_xy.tolist()
    step = max(1, round(max(width, height) / _MOST_SIDE))
    rows = _part(top, height, pixels.shape[0], step)
    columns = _part(left, width, pixels.shape[1], step)
    return pixels[rows, columns]


def _part(start: float, length: float, most: int, step: int) -> slice:
    begin = min(max(int(start + _MARGIN * length), 0), most - 1)
    return slice(begin, max(int(start + (1 - _MARGIN) * length), begin + 1), step)
