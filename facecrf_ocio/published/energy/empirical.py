"""Empirical prior E_G: how unlike real responses a curve is (sec. 4.3, eq. 21)."""

from __future__ import annotations

from dataclasses import dataclass

from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.values import Float


@dataclass(frozen=True, slots=True)
class Empirical:
    """Minus the log density of the coefficients under the response model, summed over channels."""

    model: ResponseModel

    def value_and_gradient(self, samples: Float) -> tuple[float, Float]:
        """E_G of the three curves and its gradient by their samples; see `Term`."""
        coefficients = self.model.coefficients(samples)
        value = -float(self.model.mixture.log_density(coefficients).sum())
        return value, -self.model.mixture.gradient(coefficients) @ self.model.basis
