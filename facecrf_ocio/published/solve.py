"""Minimize a weighted sum of terms over the response model's coefficients (sec. 4.4, eq. 22)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from facecrf_ocio.published.energy.term import Term
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.values import CHANNELS, Float

MAX_ITERATIONS = 100  # of L-BFGS-B, at most


@dataclass(frozen=True, slots=True)
class Weighted:
    """One term of the objective with its name and weight."""

    name: str
    weight: float
    term: Term


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """The minimum that was found.

    Attributes
    ----------
    coefficients
        (3, M); equal rows for a shared curve.
    energy
        Each term's name and weighted value at the minimum.
    converged
        Whether the solver met its tolerance before its limit of iterations.
    """

    coefficients: Float
    energy: tuple[tuple[str, float], ...]
    converged: bool

    @property
    def total(self) -> float:
        """The objective at the minimum."""
        return sum(value for _, value in self.energy)


def solve(model: ResponseModel, terms: Sequence[Weighted], *, shared: bool) -> Solution:
    """Minimize by L-BFGS from the mean curve.

    With the paper's weights the objective has many minima, and kinks where the second and third
    singular values meet, at which line searches end. The lowest minima, which other starts find,
    are worse curves than the one nearest to the mean, and so is what more iterations reach.

    Parameters
    ----------
    model
        Mean and basis that turn coefficients into curves.
    terms
        The objective.
    shared
        One set of coefficients for all three channels, instead of one for each.
    """
    size = len(model.basis)
    # Steps are taken in units of each coefficient's spread: they differ by a factor of forty.
    scale = np.sqrt(np.diagonal(model.mixture.covariances, axis1=1, axis2=2).mean(axis=0))
    rows = 1 if shared else len(CHANNELS)

    def unpack(unknowns: Float) -> Float:
        return np.broadcast_to(unknowns.reshape(rows, size) * scale, (len(CHANNELS), size))

    def evaluate(unknowns: Float) -> tuple[float, Float]:
        value, gradient = objective(model, terms, unpack(unknowns))
        by_free = gradient.sum(axis=0, keepdims=True) if shared else gradient
        return value, (by_free * scale).ravel()

    result = scipy.optimize.minimize(
        evaluate,
        np.zeros(rows * size),
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": MAX_ITERATIONS, "maxcor": 20},
    )
    coefficients = np.array(unpack(result.x))
    samples = model.samples(coefficients)
    energy = tuple((t.name, t.weight * t.term.value_and_gradient(samples)[0]) for t in terms)
    return Solution(coefficients, energy, bool(result.success))


def objective(
    model: ResponseModel, terms: Sequence[Weighted], coefficients: Float
) -> tuple[float, Float]:
    """E(c) of eq. 22 and its gradient, for coefficients (3, M)."""
    samples = model.samples(coefficients)
    value, by_samples = 0.0, np.zeros_like(samples)
    for weighted in terms:
        term_value, term_gradient = weighted.term.value_and_gradient(samples)
        value += weighted.weight * term_value
        by_samples += weighted.weight * term_gradient
    return value, by_samples @ model.basis.T
