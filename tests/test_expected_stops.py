"""What is expected of a curve is what the curves that remain possible say."""

from __future__ import annotations

import numpy as np
import pytest

from facecrf_ocio.response.expected_stops import (
    expected_of_draws,
    expected_of_sigma,
    rising,
    share_nearer,
    stops_of_draws,
)
from facecrf_ocio.response.stops import log_light, stops_error
from facecrf_ocio.values import InverseCRF

GRID = np.linspace(0.0, 1.0, 1024)


def powers(count=400, deviation=0.1, center=2.2, seed=0):
    exponents = np.random.default_rng(seed).normal(center, deviation, count)
    return exponents, GRID ** exponents[:, None]


def test_deviations_are_those_of_the_exponent_times_the_stops_of_the_code():
    exponents, draws = powers()
    told = expected_of_draws(GRID**2.2, stops_of_draws(draws))
    deviation = np.quantile(np.abs(exponents - 2.2), 0.6827)
    for code in (16, 40, 64, 200, 235):
        expected = deviation * abs(np.log2(code / 128))
        assert told.sigma[1, code] == pytest.approx(expected, abs=2e-3)
    assert told.sigma[:, 128].max() < 1e-9


def test_the_expected_error_is_the_median_of_the_errors_of_the_draws():
    _, draws = powers(50)
    errors = [stops_error(GRID**2.2, draw) for draw in draws]
    told = expected_of_draws(GRID**2.2, stops_of_draws(draws))
    assert told.mid == pytest.approx(np.median([error.mid for error in errors]))
    assert told.shadows == pytest.approx(np.median([error.shadows for error in errors]))


def test_an_estimate_beside_the_draws_has_more_to_expect():
    _, draws = powers()
    near, far = (expected_of_draws(GRID**e, stops_of_draws(draws)) for e in (2.2, 2.6))
    assert far.mid > 3 * near.mid
    assert (far.sigma[0, 16:120] > near.sigma[0, 16:120]).all()


def test_curves_that_fall_are_left_out_as_long_as_others_remain():
    _, good = powers(60)
    falling = np.tile(np.sin(6 * GRID), (40, 1))
    np.testing.assert_array_equal(rising(np.concatenate([falling, good])), good)
    mended = rising(np.concatenate([falling, good[:10]]))
    assert len(mended) == 50
    assert (np.diff(mended, axis=1) >= 0).all()
    assert mended.min() >= 0.0


def test_deviations_of_light_become_stops_to_first_order():
    """A tenth of light is log2(1.1), about 0.1 / ln 2; mid-gray's own adds to all others."""
    curve = InverseCRF(np.linspace(0, 1, 4096), np.tile(np.linspace(0, 1, 4096) ** 2.2, (3, 1)))
    told = expected_of_sigma(curve, 0.1 * curve.linear)
    expected = np.hypot(0.1, 0.1) / np.log(2)
    np.testing.assert_allclose(np.delete(told.sigma[:, 1:], 127, axis=1), expected, rtol=1e-3)
    assert told.sigma[:, 128].max() == 0.0
    assert told.mid == pytest.approx(np.sqrt(2 / np.pi) * expected * 171 / 172, rel=1e-3)


def test_nothing_deviates_where_nothing_was_estimated():
    curve = InverseCRF(np.linspace(0, 1, 4096), np.tile(np.linspace(0, 1, 4096) ** 2.2, (3, 1)))
    told = expected_of_sigma(curve, np.zeros((3, 4096)))
    assert (told.mid, told.shadows, told.sigma.max()) == (0.0, 0.0, 0.0)


def test_the_share_is_that_of_the_truths_nearer_to_the_curve():
    exponents, draws = powers()
    share = share_nearer(GRID**2.2, GRID**2.4, stops_of_draws(draws))
    assert share == pytest.approx(np.mean(exponents < 2.3), abs=0.01)


@pytest.mark.parametrize("count", [1, 2, 7, 400])
def test_the_deviation_is_the_quantile_of_the_errors_at_each_code(count):
    truths = stops_of_draws(powers(count)[1])
    told = expected_of_draws(GRID**2.1, truths)
    errors = np.abs(truths - log_light(GRID**2.1))
    np.testing.assert_allclose(told.sigma[0], np.quantile(errors, 0.6827, axis=0), rtol=1e-12)
