"""A second detector's view of the face that the first one found, which may be nobody's.

Both detectors see some animals, statues and dolls, but rarely the same ones.
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face.blazeface import detect_blazeface
from facecrf_ocio.photo.raster.halves import halved_part
from facecrf_ocio.photo.raster.pixels import Pixels, eight_bit
from facecrf_ocio.values import Face, Float

NOBODYS = "one of two detectors sees nobody's face, as with animals and statues"
"""What is told of a face that `is_nobodys`, in a clause."""

_SIDE = 192  # [px] of BlazeFace's input
_MARGIN = 2.2  # side of what is looked at over the face's longer side
_OUTER_EYE_CORNERS = (33, 263)  # vertices of the mesh, the right eye's first
# Of 129 pictures of animals that passed YuNet gives one in eighteen as much, of 164 versions of 34
# pictures of people four in five: it is not doubted there.
_SURE_SCORE = 0.92
# Of the others, BlazeFace gives each of those of people more (0.64 is the least), and 113 of 122
# animals less.
_LEAST_SCORE = 0.6


def is_nobodys(pixels: Pixels, face: Face) -> bool:
    """Whether one detector is not sure of a face, and the other sees none there.

    Parameters
    ----------
    pixels
        (H, W, 3) code values in [0, 1], or of 8 bits.
    """
    if face.score >= _SURE_SCORE:
        return False
    points = face.landmarks_xyz[:, :2]
    right, left = points[list(_OUTER_EYE_CORNERS)]
    low, high = points.min(axis=0), points.max(axis=0)
    side = _MARGIN * float((high - low).max())
    x, y = (left - right) / max(float(np.linalg.norm(left - right)), 1.0)
    to_photo = side / _SIDE * np.array([[x, -y], [y, x]])
    shift = (low + high) / 2 - to_photo @ np.full(2, _SIDE / 2)
    # Of a large face, twice as many pixels as are asked for each way: BlazeFace knows no others.
    small = min(1.0, 2 * _SIDE / side)
    seen, corner = _around(pixels, to_photo, shift, small)
    upright = np.column_stack([to_photo * small, (shift - corner) * small])
    crop = cv2.warpAffine(
        seen, upright, (_SIDE, _SIDE), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    )
    return not detect_blazeface(np.asarray(crop, np.uint8), _LEAST_SCORE)


def _around(
    pixels: Pixels, to_photo: Float, shift: Float, small: float
) -> tuple[npt.NDArray[np.uint8], Float]:
    """What a crop is taken from, scaled by `small`, and its corner (2,) in pixels of the photo.

    Halved as far as may be, which takes a tenth of the time of scaling by other factors.
    """
    times = min(int(1.0 / small), *pixels.shape[:2]).bit_length() - 1
    corners = to_photo @ np.array([[0, _SIDE, 0, _SIDE], [0, 0, _SIDE, _SIDE]]) + shift[:, None]
    # Pixels beyond the crop that its own are mixed of: two of the scaled ones.
    edges = np.array([corners.min(axis=1) - 2.0 / small, corners.max(axis=1) + 2.0 / small])
    edges /= 2**times
    there = np.array([edge >> times for edge in pixels.shape[1::-1]])
    low = np.clip(np.floor(edges[0]).astype(int), 0, there - 1)
    high = np.clip(np.ceil(edges[1]).astype(int), low + 1, there)
    (left, top), (right, bottom) = low.tolist(), high.tolist()
    part = halved_part(pixels, times, (slice(top, bottom), slice(left, right)))
    codes, left_over = eight_bit(part), small * 2**times
    fewer = cv2.resize(codes, None, fx=left_over, fy=left_over, interpolation=cv2.INTER_AREA)
    return np.asarray(fewer, np.uint8), low * 2.0**times
