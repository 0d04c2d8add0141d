"""Scaling 8-bit codes down to floats: rows are summed as the integers they are."""

from __future__ import annotations

from itertools import pairwise
from math import ceil, floor

import cv2
import numpy as np
import numpy.typing as npt


def area_means(codes: npt.NDArray[np.uint8], size_xy: tuple[int, int]) -> npt.NDArray[np.float32]:
    """Mean encoded values over the area of each pixel of a smaller grid.

    What OpenCV's INTER_AREA gives of the codes as floats, but for rounding in single precision, in
    a fifth of the time: it has no way from codes to floats.

    Parameters
    ----------
    codes
        (H, W, 3).
    size_xy
        Width and height of the result: no wider than the codes, and at most half as high.

    Returns
    -------
    numpy.ndarray
        (height, width, 3), [0, 1].
    """
    height, width, channels = codes.shape
    rows = np.ascontiguousarray(codes).reshape(height, width * channels)
    edges = np.linspace(0.0, height, size_xy[1] + 1).tolist()
    sums = np.stack([_sum(rows, *span) for span in pairwise(edges)])
    sums *= np.float32(size_xy[1] / (height * 255.0))
    narrow = sums.reshape(size_xy[1], width, channels)
    return np.asarray(cv2.resize(narrow, size_xy, interpolation=cv2.INTER_AREA), np.float32)


def _sum(rows: npt.NDArray[np.uint8], top: float, bottom: float) -> npt.NDArray[np.float32]:
    """(N,) sum of rows from `top` to `bottom`, of the first and the last as much as is inside."""
    first, last = ceil(top), floor(bottom)
    sums = cv2.reduce(rows[first:last], 0, cv2.REDUCE_SUM, dtype=cv2.CV_32F)
    found = np.asarray(sums[0], np.float32)
    if first > top:
        found += np.float32(first - top) * rows[first - 1]
    if bottom > last:
        found += np.float32(bottom - last) * rows[last]
    return found
