"""The numbers of the bench are what their names say."""

from __future__ import annotations

import numpy as np
import pytest

from facecrf_ocio.benchmark.metrics import in_8_bits, score
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model, strictly_increasing
from facecrf_ocio.response.stops import stops_error, uniform
from facecrf_ocio.values import Confidence, InStops, InverseCRF, Verdict

GRID = np.linspace(0.0, 1.0, 1024)
FINE = np.linspace(0.0, 1.0, 4096)


def power(*exponents):
    return InverseCRF(FINE, np.array([FINE**e for e in exponents]))


def truth_of(*exponents):
    return np.array([GRID**e for e in exponents])


def confidence(sigma, in_stops=None):
    return Confidence(sigma, np.ones_like(sigma), Verdict.WEAK, ("",), in_stops)


def counts(seed=0, levels=256):
    return np.random.default_rng(seed).integers(0, 50, (3, levels))


def test_the_truth_has_no_error():
    result = score(power(2.2, 2.2, 2.2), None, truth_of(2.2, 2.2, 2.2), counts())
    assert result.rmse < 1e-6
    assert max(abs(result.bias), result.mid, result.shadows, result.used) < 1e-4


def test_rmse_is_that_of_the_integral():
    """For exponents a and b the mean square difference is 1/(2a+1) + 1/(2b+1) - 2/(a+b+1)."""
    result = score(power(1.0, 2.0, 3.0), None, truth_of(2.0, 2.0, 2.0), counts())
    exact = [
        np.sqrt(1 / (2 * a + 1) + 1 / 5 - 2 / (a + 3)) if a != 2 else 0.0 for a in (1.0, 2.0, 3.0)
    ]
    np.testing.assert_allclose(result.rmse_channels, exact, atol=2e-4)
    assert result.rmse == pytest.approx(np.mean(exact), abs=2e-4)


def test_errors_in_stops_are_those_of_response_stops():
    truth, curve, pixels = truth_of(2.0, 2.4, 2.8), power(3.0, 3.0, 3.5), counts(1)
    result, error = score(curve, None, truth, pixels), stops_error(uniform(curve), truth, pixels)
    assert (result.mid, result.shadows, result.used) == (error.mid, error.shadows, error.used)


def test_bias_is_above_zero_where_the_estimate_is_too_bright():
    """x^1.5 - x^2 has the mean 1 / 2.5 - 1 / 3; in stops, above mid-gray a lower power is less."""
    result = score(power(1.5, 1.5, 1.5), None, truth_of(2.0, 2.0, 2.0), counts())
    assert result.bias == pytest.approx(1 / 2.5 - 1 / 3, abs=1e-3)
    codes = np.arange(64, 236)
    assert result.bias_stops == pytest.approx((-0.5 * np.log2(codes / 128)).mean(), abs=1e-3)


def test_stops_ignore_exposure_and_codes_the_photo_does_not_use():
    truth = truth_of(2.0, 2.0, 2.0)
    bent = np.where(FINE < 0.8, 0.5 * FINE**2, np.interp(FINE, [0.8, 1.0], [0.32, 1.0]))
    curve = InverseCRF(FINE, np.tile(bent, (3, 1)))
    pixels = counts(2)
    pixels[:, 200:255] = 0
    result = score(curve, None, truth, pixels)
    assert result.used < 1e-4
    assert result.rmse > 0.1


def test_a_photo_without_unclipped_pixels_has_no_error_over_codes_it_uses():
    pixels = np.zeros((3, 256), dtype=np.int64)
    pixels[:, [0, 255]] = 1000
    assert score(power(2, 2, 2), None, truth_of(2, 2, 2), pixels).used is None


def test_pixels_of_finer_photos_are_counted_at_the_nearest_of_256_codes():
    pixels = counts(3, levels=4096)
    found = in_8_bits(pixels)
    codes = np.rint(np.arange(4096) / 4095 * 255).astype(int)
    assert found.shape == (3, 256)
    for code in (0, 1, 77, 255):
        np.testing.assert_array_equal(found[:, code], pixels[:, codes == code].sum(axis=1))


def test_the_band_in_stops_is_judged_where_a_compositor_looks():
    """Over codes 16 to 235 but mid-gray: half of 218 codes within, half of them not."""
    codes = np.arange(256)
    error = np.abs(0.5 * np.log2(np.maximum(codes, 1) / 128))
    sigma = np.where(codes < 128, error / 1.6, error / 1.7)
    told = InStops(np.tile(sigma, (3, 1)), 0.1, 0.2)
    curve = power(2.5, 2.5, 2.5)
    result = score(curve, confidence(np.ones((3, 4096)), told), truth_of(2, 2, 2), counts())
    assert result.band_stops == pytest.approx(112 / 219, abs=0.01)
    assert (
        score(curve, confidence(np.ones((3, 4096))), truth_of(2, 2, 2), counts()).band_stops is None
    )


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
