"""The empirical prior of eq. 20-21."""

from __future__ import annotations

import numpy as np
import pytest
from differences import directional_slopes
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.stats import multivariate_normal

from facecrf_ocio.published.energy.empirical import Empirical
from facecrf_ocio.response.dorf import read_dorf_inverse
from facecrf_ocio.response.model import dorf_model

MODEL = dorf_model()


def energy(samples):
    return Empirical(MODEL).value_and_gradient(samples)[0]


def test_it_is_minus_the_log_of_eq_20_summed_over_the_channels():
    c = np.random.default_rng(0).normal(0, 0.3, (3, 5))
    parts = zip(MODEL.mixture.means, MODEL.mixture.covariances, strict=True)
    densities = np.mean([multivariate_normal(m, s).pdf(c) for m, s in parts], axis=0)
    assert energy(MODEL.samples(c)) == pytest.approx(-np.log(densities).sum())


@settings(max_examples=30)
@given(arrays(float, (3, 5), elements=st.floats(-0.5, 0.5)), st.integers(0, 1000))
def test_the_gradient_agrees_with_differences(c, seed):
    samples = MODEL.samples(c)
    rng = np.random.default_rng(seed)
    directions = np.concatenate(
        [rng.normal(size=(2, 3, 1024)), rng.normal(size=(2, 3, 5)) @ MODEL.basis]
    )
    expected = (directions * Empirical(MODEL).value_and_gradient(samples)[1]).sum(axis=(1, 2))
    slopes = directional_slopes(energy, samples, directions, 1e-7)
    assert np.allclose(slopes, expected, rtol=1e-4, atol=1e-5 * np.abs(expected).max())


def test_responses_are_likelier_than_distorted_ones(development_data):
    curves = read_dorf_inverse(development_data / "crf" / "dorf_201_curves.mat")
    grid = np.linspace(0.0, 1.0, 1024)
    bent = curves + 0.1 * np.sin(4 * np.pi * grid)
    plain, worse = ([energy(np.stack([c] * 3)) for c in group] for group in (curves, bent))
    assert np.mean(np.array(plain) < worse) > 0.99
