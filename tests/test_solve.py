"""The minimum of a weighted sum of terms, where the answer is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from differences import directional_slopes

from facecrf_ocio.published.energy.empirical import Empirical
from facecrf_ocio.published.energy.monotonicity import Monotonicity
from facecrf_ocio.published.solve import Weighted, objective, solve
from facecrf_ocio.response.model import dorf_model

MODEL = dorf_model()
COEFFICIENTS = np.random.default_rng(0).normal(0.0, [2.0, 0.5, 0.2, 0.1, 0.05], (3, 5))


@dataclass(frozen=True)
class Distance:
    """Squared distance from given samples (3, K)."""

    target: np.ndarray

    def value_and_gradient(self, samples):
        offset = samples - self.target
        return float((offset**2).sum()), 2.0 * offset


NEAR = Weighted("near", 1.0, Distance(MODEL.samples(COEFFICIENTS)))
PRIOR = Weighted("empirical", 1.0, Empirical(MODEL))
RISING = Weighted("monotonicity", 1000.0, Monotonicity())


def test_curves_of_the_model_are_found_exactly():
    solution = solve(MODEL, [NEAR], shared=False)
    assert solution.converged
    assert np.allclose(solution.coefficients, COEFFICIENTS, atol=1e-4)
    assert solution.total < 1e-6


def test_curves_outside_of_the_model_are_projected_onto_it():
    target = np.linspace(0, 1, 1024) ** np.array([[0.8], [2.2], [4.0]])
    solution = solve(MODEL, [Weighted("near", 3.0, Distance(target))], shared=False)
    assert np.allclose(solution.coefficients, MODEL.coefficients(target), atol=1e-3)


def test_a_shared_curve_is_the_mean_of_what_the_channels_want():
    solution = solve(MODEL, [NEAR], shared=True)
    assert np.allclose(solution.coefficients, COEFFICIENTS.mean(axis=0), atol=1e-4)
    assert (solution.coefficients == solution.coefficients[0]).all()


def test_weights_balance_the_terms():
    """w1 |x - a|^2 + w2 |x - b|^2 has its minimum at (w1 a + w2 b) / (w1 + w2)."""
    there = Weighted("there", 3.0, Distance(MODEL.samples(-COEFFICIENTS)))
    solution = solve(MODEL, [NEAR, there], shared=False)
    assert np.allclose(solution.coefficients, -0.5 * COEFFICIENTS, atol=1e-4)


def test_the_energy_is_reported_weighted_term_by_term():
    solution = solve(MODEL, [NEAR, PRIOR, RISING], shared=False)
    samples = MODEL.samples(solution.coefficients)
    assert [name for name, _ in solution.energy] == ["near", "empirical", "monotonicity"]
    for weighted, (_, value) in zip([NEAR, PRIOR, RISING], solution.energy, strict=True):
        expected = weighted.weight * weighted.term.value_and_gradient(samples)[0]
        assert value == pytest.approx(expected)
    total, _ = objective(MODEL, [NEAR, PRIOR, RISING], solution.coefficients)
    assert solution.total == pytest.approx(total)


def test_the_objective_s_gradient_agrees_with_differences():
    terms = [NEAR, Weighted("empirical", 2.0, Empirical(MODEL)), RISING]
    _, gradient = objective(MODEL, terms, COEFFICIENTS)
    directions = np.random.default_rng(1).normal(size=(6, 3, 5))
    slopes = directional_slopes(
        lambda c: objective(MODEL, terms, c)[0], COEFFICIENTS, directions, 1e-6
    )
    assert np.allclose(slopes, (directions * gradient).sum(axis=(1, 2)), rtol=1e-4)


@pytest.mark.parametrize("shared", [True, False])
def test_the_prior_alone_ends_at_a_mode_of_the_prior(shared):
    solution = solve(MODEL, [PRIOR, RISING], shared=shared)
    value, gradient = objective(MODEL, [PRIOR, RISING], solution.coefficients)
    at_mean, _ = objective(MODEL, [PRIOR, RISING], np.zeros((3, 5)))
    scale = np.sqrt(np.diagonal(MODEL.mixture.covariances, axis1=1, axis2=2).mean(axis=0))
    assert solution.converged
    assert value < at_mean
    assert np.abs(gradient * scale).max() < 1e-2
    assert np.isclose(solution.coefficients, solution.coefficients[0], atol=1e-3).all()


def test_the_monotonicity_prior_keeps_the_answer_rising():
    falling = np.linspace(0, 1, 1024) + 0.15 * np.sin(4 * np.pi * np.linspace(0, 1, 1024))
    near = Weighted("near", 1.0, Distance(np.tile(falling, (3, 1))))
    free, held = (
        MODEL.samples(solve(MODEL, terms, shared=True).coefficients[0])
        for terms in ([near], [near, RISING])
    )
    assert np.diff(free).min() < -1e-5
    assert Monotonicity().value_and_gradient(np.tile(held, (3, 1)))[0] < 1e-3
