"""Weights and deviations of residuals in which a minority of wrong ones has no say."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float

_TUKEY = 4.685  # [deviation] that counts nothing; 95 % efficient for Gaussian residuals
_OF_MEDIAN = 1.4826  # standard deviation of Gaussian residuals by the median of their sizes


def biweight(residuals: Float, scale: float) -> Float:
    """Weights (...) from 1 to 0 of residuals (...) of a standard deviation `scale`, by Tukey's."""
    return np.asarray(np.clip(1.0 - (residuals / (_TUKEY * scale)) ** 2, 0.0, 1.0) ** 2)


def biweight_of_squares(squares: Float) -> Float:
    """Tukey's biweight of squares of residuals, each in units of its own variance."""
    return np.asarray(np.clip(1.0 - squares / _TUKEY**2, 0.0, 1.0) ** 2)


def robust_deviation(residuals: npt.NDArray[np.floating]) -> float:
    """Standard deviation of Gaussian residuals around 0, whatever a minority of others is."""
    return _OF_MEDIAN * float(np.median(np.abs(residuals)))


def robust_deviations(rows: Float) -> Float:
    """The same of (N, K) rows, (N, 1)."""
    return np.asarray(_OF_MEDIAN * np.median(np.abs(rows), axis=1, keepdims=True))
