"""Errors in stops are what a compositor would measure with a gray card."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.response.stops import DARKEST, log_light, mean_over, stops_error, uniform
from facecrf_ocio.values import InverseCRF

GRID = np.linspace(0.0, 1.0, 1024)
EXPONENTS = st.floats(0.3, 4.0)


def power(*exponents):
    return np.array([GRID**e for e in exponents])


def rising(seed, channels=3):
    steps = np.random.default_rng(seed).gamma(0.3, size=(channels, GRID.size))
    steps[:, 0] = 0.0
    return np.cumsum(steps, axis=1) / steps.sum(axis=1, keepdims=True)


@given(EXPONENTS, st.floats(1e-6, 1e6))
def test_a_factor_is_no_error(exponent, factor):
    truth = power(exponent)
    error = stops_error(factor * truth, truth, np.ones(256))
    assert max(error.mid, error.shadows, error.used) < 1e-9


@given(st.integers(0, 99), st.floats(1e-3, 1e3))
def test_a_factor_on_either_curve_changes_nothing(seed, factor):
    a, b = rising(seed), rising(seed + 100)
    expected = stops_error(a, b)
    for moved in (stops_error(factor * a, b), stops_error(a, factor * b)):
        assert moved.mid == pytest.approx(expected.mid)
        assert moved.shadows == pytest.approx(expected.shadows)


@given(st.integers(0, 99))
def test_the_order_of_the_two_does_not_matter(seed):
    a, b = rising(seed), rising(seed + 100)
    assert stops_error(a, b).mid == pytest.approx(stops_error(b, a).mid)


@given(EXPONENTS, EXPONENTS)
def test_exponents_differ_by_their_difference_times_the_stops_of_the_code(a, b):
    """log2((c / 128)^a / (c / 128)^b) = (a - b) log2(c / 128)."""
    codes = np.arange(64, 236)
    expected = np.abs(np.maximum(a * np.log2(codes / 128), DARKEST)
                      - np.maximum(b * np.log2(codes / 128), DARKEST)).mean()  # fmt: skip
    assert stops_error(power(a), power(b)).mid == pytest.approx(expected, abs=2e-4)


def test_brute_force_over_codes_and_channels():
    estimate, truth = rising(1), rising(2)
    counts = np.random.default_rng(3).integers(0, 9, (3, 256))

    def light(curves, channel, code):
        return np.interp(code / 255, GRID, curves[channel])

    def middle(curves):
        return np.mean([np.log2(light(curves, c, 128)) for c in range(3)])

    def error(channel, code):
        ours = np.log2(light(estimate, channel, code)) - middle(estimate)
        true = np.log2(light(truth, channel, code)) - middle(truth)
        return abs(max(ours, DARKEST) - max(true, DARKEST))

    found = stops_error(estimate, truth, counts)
    every = [(c, code) for c in range(3) for code in range(1, 255)]
    assert found.mid == pytest.approx(np.mean([error(*at) for at in every if 64 <= at[1] <= 235]))
    assert found.shadows == pytest.approx(
        np.mean([error(*at) for at in every if 16 <= at[1] <= 64])
    )
    weighted = sum(counts[at] * error(*at) for at in every) / counts[:, 1:-1].sum()
    assert found.used == pytest.approx(weighted)


def test_one_factor_is_free_and_not_one_for_each_channel():
    gray = power(2.0, 2.0, 2.0)
    tinted = gray * np.array([[2.0], [1.0], [1.0]])
    assert stops_error(2.0 * gray, gray).mid == pytest.approx(0.0, abs=1e-12)
    # Red is a stop up: a third of it goes into the factor, which leaves 2/3, 1/3 and 1/3.
    assert stops_error(tinted, gray).mid == pytest.approx(4 / 9)


def test_black_is_as_dark_as_a_sensor_can_tell_and_no_darker():
    crushed = np.where(GRID < 0.2, 0.0, GRID)  # codes up to 51 are black
    error = np.abs(log_light(crushed) - log_light(power(1.0)[0]))
    assert error[16] == pytest.approx(-DARKEST - np.log2(128 / 16))
    assert stops_error(crushed, crushed).shadows == 0.0
    assert np.isfinite(stops_error(crushed, power(4.0)[0]).shadows)


def test_codes_that_the_photo_lacks_do_not_count():
    truth = power(2.2)
    wrong = np.where(GRID > 200 / 255, 1.0, truth)
    counts = np.zeros(256)
    counts[20:180] = 5
    assert stops_error(wrong, truth, counts).used == pytest.approx(0.0, abs=1e-12)
    assert stops_error(wrong, truth).mid > 0.05
    clipped = np.zeros(256)
    clipped[[0, 255]] = 1000
    assert stops_error(wrong, truth, clipped).used is None


def test_sizes_of_grids_do_not_matter():
    fine = np.linspace(0.0, 1.0, 4096) ** 2.2
    assert stops_error(fine, GRID**2.2).mid < 1e-4
    curve = InverseCRF(np.array([0.0, 0.3, 1.0]), np.array([[0.0, 0.1, 1.0]] * 3))
    assert stops_error(uniform(curve), np.interp(GRID, curve.encoded, curve.linear[0])).mid < 1e-3


def test_mean_over_includes_both_ends():
    values = np.zeros(256)
    values[[16, 64]] = 49.0
    assert mean_over(values, (16, 64)) == pytest.approx(2.0)


def test_a_curve_of_one_sample_is_refused():
    with pytest.raises(SettingsError, match="two samples"):
        log_light(np.ones(1))
