"""Types of pixels: the numbers that they stand for, and the way to half floats."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

Pixels = npt.NDArray[Any]
Float32 = npt.NDArray[np.float32]

HALF_MAX = 65504.0  # largest finite half float
MAXIMA = {np.dtype(np.uint8): 255, np.dtype(np.uint16): 65535}  # codes of white


def every_value(dtype: np.dtype[Any], maximum: int) -> Float32:
    """(256,) or (65536,) the number that each bit pattern stands for."""
    if dtype == np.float16:
        return as_float(np.arange(65536, dtype=np.uint16).view(np.float16), 1)
    codes = np.arange(np.iinfo(dtype).max + 1)
    return np.asarray(np.minimum(codes, maximum) / maximum, np.float32)


def as_float(pixels: Pixels, maximum: int) -> Float32:
    """Encoded values of integers, of any shape, by the code of white; floats as they are."""
    if pixels.dtype.kind == "u":
        return np.minimum(pixels / np.float32(maximum), 1, dtype=np.float32)
    with np.errstate(invalid="ignore"):  # signaling NaN
        return pixels.astype(np.float32)


def as_half(values: Float32, color: Sequence[int]) -> Pixels:
    """(H, W, C) float16: of its `color` channels what is too bright is cut, the rest infinite."""
    if len(color) == values.shape[-1]:
        values = np.clip(values, -HALF_MAX, HALF_MAX)
    else:
        values = values.copy()
        values[..., list(color)] = np.clip(values[..., list(color)], -HALF_MAX, HALF_MAX)
    if hasattr(cv2, "convertFp16"):  # until OpenCV 5
        bits = cv2.convertFp16(values.reshape(len(values), -1))
        return np.asarray(bits).view(np.float16).reshape(values.shape)
    add: Any = cv2.add  # four times as fast as numpy's `astype`, and equal
    return np.asarray(add(values.reshape(len(values), -1), 0.0, dtype=cv2.CV_16F)).reshape(
        values.shape
    )
