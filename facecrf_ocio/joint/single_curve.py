"""Pictures that no single curve of a camera explains, told by their pixels.

A toned black and white photo has one hue at each brightness, a palette has few colors, and a
drawing has no noise: none of them shows how a camera answered light.
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.settings import JointSettings
from facecrf_ocio.values import Float, Lacking, Photo

Float32 = npt.NDArray[np.float32]

_GAIN_SIDE, _GAIN_BINS = 256, 64  # [px] and brightnesses at which a gain map is looked at
_SIDE = 768  # [px] of the middle of the picture that is looked at, at its own size
_SMALL = 64  # [px] long side of the picture whose color is looked at
_FEWEST_SMALL = 128  # pixels: ten and more for each of the brightnesses
_BRIGHTNESSES = 12  # at which one hue each is asked; chosen by judgment
_CLIPPED = (4, 251)  # [code of 255] beyond these, noise and color are cut off
_FEWEST_PIXELS = 1024  # as many as 32 by 32, of which a share is certain to 2 %
_ORIGINAL = "use the picture as the camera wrote it"


def no_photograph(encoded: Float32, box_xy: Float, settings: JointSettings) -> Lacking | None:
    """Why a picture's pixels are no camera's; None where they may be.

    Parameters
    ----------
    encoded
        (H, W, 3) code values in [0, 1].
    box_xy
        (4,) x, y, width, height [px] of the face, which shows whether it was drawn.
    """
    if encoded.shape[0] * encoded.shape[1] < _FEWEST_PIXELS:
        return None
    if distinct_colors(middle_codes(encoded)) < settings.fewest_colors:
        return Lacking("the picture has the few colors of a palette", _ORIGINAL)
    left, top = (max(int(edge), 0) for edge in box_xy[:2])
    right, bottom = (int(edge) for edge in box_xy[:2] + box_xy[2:])
    if flat_share(middle_codes(encoded[top:bottom, left:right])) > settings.most_flat:
        return Lacking("the face is drawn: most of its pixels equal their neighbors", _ORIGINAL)
    if chroma_share(encoded) < settings.least_chroma:
        return Lacking("the photo has one hue: no pigments to look at", _ORIGINAL)
    return None


def gain_scatter(photo: Photo) -> float:
    """[stop] How far the gain of a photo's map strays from one curve of brightness; 0 without map.

    One curve for all of a picture makes its gain a function of the encoded brightness alone, and
    tone mapping of places does not. Half of the spread from the 16 % to the 84 % quantile of what
    is left of the gain at each brightness.
    """
    found = photo.gain_map
    if found is None:
        return 0.0
    scale = _GAIN_SIDE / max(photo.encoded.shape[:2])
    size = tuple(max(1, round(edge * scale)) for edge in photo.encoded.shape[1::-1])
    encoded = cv2.resize(photo.encoded, size, interpolation=cv2.INTER_AREA).max(axis=2).ravel()
    values = cv2.resize(found.values, size, interpolation=cv2.INTER_AREA).mean(axis=2).ravel()
    gain = found.low.mean() + (found.high - found.low).mean() * values ** (1 / found.gamma.mean())
    order = np.argsort(encoded, kind="stable")
    left = [part - np.median(part) for part in np.array_split(gain[order], _GAIN_BINS)]
    low, high = np.quantile(np.concatenate(left), (0.16, 0.84))
    return float(high - low) / 2


def middle_codes(encoded: Float32) -> npt.NDArray[np.uint8]:
    """(h, w, 3) the middle of a picture in 8 bits, at most 768 px on a side."""
    top, left = (max(0, (size - _SIDE) // 2) for size in encoded.shape[:2])
    part = encoded[top : top + _SIDE, left : left + _SIDE]
    return np.asarray(np.rint(part * 255), np.uint8)


def distinct_colors(codes: npt.NDArray[np.uint8]) -> int:
    """Number of colors, by a mark for each that there can be: sorting the pixels takes longer."""
    wide = codes.astype(np.uint32)
    seen = np.zeros(1 << 24, np.bool_)
    seen[wide[..., 0] << 16 | wide[..., 1] << 8 | wide[..., 2]] = True
    return int(np.count_nonzero(seen))


def flat_share(codes: npt.NDArray[np.uint8]) -> float:
    """Share of the pixels not clipped that equal those to the right and below in all channels."""
    here, right, below = codes[:-1, :-1], codes[:-1, 1:], codes[1:, :-1]
    same = (here == right).all(axis=2) & (here == below).all(axis=2)
    open_ = (here.max(axis=2) > _CLIPPED[0]) & (here.min(axis=2) < _CLIPPED[1])
    return float(same[open_].mean()) if open_.sum() >= _FEWEST_PIXELS else 0.0


def chroma_share(encoded: Float32) -> float:
    """Spread of color about the one that each brightness has, over the spread of brightness.

    Red and blue against green in a picture made so small that noise, and what JPEG does to color,
    even out; the share is that of the 90 % quantile, since most of an ordinary picture may be gray.
    """
    scale = _SMALL / max(encoded.shape[:2])
    small = cv2.resize(encoded, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    pixels = 255.0 * np.asarray(small, float).reshape(-1, 3)
    low, high = _CLIPPED
    pixels = pixels[(pixels.min(axis=1) > low) & (pixels.max(axis=1) < high)]
    if len(pixels) < _FEWEST_SMALL:
        return np.inf
    pixels = pixels[np.argsort(pixels[:, 1], kind="stable")]
    away = [_about_a_line(part) for part in np.array_split(pixels, _BRIGHTNESSES)]
    return float(np.quantile(np.concatenate(away), 0.9) / max(float(pixels[:, 1].std()), 1.0))


def _about_a_line(pixels: Float) -> Float:
    """(N,) distance of red and blue from straight lines over green."""
    green = pixels[:, 1] - pixels[:, 1].mean()
    color = pixels[:, (0, 2)] - pixels[:, (0, 2)].mean(axis=0)
    slope = green @ color / max(float(green @ green), 1e-9)
    return np.asarray(np.hypot(*(color - green[:, None] * slope).T))
