"""Curves by their log slopes: always valid, and conditioned on evidence as a Gaussian must be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from facecrf_ocio.published.energy.log_slope import (
    CENTERS,
    INTERVALS,
    curve_of,
    interpolation_rows,
    log_slope_prior,
)
from facecrf_ocio.response.model import dorf_model

MODEL = dorf_model()
PRIOR = log_slope_prior(MODEL)
seeds = st.integers(0, 10_000)


def evidence(seed, count=6):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(count, INTERVALS)), rng.normal(size=count), rng.uniform(0.1, 1.0, count)


@given(seeds)
def test_every_vector_of_log_slopes_is_a_valid_inverse_response(seed):
    curve = curve_of(np.random.default_rng(seed).normal(0.0, 3.0, INTERVALS), MODEL.grid)
    assert curve[0] == 0.0
    assert curve[-1] == 1.0
    assert (np.diff(curve) > 0.0).all()


@pytest.mark.parametrize("gamma", [1.0, 1.8, 2.2])
def test_the_log_slopes_of_a_power_give_that_power(gamma):
    curve = curve_of(np.log(gamma * CENTERS ** (gamma - 1.0)), MODEL.grid)
    assert np.abs(curve - MODEL.grid**gamma).max() < 2e-3


def test_a_constant_factor_of_the_slopes_is_exposure_and_does_not_change_the_curve():
    assert curve_of(PRIOR.mean + 1.0, MODEL.grid) == pytest.approx(curve_of(PRIOR.mean, MODEL.grid))


def test_the_center_of_the_prior_lies_near_the_mean_curve():
    error = curve_of(PRIOR.mean, MODEL.grid) - MODEL.mean
    assert np.sqrt((error**2).mean()) < 0.03


def test_the_prior_is_the_same_every_time():
    again = log_slope_prior(MODEL)
    assert np.array_equal(again.mean, PRIOR.mean)
    assert np.array_equal(again.covariance, PRIOR.covariance)


@given(seeds)
def test_conditioning_minimizes_the_sum_of_squares_it_stands_for(seed):
    rows, values, deviation = evidence(seed)
    found = PRIOR.condition(rows, values, deviation)
    precision = np.linalg.inv(PRIOR.covariance)
    gradient = precision @ (found - PRIOR.mean) + rows.T @ ((rows @ found - values) / deviation**2)
    assert np.abs(gradient).max() < 1e-5 * np.abs(precision).max()


@given(seeds)
def test_surprise_is_the_error_of_predicting_each_value_from_the_others(seed):
    rows, values, deviation = evidence(seed)
    surprise = PRIOR.surprise(rows, values, deviation)
    for left_out in range(len(values)):
        others = np.delete(np.arange(len(values)), left_out)
        covariance = rows @ PRIOR.covariance @ rows.T + np.diag(deviation**2)
        gain = covariance[left_out, others] @ np.linalg.inv(covariance[np.ix_(others, others)])
        expected = values - rows @ PRIOR.mean
        error = expected[left_out] - gain @ expected[others]
        variance = covariance[left_out, left_out] - gain @ covariance[others, left_out]
        assert surprise[left_out] == pytest.approx(error / np.sqrt(variance), rel=1e-6, abs=1e-9)


def test_rows_read_the_log_slopes_at_the_centers_and_halfway_between():
    log_slopes = np.random.default_rng(0).normal(size=INTERVALS)
    assert interpolation_rows(CENTERS) @ log_slopes == pytest.approx(log_slopes)
    halfway = (CENTERS[1:] + CENTERS[:-1]) / 2.0
    middle = (log_slopes[1:] + log_slopes[:-1]) / 2.0
    assert interpolation_rows(halfway) @ log_slopes == pytest.approx(middle)
