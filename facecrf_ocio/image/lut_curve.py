"""The camera's curve in a LUT file: what each channel's code values are in linear light."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from facecrf_ocio.errors import LutError
from facecrf_ocio.image.lut_lookup import lut_lookup
from facecrf_ocio.response.model import CURVE_SIZE, strictly_increasing
from facecrf_ocio.values import InverseCRF

_BLACK = 0.01  # of white: light of code 0, where no camera's curve begins higher
_ROUNDING = 1e-6  # of white, by which single precision may let a rising table fall
_ANOTHER = "give a 1-D LUT from code values to linear light, such as facecrf writes, or a record"


def curve_of_lut(path: str | Path) -> InverseCRF:
    """Read a LUT file that linearizes as a curve of each channel, white at 1.

    Parameters
    ----------
    path
        Any file OpenColorIO reads that keeps the channels apart.

    Raises
    ------
    LutError
        As `lut_lookup` does, or if the file mixes channels, as 3-D LUTs and matrices do, encodes,
        falls, is constant, or begins far from black.
    """
    path = Path(path)
    lookup = lut_lookup(path, "linearize")
    if not lookup.separable:
        raise _no_curve(path, "is a 3-D LUT or has a matrix, and no curve for each channel")
    if lookup.encodes:
        raise _no_curve(path, f"goes from light to code values, by {lookup.encodes}")
    codes = np.linspace(0.0, 1.0, CURVE_SIZE)
    gray = np.repeat(codes[None, :, None], 3, axis=2).astype(np.float32)
    light = lookup.apply(gray)[0].T.astype(np.float64)
    for name, channel in zip("RGB", light, strict=True):
        white = channel[-1]
        if white <= channel[0]:
            raise _no_curve(path, f"{name} does not rise from black to white")
        falls = np.diff(channel) < -_ROUNDING * white
        if falls.any():
            code = 255.0 * codes[int(np.argmax(falls)) + 1]
            raise _no_curve(path, f"{name} falls at code {code:.0f} of 255, and light does not")
        if abs(channel[0]) > _BLACK * white:
            problem = f"{name} makes {channel[0] / white:.2f} of white of code 0"
            raise _no_curve(path, f"{problem}, and a camera's curve makes black")
    return InverseCRF(codes, strictly_increasing(np.maximum(light, 0.0)))


def _no_curve(path: Path, problem: str) -> LutError:
    return LutError(f"{path}: {problem}; {_ANOTHER}")
