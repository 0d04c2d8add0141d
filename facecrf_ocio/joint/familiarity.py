"""How far a photo's statistics are from those of all photos in training.

Networks answer whatever they are shown, and as surely. Where statistics lie beyond nearly all that
training showed, the band is widened in proportion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from facecrf_ocio.joint.whole_steps import exact_array
from facecrf_ocio.values import Float, frozen


@dataclass(frozen=True, slots=True, eq=False)
class Familiarity:
    """The spread of training's statistics along their principal axes, and beside them.

    Attributes
    ----------
    axes, spread
        (J, S) unit vectors over standardized statistics, and (J,) deviations along them.
    beside
        Mean square of what the axes leave of a photo's statistics.
    usual
        Distance that 95 of 100 photos in training do not exceed.
    """

    axes: Float
    spread: Float
    beside: float
    usual: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "axes", frozen(self.axes))
        object.__setattr__(self, "spread", frozen(self.spread))

    def distance(self, standardized: Float) -> Float:
        """Of photos (..., S): the root of a mean square that is 1 on the average in training."""
        along = standardized @ self.axes.T
        left = (standardized**2).sum(axis=-1) - (along**2).sum(axis=-1)
        inside = ((along / self.spread) ** 2).mean(axis=-1)
        return np.asarray(np.sqrt(0.5 * (inside + np.maximum(left, 0.0) / self.beside)))

    def stretch(self, standardized: Float) -> float:
        """Factor on the deviation of a photo's posterior, at least 1."""
        return max(1.0, float(self.distance(standardized)) / self.usual)


def familiarity_of(arrays: Mapping[str, Float]) -> Familiarity | None:
    """What a file of weights holds of it; None if it was made without."""
    if "familiarity_axes" not in arrays:
        return None
    return Familiarity(
        exact_array(arrays, "familiarity_axes"),
        np.asarray(arrays["familiarity_spread"], np.float64),
        float(arrays["familiarity_beside"]),
        float(arrays["familiarity_usual"]),
    )


def fit_familiarity(standardized: Float, axes: int = 40) -> Familiarity:
    """From the standardized statistics (N, S) of all photos in training."""
    values, vectors = np.linalg.eigh(standardized.T @ standardized / len(standardized))
    kept = vectors[:, ::-1][:, :axes].T
    spread = np.sqrt(values[::-1][:axes])
    beside = float(values[::-1][axes:].sum())
    fitted = Familiarity(kept, spread, beside, 1.0)
    usual = float(np.quantile(fitted.distance(standardized), 0.95))
    return Familiarity(kept, spread, beside, usual)
