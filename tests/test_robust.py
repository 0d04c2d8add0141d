"""Robust weights: what most residuals say, whatever a few wrong ones do."""

from __future__ import annotations

import numpy as np
import pytest

from facecrf_ocio.response.robust import (
    biweight,
    biweight_of_squares,
    robust_deviation,
    robust_deviations,
)

RESIDUALS = np.random.default_rng(5).normal(0.0, 0.03, 10_001)


def test_tukeys_biweight_goes_from_one_to_nothing():
    weights = biweight(np.array([0.0, 1.0, -1.0, 4.684, 4.685, -50.0, 1e100]), 1.0)
    assert weights[0] == 1.0
    assert weights[1] == weights[2] == pytest.approx((1.0 - 1.0 / 4.685**2) ** 2)
    assert 0.0 < weights[3] < 1e-6
    assert not weights[4:].any()


def test_a_mean_by_it_is_95_percent_efficient_for_gaussian_residuals():
    """By its influence (Huber, Robust Statistics, 1981)."""
    residuals = np.linspace(-8.0, 8.0, 16_001)
    share = np.exp(-0.5 * residuals**2)
    share /= share.sum()
    influence = residuals * biweight(residuals, 1.0)
    slope = share @ np.gradient(influence, residuals)
    assert slope**2 / (share @ influence**2) == pytest.approx(0.95, abs=2e-4)


def test_squares_in_units_of_variances_weigh_the_same():
    both = biweight(RESIDUALS, 0.02), biweight_of_squares(RESIDUALS**2 / 0.02**2)
    np.testing.assert_allclose(*both, rtol=0.0, atol=1e-14)


def test_deviations_are_those_of_gaussian_residuals():
    assert robust_deviation(RESIDUALS) == pytest.approx(0.03, rel=0.03)


def test_a_fifth_of_wrong_residuals_moves_deviations_by_less_than_half():
    wrong = RESIDUALS.copy()
    wrong[::5] = 1e6
    assert robust_deviation(wrong) < 1.5 * robust_deviation(RESIDUALS)


def test_rows_have_a_deviation_each():
    rows = np.stack([RESIDUALS, 2.0 * RESIDUALS])
    assert robust_deviations(rows).tolist() == [[robust_deviation(one)] for one in rows]
