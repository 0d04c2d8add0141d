"""Pictures that no single curve of a camera explains, told by their pixels.

A toned black and white photo has one hue at each brightness, a palette has few colors, and a
drawing has no noise: none of them shows how a camera answered light.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.joint.few_levels import ORIGINAL, inside_face
from facecrf_ocio.photo.raster.pixels import Pixels, code_values, eight_bit, packed
from facecrf_ocio.settings import JointSettings
from facecrf_ocio.values import Bool, Float, Lacking, Photo

_GAIN_SIDE, _GAIN_BINS = 256, 64  # [px] and brightnesses at which a gain map is looked at
_SIDE = 512  # [px] of the middle of the picture that is looked at, at its own size
_APART = 8  # [px] at which colors are counted first: 4,096 pixels of the middle
_SAMPLES = 192  # [px] of the long side at which color is looked at
_FEWEST_SAMPLES = 512  # [px] thirty and more for each unknown of the spline
_SEGMENTS = 16  # of the spline from brightness to color: one is 16 codes
# The four uniform B-splines of a segment as polynomials of the place in it, from 0 to 1.
_CUBIC = np.array([[1, -3, 3, -1], [4, 0, -6, 3], [1, 3, 3, -3], [0, 0, 0, 1]]) / 6.0
_RIDGE = 1e-2  # [px] holds the spline at 0 where no pixel has that brightness
# Shares of the long side at which color is compared with that beside it: JPEG's error does not
# reach so far, and what has a color of its own does; the farther at least so many pixels.
_NEAR, _FAR, _LEAST_FAR = 0.0115, 0.0457, 16
_LUMA = np.array([0.299, 0.587, 0.114])  # ITU-R BT.601, as JPEG has it
_ROUNDING = 0.05  # [code^2] of color that varies by nothing but rounding
_EVERY = 4  # [px] a sixteenth of a face's pixels has the same median
_LEAST_RED = 0.85  # of blue, in codes, which 4 of 549 ordinary photos have not
_LEAST_RED_OF_GREEN = 0.9  # in codes; of 1170 versions of 30 ordinary photos 1.04 is the least
_CLIPPED = (4, 251)  # [code of 255] beyond these, noise and color are cut off
# Share of colors with another beside them: at most 0.48 of 576 palettes of 8 to 256 colors, made of
# 16 pictures in three ways, and 1.0 of photos so dark that they have few.
_MOST_DENSE = 0.75
_BRIGHTEST = 0.98  # quantile: beside what shines
_DARK = 64  # [code] A face darker than this is doubted anyway, and its noise may be below one code.
_FEWEST_PIXELS = 1024  # as many as 32 by 32, of which a share is certain to 2 %


def no_photograph(pixels: Pixels, box_xy: Float, settings: JointSettings) -> Lacking | None:
    """Why a picture's pixels are no camera's; None where they may be.

    Parameters
    ----------
    pixels
        (H, W, 3) code values in [0, 1], or of 8 bits.
    box_xy
        (4,) x, y, width, height [px] of the face, which shows whether it was drawn.
    """
    if pixels.shape[0] * pixels.shape[1] < _FEWEST_PIXELS:
        return None
    if has_few_colors(middle_codes(pixels), settings.fewest_colors):
        return Lacking("the picture has the few colors of a palette", ORIGINAL)
    left, top = (max(int(edge), 0) for edge in box_xy[:2])
    right, bottom = (int(edge) for edge in box_xy[:2] + box_xy[2:])
    face = middle_codes(pixels[top:bottom, left:right])
    if flat_share(face) > settings.most_flat and np.quantile(face, _BRIGHTEST) >= _DARK:
        return Lacking("the face is drawn: most of its pixels equal their neighbors", ORIGINAL)
    return None


def toned(pixels: Pixels, settings: JointSettings) -> Lacking | str:
    """Why a picture is a tone laid over gray; or that it may be one, empty where it is none.

    Parameters
    ----------
    pixels
        (H, W, 3) code values in [0, 1], or of 8 bits.
    """
    share = chroma_share(pixels)
    if share < settings.least_chroma:
        return Lacking("the photo has one hue: no pigments to look at", ORIGINAL)
    return "" if share > settings.sure_chroma else "it has hardly more than one hue"


def strange_skin(pixels: Pixels, box_xy: Float) -> str:
    """Why a face in a box (4,) [px] has nobody's color, in a clause; empty where it may have.

    Blood makes skin red under any light that is taken for white. In a negative it is blue, and
    where a program took red for blue; green, where it took red for that.
    """
    some = inside_face(pixels, box_xy)[::_EVERY, ::_EVERY].reshape(-1, 3)
    red, green, blue = np.median(some, axis=0)
    if red < _LEAST_RED * blue:
        return "the face is more blue than red, as in a negative or with channels swapped"
    if red < _LEAST_RED_OF_GREEN * green:
        return "the face is more green than red, as with channels swapped or by a green lamp"
    return ""


def gain_scatter(photo: Photo) -> float:
    """[stop] How far the gain of a photo's map strays from one curve of brightness; 0 without map.

    One curve for all of a picture makes its gain a function of the encoded brightness alone, and
    tone mapping of places does not. Half of the spread from the 16 % to the 84 % quantile of what
    is left of the gain at each brightness.
    """
    found = photo.gain_map
    if found is None:
        return 0.0
    scale = _GAIN_SIDE / max(photo.shape[:2])
    size = tuple(max(1, round(edge * scale)) for edge in photo.shape[1::-1])
    encoded = cv2.resize(photo.encoded, size, interpolation=cv2.INTER_AREA).max(axis=2).ravel()
    values = cv2.resize(found.values, size, interpolation=cv2.INTER_AREA).mean(axis=2).ravel()
    gain = found.low.mean() + (found.high - found.low).mean() * values ** (1 / found.gamma.mean())
    order = np.argsort(encoded, kind="stable")
    left = [part - np.median(part) for part in np.array_split(gain[order], _GAIN_BINS)]
    low, high = np.quantile(np.concatenate(left), (0.16, 0.84))
    return float(high - low) / 2


def middle_codes(pixels: Pixels) -> npt.NDArray[np.uint8]:
    """(h, w, 3) the middle of a picture in 8 bits, at most 512 px on a side."""
    top, left = (max(0, (size - _SIDE) // 2) for size in pixels.shape[:2])
    return eight_bit(pixels[top : top + _SIDE, left : left + _SIDE])


def has_few_colors(codes: npt.NDArray[np.uint8], fewest: int) -> bool:
    """Whether codes (H, W, 3) are of fewer colors, and apart: those of dark photos are neighbors.

    Of a photograph, few of its pixels have as many already.
    """
    some = codes[::_APART, ::_APART]
    if np.unique(_packed(some)).size >= fewest:
        return False
    colors = distinct_colors(codes)
    return len(colors) < fewest and not are_dense(colors)


def distinct_colors(codes: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """(N, 3) colors, by a mark for each that there can be: sorting the pixels takes longer."""
    seen = np.zeros(1 << 24, np.bool_)
    seen[_packed(codes) & np.uint32((1 << 24) - 1)] = True
    packed = np.flatnonzero(seen).astype("<u4")
    return packed.view(np.uint8).reshape(-1, 4)[:, :3]


def are_dense(colors: npt.NDArray[np.uint8]) -> bool:
    """Whether most of a few colors (N, 3) have another within a code in each channel."""
    levels = colors.astype(np.int16)
    near = np.abs(levels[:, None] - levels[None]).max(axis=2) <= 1
    return bool((near.sum(axis=1) > 1).mean() > _MOST_DENSE)


def flat_share(codes: npt.NDArray[np.uint8]) -> float:
    """Share of unclipped pixels (H, W, 3) that equal those to the right and below, in all."""
    codes = packed(codes)
    color = _packed(codes)
    here = color[:-1, :-1]
    same = (here == color[:-1, 1:]) & (here == color[1:, :-1])
    planes: Any = cv2.split(codes)
    red, green, blue = (plane[:-1, :-1] for plane in planes)
    open_ = np.asarray(cv2.max(cv2.max(red, green), blue)) > _CLIPPED[0]
    open_ &= np.asarray(cv2.min(cv2.min(red, green), blue)) < _CLIPPED[1]
    count = np.count_nonzero(open_)
    return float(np.count_nonzero(same & open_) / count) if count >= _FEWEST_PIXELS else 0.0


def _packed(codes: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint32]:
    """(H, W) one number a color: its bytes, and one more that is alike for all."""
    wide = np.asarray(cv2.cvtColor(packed(codes), cv2.COLOR_RGB2RGBA))
    return wide.view(np.uint32)[..., 0]


def chroma_share(pixels: Pixels) -> float:
    """How much color a picture has that its brightness does not tell; infinite of too few pixels.

    A toned photo has one color at each brightness: a curve in color space. What is left about a
    smooth curve is JPEG's error, which changes from pixel to pixel, while what has a color of its
    own has it over some distance. So this is the deviation of color that pixels 1/20 of the picture
    apart share, over the spread of brightness, times the squared odds of what near pixels share
    against what they do not.
    """
    long = max(pixels.shape[:2])
    step = max(1, long // _SAMPLES)
    part = packed(pixels[::step, ::step])
    codes = 255.0 * np.asarray(code_values(part, 8), np.float64)
    red, green, blue = (np.ascontiguousarray(codes[..., channel]) for channel in range(3))
    usable = np.minimum(np.minimum(red, green), blue) > _CLIPPED[0]
    usable &= np.maximum(np.maximum(red, green), blue) < _CLIPPED[1]
    count = int(np.count_nonzero(usable))
    if count < _FEWEST_SAMPLES:
        return np.inf
    luma = codes @ _LUMA
    seen = luma[usable]
    left = np.zeros((2, *luma.shape))
    colors = np.stack([red[usable] - seen, blue[usable] - seen])
    for plane, found in zip(left, _about_a_curve(seen, colors), strict=True):
        plane[usable] = found
    near = _shared(left, usable, max(1, round(_NEAR * long / step)))
    far = _shared(left, usable, max(1, round(max(_FAR * long, _LEAST_FAR) / step)))
    whole = float((left**2).sum()) / count
    odds = near / max(whole - near, _ROUNDING)
    return float(np.sqrt(far) / max(float(seen.std()), 1.0) * odds**2)


def _about_a_curve(luma: Float, color: Float) -> Float:
    """(2, N) what is left of color about a cubic spline over brightness.

    By uniform B-splines, four of which are not 0 in each segment, and products of powers of the
    place in it, segment after segment; SciPy's splines take half a second to import.
    """
    low, high = luma.min(), luma.max()
    place = np.clip((luma - low) / max(high - low, 1.0), 0.0, 1.0) * _SEGMENTS
    segment = np.minimum(place.astype(np.uint8), _SEGMENTS - 1)
    order = np.argsort(segment, kind="stable")
    powers = np.ones((4, place.size))
    np.subtract(place, segment, out=place)
    place.take(order, out=powers[1])
    np.multiply(powers[1], powers[1], out=powers[2])
    np.multiply(powers[2], powers[1], out=powers[3])
    sorted_color = color.take(order, axis=1)
    ends = np.cumsum(np.bincount(segment, minlength=_SEGMENTS)).tolist()
    spans = [slice(start, end) for start, end in zip([0, *ends], ends, strict=False)]
    normal = _RIDGE * np.eye(_SEGMENTS + 3)
    right = np.zeros((_SEGMENTS + 3, 2))
    for k, span in enumerate(spans):
        cubics = _CUBIC @ powers[:, span]
        normal[k : k + 4, k : k + 4] += cubics @ cubics.T
        right[k : k + 4] += cubics @ sorted_color[:, span].T
    found = np.linalg.solve(normal, right)
    for k, span in enumerate(spans):
        sorted_color[:, span] -= (found[k : k + 4].T @ _CUBIC) @ powers[:, span]
    left = np.empty_like(color)
    for row, found in zip(left, sorted_color, strict=True):  # NumPy takes thrice as long for both
        row[order] = found
    return left


def _shared(left: Float, usable: Bool, lag: int) -> float:
    """Mean product of what is left (C, H, W) at usable pixels `lag` samples apart; not below 0."""
    total, count = 0.0, 0
    rows, columns = np.s_[:-lag, :], np.s_[:, :-lag]
    for here, there in ((columns, np.s_[:, lag:]), (rows, np.s_[lag:, :])):
        # What is not usable has nothing left, and adds nothing.
        total += sum(float((plane[here] * plane[there]).sum()) for plane in left)
        count += int(np.count_nonzero(usable[here] & usable[there]))
    return max(total / count, 0.0) if count else 0.0
