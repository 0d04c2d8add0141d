"""Looking codes up in a table, by OpenCV where it can and by NumPy where it cannot."""

from __future__ import annotations

from functools import cache
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

Pixels = npt.NDArray[Any]


@cache
def opencv_looks_up_16_bits() -> bool:
    """Whether this OpenCV does; before 4.13 it knows tables of 256 entries only."""
    try:
        cv2.LUT(np.zeros((1, 1), np.uint16), np.zeros((1, 65536), np.float32))
    except cv2.error:
        return False
    return True


def opencv_look_up(codes: Any, table: Pixels, out: Pixels) -> None:
    """Fill (H, W, C) with entries of (N, C) at codes (H, W, C)."""
    # Half floats go as 16-bit integers, which every version of OpenCV copies as they are.
    kind = np.uint16 if out.dtype == np.float16 else np.float32
    target: Any = out.view(kind)
    entries: Any = table.view(kind)[None]
    result = cv2.LUT(codes, entries, dst=target if out.flags.c_contiguous else None)
    if result is not target:
        target[...] = np.reshape(result, target.shape)


def numpy_look_up(codes: Pixels, table: Pixels, out: Pixels) -> None:
    """Do the same with NumPy: (H, W, C) codes through a table (K, C) into `out` (H, W, C)."""
    for channel in range(codes.shape[2]):
        column = np.ascontiguousarray(table[:, channel])
        out[..., channel] = np.take(column, codes[..., channel])
