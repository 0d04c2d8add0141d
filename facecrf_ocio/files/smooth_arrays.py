"""Arrays of curves, stored so that a wheel compresses them, by a third to a half, bit for bit.

The bits of a number in single precision, taken as a whole number, differ little from those of its
neighbor on a curve. The differences are stored, all their lowest bytes first.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

SMOOTH = "_smooth"  # ends the name of an array that is stored so


def smooth_bytes(values: npt.NDArray[np.floating[Any]]) -> npt.NDArray[np.uint8]:
    """(4, ..., K) bytes of curves (..., K), which go to single precision."""
    bits = np.ascontiguousarray(values, "<f4").view("<u4")
    steps = np.diff(bits, axis=-1, prepend=np.uint32(0))  # modulo 2^32
    return np.ascontiguousarray(np.moveaxis(steps[..., None].view(np.uint8), -1, 0))


def smooth_array(arrays: Mapping[str, npt.NDArray[Any]], name: str) -> npt.NDArray[Any]:
    """One array of curves of a file; older files hold it as it is."""
    if name in arrays:
        return arrays[name]
    steps = np.ascontiguousarray(np.moveaxis(arrays[f"{name}{SMOOTH}"], 0, -1)).view("<u4")
    return np.cumsum(steps[..., 0], axis=-1, dtype=np.uint32).view(np.float32)
