"""Central differences of an energy, for tests of its gradient."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def directional_slopes(
    energy: Callable[[np.ndarray], float], at: np.ndarray, directions: np.ndarray, step: float
) -> np.ndarray:
    """Slopes of `energy` at `at` along each of `directions` (N, ...)."""
    return np.array(
        [(energy(at + step * d) - energy(at - step * d)) / (2.0 * step) for d in directions]
    )
