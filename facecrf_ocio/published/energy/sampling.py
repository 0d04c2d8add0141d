"""Linear interpolation of the three curves at fixed points, and its transpose for gradients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.values import Float, Index


@dataclass(frozen=True, slots=True, eq=False)
class Sampling:
    """Points at which curves on a uniform grid over [0, 1] are read, the first axis by channel.

    Attributes
    ----------
    lower
        (3, ...) index into the flattened curves (3, K) of the sample below each point.
    fraction
        (3, ...) position of each point in its grid interval, [0, 1].
    size
        Number of grid points K of one curve.
    """

    lower: Index
    fraction: Float
    size: int

    @classmethod
    def at(cls, encoded: Float, size: int) -> Sampling:
        """Points at encoded values (3, ...) in [0, 1], for curves of `size` samples."""
        position = np.asarray(encoded, dtype=np.float64) * (size - 1)
        interval = np.clip(position.astype(np.intp), 0, size - 2)
        start = np.arange(3).reshape(-1, *[1] * (position.ndim - 1)) * size
        return cls(interval + start, position - interval, size)

    def values(self, curves: Float) -> Float:
        """The curves (3, K) at the points."""
        flat = curves.ravel()
        below = flat[self.lower]
        return np.asarray(below + (flat[self.lower + 1] - below) * self.fraction)

    def slopes(self, curves: Float) -> Float:
        """Slope of the curves (3, K) in each point's interval, linear per encoded."""
        flat = curves.ravel()
        return np.asarray((flat[self.lower + 1] - flat[self.lower]) * (self.size - 1))

    def gradient(self, by_values: Float, by_slopes: Float | None = None) -> Float:
        """Gradient by the curves' samples (3, K), given those by `values` and by `slopes`."""
        upper = by_values * self.fraction
        lower = by_values - upper
        if by_slopes is not None:
            upper = upper + by_slopes * (self.size - 1)
            lower = lower - by_slopes * (self.size - 1)
        at = self.lower.ravel()
        total = 3 * self.size
        flat: Float = np.bincount(at, lower.ravel(), total).astype(np.float64)
        flat += np.bincount(at + 1, upper.ravel(), total)
        return flat.reshape(3, self.size)
