"""Colors beyond what a transform can take: brought back to where its results are numbers.

A logarithmic curve sends a stray pixel of 1000 to infinity, and a matrix behind it makes NaN of
that. Neither the photo nor the LUT is at fault, so such a color is taken for the farthest one, on
the straight way to it from the nearest code values, that becomes finite.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

Float32 = npt.NDArray[np.float32]
Transform = Callable[[Float32, npt.NDArray[Any]], None]

_HALVINGS = 24  # of the way; float32 has no more digits


def bring_back(transform: Transform, given: Float32, result: Float32) -> bool:
    """Replace what became NaN or infinite of finite colors; say whether there was anything such.

    Colors whose code values, clamped to [0, 1], become no numbers either are left as they are.

    Parameters
    ----------
    transform
        What to apply to (H, W, 3).
    given, result
        (H, W, 3) before and after; the second is changed.
    """
    if _all_finite(result):
        return False
    lost = np.isfinite(given).all(axis=2) & ~np.isfinite(result).all(axis=2)
    if not lost.any():
        return True
    colors = given[lost][None]
    start = np.clip(colors, 0.0, 1.0)
    near, far = np.zeros_like(colors[..., :1]), np.ones_like(colors[..., :1])
    found, _ = _applied(transform, start)
    for _ in range(_HALVINGS):
        middle = (near + far) / 2
        made, finite = _applied(transform, start + middle * (colors - start))
        found = np.where(finite, made, found)
        near, far = np.where(finite, middle, near), np.where(finite, far, middle)
    result[lost] = found[0]
    return True


def some_lost(given: Float32, result: Float32) -> bool:
    """Whether a finite color, (..., 3), became NaN or infinite."""
    if _all_finite(result):
        return False
    return bool((np.isfinite(given).all(axis=-1) & ~np.isfinite(result).all(axis=-1)).any())


def _applied(transform: Transform, colors: Float32) -> tuple[Float32, npt.NDArray[np.bool_]]:
    result = np.empty_like(colors)
    transform(np.ascontiguousarray(colors), result)
    return result, np.asarray(np.isfinite(result).all(axis=2, keepdims=True))


def _all_finite(values: Float32) -> bool:
    """As `np.isfinite(values).all()`, at a third of the cost: a sum of sizes in double precision.

    No sum of finite floats is infinite there, and none with NaN or infinities is finite.
    """
    return values.size == 0 or bool(np.isfinite(cv2.norm(values, cv2.NORM_L1)))
