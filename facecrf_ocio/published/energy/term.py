"""What every energy is to the solver: a function of the curves' samples with its gradient."""

from __future__ import annotations

from typing import Protocol

from facecrf_ocio.values import Float


class Term(Protocol):
    """One term of an objective over candidate inverse curves."""

    def value_and_gradient(self, samples: Float) -> tuple[float, Float]:
        """Evaluate at the curves (3, K) on the model's grid.

        Returns
        -------
        tuple
            The energy, and its gradient (3, K) by the samples.
        """
        ...
