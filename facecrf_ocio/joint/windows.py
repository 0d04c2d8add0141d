"""Where the estimator looks at a photo at its native size: a fixed budget, however large it is."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.values import Float

SIDE = 192
"""[px] Side of a window."""
_ALIGNED = 16  # px: blocks of a JPEG with halved colors; windows begin where blocks do
_PHOTO, _FACE = 3, 2  # windows along each side

Window = tuple[slice, slice]


def photo_windows(height: int, width: int) -> list[Window]:
    """Nine windows spread from edge to edge; sides of up to three windows are taken whole."""
    return [
        (rows, columns) for rows in _cuts(0, height, _PHOTO) for columns in _cuts(0, width, _PHOTO)
    ]


def face_windows(landmarks_xyz: Float, height: int, width: int) -> list[Window]:
    """Four windows inside a face, or all of a face of up to two windows each way.

    Parameters
    ----------
    landmarks_xyz
        (N, 3) in pixels of the photo.
    height, width
        Of the photo.
    """
    low = np.clip(np.floor(landmarks_xyz[:, :2].min(axis=0)), 0, [width - 1, height - 1])
    high = np.clip(np.ceil(landmarks_xyz[:, :2].max(axis=0)), low + 1, [width, height])
    (left, top), (right, bottom) = low.astype(int), high.astype(int)
    return [
        (rows, columns)
        for rows in _cuts(int(top), int(bottom), _FACE)
        for columns in _cuts(int(left), int(right), _FACE)
    ]


def _cuts(start: int, stop: int, parts: int) -> list[slice]:
    """The whole range if it is short, else `parts` windows whose middles are spread over it.

    Those of a photo reach its edges; those of a face, whose edge is hair and background, do not.
    """
    size = stop - start
    if size <= parts * SIDE:
        begin = start // _ALIGNED * _ALIGNED
        return [slice(begin, stop)]
    if parts == _PHOTO:
        first = np.linspace(start, stop - SIDE, parts)
    else:
        first = start + size * (np.arange(parts) + 0.5) / parts - SIDE / 2
    return [slice(b, b + SIDE) for b in (first.astype(int) // _ALIGNED * _ALIGNED).tolist()]
