"""The numbers of the bench are what their names say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from facecrf_ocio.benchmark.metrics import error_in_stops, score, weighted_median
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model, strictly_increasing
from facecrf_ocio.values import Confidence, InverseCRF, Verdict

GRID = np.linspace(0.0, 1.0, 1024)
FINE = np.linspace(0.0, 1.0, 4096)


def power(*exponents):
    return InverseCRF(FINE, np.array([FINE**e for e in exponents]))


def truth_of(*exponents):
    return np.array([GRID**e for e in exponents])


def confidence(sigma):
    return Confidence(sigma, np.ones_like(sigma), Verdict.WEAK, ("",))


def counts(seed=0, levels=256):
    return np.random.default_rng(seed).integers(0, 50, (3, levels))


def test_the_truth_has_no_error():
    result = score(power(2.2, 2.2, 2.2), None, truth_of(2.2, 2.2, 2.2), counts())
    assert result.rmse < 1e-6
    assert result.rmse_scaled < 1e-6
    assert result.stops < 1e-4


def test_rmse_is_that_of_the_integral():
    """For exponents a and b the mean square difference is 1/(2a+1) + 1/(2b+1) - 2/(a+b+1)."""
    result = score(power(1.0, 2.0, 3.0), None, truth_of(2.0, 2.0, 2.0), counts())
    exact = [
        np.sqrt(1 / (2 * a + 1) + 1 / 5 - 2 / (a + 3)) if a != 2 else 0.0 for a in (1.0, 2.0, 3.0)
    ]
    np.testing.assert_allclose(result.rmse_channels, exact, atol=2e-4)
    assert result.rmse == pytest.approx(np.mean(exact), abs=2e-4)


def test_the_free_scale_is_the_best_one():
    truth = truth_of(2.0, 2.4, 2.8)
    result = score(power(3.0, 3.0, 3.5), None, truth, counts())
    estimated = np.array([GRID**3.0, GRID**3.0, GRID**3.5])
    scales = np.linspace(0.5, 2.0, 15001)
    total = [((s * estimated - truth) ** 2).sum() for s in scales]
    best = scales[np.argmin(total)]
    direct = np.sqrt(((best * estimated - truth) ** 2).mean(axis=1)).mean()
    assert result.rmse_scaled == pytest.approx(direct, abs=1e-4)
    assert result.rmse_scaled < result.rmse


def test_stops_are_the_median_over_pixels():
    truth, pixels = truth_of(2.0, 2.2, 2.4), counts(1)
    curve = power(2.5, 2.2, 2.0)
    codes = np.arange(1, 255) / 255
    exponents = np.array([[0.5], [0.0], [-0.4]])
    stops = (exponents * np.log2(codes)).ravel()
    listed = np.repeat(stops, pixels[:, 1:255].ravel())
    deviation = np.abs(listed - np.median(listed))
    assert error_in_stops(curve, truth, pixels) == pytest.approx(np.median(deviation), abs=2e-3)


def test_stops_ignore_exposure_and_codes_the_photo_does_not_use():
    truth = truth_of(2.0, 2.0, 2.0)
    bent = np.where(FINE < 0.8, 0.5 * FINE**2, np.interp(FINE, [0.8, 1.0], [0.32, 1.0]))
    curve = InverseCRF(FINE, np.tile(bent, (3, 1)))
    pixels = counts(2)
    pixels[:, 200:255] = 0
    assert error_in_stops(curve, truth, pixels) < 1e-4
    assert score(curve, None, truth, pixels).rmse > 0.1


def test_a_photo_without_unclipped_pixels_has_no_error_in_stops():
    pixels = np.zeros((3, 256), dtype=np.int64)
    pixels[:, [0, 255]] = 1000
    assert error_in_stops(power(2, 2, 2), truth_of(2, 2, 2), pixels) is None


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.floats(-9, 9), st.integers(1, 7)), min_size=1, max_size=20))
def test_weighted_median_is_the_lower_median_of_the_repeated_values(pairs):
    values, weights = np.array([p[0] for p in pairs]), np.array([p[1] for p in pairs])
    listed = np.sort(np.repeat(values, weights))
    assert weighted_median(values, weights) == listed[(len(listed) - 1) // 2]


def test_band_coverage_is_the_share_of_codes_within_1645_sigma():
    truth = truth_of(2.0, 2.0, 2.0)
    curve = power(2.5, 2.5, 2.5)
    error = np.abs(FINE**2.5 - FINE**2.0)
    wide = np.tile(error / 1.6, (3, 1))
    narrow = np.tile(error / 1.7, (3, 1))
    half = np.where(FINE < 0.5, wide, narrow)
    shares = [
        score(curve, confidence(s), truth, counts()).band_coverage for s in (wide, half, narrow)
    ]
    np.testing.assert_allclose(shares, [1.0, 0.5, 0.0], atol=2e-3)


@pytest.mark.parametrize(
    ("name", "published"),
    [
        ("identity", (0.00, 22.3, 21.8, 44.6, 7.9)),
        ("srgb", (1.10, 8.76, 9.92, 41.4, 7.3)),
        ("mean", (2.21, 7.10, 8.99, 39.8, 6.7)),
    ],
)
def test_blind_answers_on_dorf_have_the_errors_measured_before(development_data, name, published):
    responses = read_responses(development_data / "crf" / "dorf_201_curves.mat")
    assert responses.inverse.shape == (201, 3, 1024)
    curve = InverseCRF(FINE, strictly_increasing([fixed_curve(name, FINE, dorf_model())] * 3))
    rmse = 100 * np.array([score(curve, None, t, counts()).rmse for t in responses.inverse])
    found = (rmse.min(), np.median(rmse), rmse.mean(), rmse.max(), rmse.std())
    np.testing.assert_allclose(found, published, rtol=0.01, atol=0.01)
