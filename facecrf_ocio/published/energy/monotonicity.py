"""Monotonicity prior E_m: a response that falls has no inverse (sec. 4.2, eq. 18)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.values import Float


@dataclass(frozen=True, slots=True)
class Monotonicity:
    """Number of grid intervals in which a curve falls.

    Eq. 18 counts with a step function, which has no gradient to follow. Here the step is a smooth
    ramp: 0 for every slope that is not negative (so every valid curve has energy 0 as printed),
    1 from the slope `-softness` down.

    Attributes
    ----------
    softness
        Slope (linear per encoded) over which the step rises.
    """

    softness: float = 0.01

    def value_and_gradient(self, samples: Float) -> tuple[float, Float]:
        """Count of falling intervals in all three curves, and its gradient; see `Term`."""
        scale = (samples.shape[1] - 1) / self.softness
        depth = np.clip(-np.diff(samples, axis=1) * scale, 0.0, 1.0)
        slope = -6.0 * depth * (1.0 - depth) * scale
        gradient = np.zeros_like(samples)
        gradient[:, 1:] += slope
        gradient[:, :-1] -= slope
        return float((depth * depth * (3.0 - 2.0 * depth)).sum()), gradient
