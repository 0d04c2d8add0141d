"""A second detector's view of the face that the first one found, which may be nobody's.

Both detectors see some animals, statues and dolls, but rarely the same ones.
"""

from __future__ import annotations

import cv2
import numpy as np

from facecrf_ocio.face.blazeface import detect_blazeface
from facecrf_ocio.photo.raster.pixels import Pixels, eight_bit
from facecrf_ocio.values import Face

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
    begin, end = (np.clip(edge, 0, pixels.shape[1::-1]) for edge in (low - side, high + side))
    (left_edge, top), (right_edge, bottom) = begin.astype(int), np.ceil(end).astype(int)
    part = np.ascontiguousarray(pixels[top:bottom, left_edge:right_edge])
    # Of a large face, as many pixels as are asked for: BlazeFace knows no others.
    small = min(1.0, 2 * _SIDE / side)
    fewer = cv2.resize(eight_bit(part), None, fx=small, fy=small, interpolation=cv2.INTER_AREA)
    upright = np.column_stack([to_photo * small, (shift - (left_edge, top)) * small])
    crop = cv2.warpAffine(
        fewer, upright, (_SIDE, _SIDE), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    )
    return not detect_blazeface(np.asarray(crop, np.uint8), _LEAST_SCORE)
