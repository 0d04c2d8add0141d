"""Uneven light on a chart: a patch is of one color, so what slopes within it is light.

Falloff of a lamp and of a lens alike. log2 of light is a polynomial over the chart, whose slopes
are those of the code values within all 24 patches, through the slope of the response.
"""

from __future__ import annotations

import numpy as np

from facecrf_ocio.chart.patches import Patches
from facecrf_ocio.chart.reflectances import COLUMNS, ROWS
from facecrf_ocio.values import Float, InverseCRF

_MIDDLE = ((COLUMNS - 1) / 2.0, (ROWS - 1) / 2.0)  # column and row
_ACROSS = COLUMNS / 2.0  # columns that are one unit of the polynomial
_SPREAD = (1.0, 1.0, 0.3, 0.3, 0.3)  # [stop] prior of each term: x, y, x^2, x y, y^2
_ROUNDS, _HUBER = 4, 2.0  # [standard deviation] beyond which a slope counts less
_LEAST_SLOPE = 0.1  # [stop / full range] a curve that jumps there says nothing of light
_DARK = 16.0 / 255.0  # [encoded] glare slopes there as much as light


def log_light(patches: Patches, curve: InverseCRF) -> Float:
    """(24,) log2 of the light on each patch; 0 at the chart's middle."""
    terms, right, weight = _slopes(patches, curve)
    found: Float = np.zeros(terms.shape[1])
    ridge = np.diag(1.0 / np.square(_SPREAD))
    for _ in range(_ROUNDS):
        away = np.abs(right - terms @ found) * weight
        trust = weight**2 * np.minimum(1.0, _HUBER / np.maximum(away, 1e-9))
        found = np.linalg.solve(
            (terms * trust[:, None]).T @ terms + ridge, terms.T @ (trust * right)
        )
    x, y = _places().T
    return np.asarray(np.column_stack([x, y, x * x, x * y, y * y]) @ found)


def _places() -> Float:
    """(24, 2) of the patches from the chart's middle, in units of half its width."""
    rows, columns = np.divmod(np.arange(ROWS * COLUMNS), COLUMNS)
    return np.column_stack([columns - _MIDDLE[0], rows - _MIDDLE[1]]) / _ACROSS


def _slopes(patches: Patches, curve: InverseCRF) -> tuple[Float, Float, Float]:
    """Derivatives of the terms, measured slopes [stop per unit], and their weights."""
    x, y = _places().T
    one, none = np.ones_like(x), np.zeros_like(x)
    by_x = np.column_stack([one, none, 2 * x, y, none])
    by_y = np.column_stack([none, one, none, x, 2 * y])
    terms, right, weight = [], [], []
    for channel in range(3):
        stops = np.log2(np.maximum(curve.linear[channel], 2.0**-14))
        per_code = np.interp(
            patches.mean[:, channel], curve.encoded, np.gradient(stops, curve.encoded)
        )
        good = patches.usable[:, channel] & (patches.mean[:, channel] > _DARK)
        for axis, derivative in enumerate((by_x, by_y)):
            scale = _ACROSS * np.maximum(per_code[good], _LEAST_SLOPE)
            terms.append(derivative[good])
            right.append(scale * patches.slope[good, channel, axis])
            weight.append(1.0 / (scale * patches.slope_deviation[good, channel, axis]))
    return np.concatenate(terms), np.concatenate(right), np.concatenate(weight)
