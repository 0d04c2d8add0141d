"""Noise seen through a response: its formulas, what they leave open, and the fit that uses them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from facecrf_ocio.published.energy.log_slope import CENTERS, INTERVALS, curve_of, log_slope_prior
from facecrf_ocio.published.energy.noise_symmetry import RegionNoise, exact_moments, fit_noise
from facecrf_ocio.response.model import dorf_model

MODEL = dorf_model()
PRIOR = log_slope_prior(MODEL)
GRID = MODEL.grid
CODES = np.linspace(0.04, 0.97, 47)


def log_slopes_of(curve):
    return np.log(np.diff(np.interp(np.linspace(0, 1, INTERVALS + 1), GRID, curve)) * INTERVALS)


def levels_of(log_slopes, shot, read, *, pixels=1e9):
    log_variance, skewness = exact_moments(CODES, log_slopes, shot, read)
    count = np.full(CODES.size, pixels)
    return RegionNoise(CODES, np.exp(log_variance), skewness, count, np.ones(CODES.size))


def rmse(log_slopes, curve):
    return float(np.sqrt(((curve_of(log_slopes, GRID) - curve) ** 2).mean()))


@settings(max_examples=20, deadline=None)
@given(st.floats(0.0, 1.0), st.floats(0.5, 3.0))
def test_variance_alone_leaves_one_degree_of_freedom_open(share, exponent):
    """`g = (1 - k) t^2 + k t` has the same noise variance in code values for every k."""
    codes = np.linspace(0.05, 0.95, 200)
    t, dt = codes**exponent, exponent * codes ** (exponent - 1.0)
    curve, slope = (1 - share) * t**2 + share * t, (2 * (1 - share) * t + share) * dt
    # A = 4 (1 - k) s, B = k^2 s, in a common unit s.
    variance = (4.0 * (1.0 - share) * curve + share**2) / slope**2
    assert variance * dt**2 == pytest.approx(np.ones(200), rel=1e-9)


def test_small_noise_has_the_moments_of_first_order():
    log_slopes = np.log(2.2 * CENTERS**1.2)
    codes = np.linspace(0.3, 0.9, 7)
    log_variance, skewness = exact_moments(codes, log_slopes, 1e-4, 1e-6)
    variance = (1e-4 * codes**2.2 + 1e-6) / (2.2 * codes**1.2) ** 2
    assert log_variance == pytest.approx(np.log(variance), abs=0.01)
    assert skewness == pytest.approx(-3.0 * np.sqrt(variance) * 1.2 / codes, rel=0.05)


def test_large_noise_has_the_moments_of_a_simulation():
    log_slopes = np.log(2.2 * CENTERS**1.2)
    full = np.exp(log_slopes).mean()
    curve = curve_of(log_slopes, GRID) * full
    light, spread = 0.3, np.sqrt(2e-3 * 0.3 + 1e-4)
    noise = np.random.default_rng(0).normal(size=2_000_000)
    codes = np.interp(light + spread * noise, curve, GRID)
    log_variance, skewness = exact_moments(np.array([codes.mean()]), log_slopes, 2e-3, 1e-4)
    offset = codes - codes.mean()
    assert log_variance[0] == pytest.approx(np.log((offset**2).mean()), abs=0.01)
    assert skewness[0] == pytest.approx((offset**3).mean() / codes.std() ** 3, abs=0.01)


@pytest.mark.parametrize("read", [1e-6, 1e-4])
@pytest.mark.parametrize("curve", [MODEL.mean, GRID**2.2], ids=["mean", "gamma22"])
def test_exact_noise_gives_curve_and_noise_parameters(curve, read):
    levels = levels_of(log_slopes_of(curve), 1e-3, read)
    found = fit_noise([levels], PRIOR)
    full = np.exp(log_slopes_of(curve)).mean()
    assert rmse(found.log_slopes, curve) < 0.008
    assert found.shot[0] * full == pytest.approx(1e-3, rel=0.1)
    assert found.read[0] * full**2 == pytest.approx(read, rel=0.2, abs=1e-5)


def test_channels_that_share_a_curve_keep_their_own_noise():
    log_slopes = log_slopes_of(MODEL.mean)
    channels = [levels_of(log_slopes, shot, 1e-5) for shot in (4e-4, 1e-3, 2e-3)]
    found = fit_noise(channels, PRIOR)
    assert rmse(found.log_slopes, MODEL.mean) < 0.008
    assert found.shot == pytest.approx([4e-4, 1e-3, 2e-3], rel=0.1)


def test_levels_that_contradict_the_noise_model_leave_the_curve_near_the_prior():
    levels = levels_of(log_slopes_of(GRID**2.2), 1e-3, 1e-5)
    distances = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        rough = RegionNoise(
            CODES,
            levels.variance * np.exp(rng.normal(0.0, 1.0, CODES.size)),
            rng.normal(0.0, 1.0, CODES.size),
            levels.pixels,
            levels.dilution,
        )
        found = fit_noise([rough], PRIOR).log_slopes
        distances.append(rmse(found, curve_of(PRIOR.mean, GRID)))
    # At face value, errors of 100 % that claim to be of 0.3 % bend the curve by 0.41 in the median.
    assert np.median(distances) < 0.1


def test_few_pixels_stay_nearer_to_the_prior_than_many():
    curve = GRID**2.2
    few, many = (
        fit_noise([levels_of(log_slopes_of(curve), 1e-3, 1e-5, pixels=n)], PRIOR)
        for n in (30.0, 1e8)
    )
    assert rmse(many.log_slopes, curve) < rmse(few.log_slopes, curve)
