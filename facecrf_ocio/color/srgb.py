"""The curve of sRGB (IEC 61966-2-1, 4.2 and 5.2)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float

# Code value and light at which the straight part, of this slope, gives way to the power.
_CODE, _LIGHT, _SLOPE = 0.04045, 0.0031308, 12.92
_OFFSET, _POWER = 0.055, 2.4  # of the power, by IEC 61966-2-1


def decode_srgb(encoded: npt.ArrayLike) -> Float:
    """Linear light of code values; both in [0, 1], of any shape."""
    codes = np.asarray(encoded)
    curved = ((codes + _OFFSET) / (1.0 + _OFFSET)) ** _POWER
    return np.where(codes <= _CODE, codes / _SLOPE, curved)


def encode_srgb(linear: npt.ArrayLike) -> Float:
    """Code values (...) of linear light (...), which is clamped to [0, 1]."""
    light = np.clip(linear, 0.0, 1.0)
    curved = (1.0 + _OFFSET) * np.power(light, 1.0 / _POWER) - _OFFSET
    return np.where(light <= _LIGHT, _SLOPE * light, curved)
