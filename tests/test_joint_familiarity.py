"""Statistics unlike those of training widen the band, in proportion and never narrow it."""

from __future__ import annotations

import numpy as np
import pytest

from facecrf_ocio.joint.familiarity import fit_familiarity
from facecrf_ocio.joint.fuse import widened
from facecrf_ocio.joint.prior import Posterior


@pytest.fixture(scope="module")
def known():
    generator = np.random.default_rng(0)
    mixing = generator.normal(size=(6, 12))
    return generator.normal(size=(3000, 6)) @ mixing + 0.1 * generator.normal(size=(3000, 12))


def test_distance_is_one_on_the_average_in_training(known):
    fitted = fit_familiarity(known, axes=4)
    assert (fitted.distance(known) ** 2).mean() == pytest.approx(1.0, rel=1e-6)
    assert np.mean(fitted.distance(known) > fitted.usual) == pytest.approx(0.05, abs=0.002)


def test_what_is_usual_is_not_widened_and_strangers_are(known):
    fitted = fit_familiarity(known, axes=6)
    assert np.mean([fitted.stretch(one) == 1.0 for one in known[:400]]) > 0.9
    stranger = known[0] + np.random.default_rng(1).normal(size=12)
    assert fitted.stretch(stranger) > 1.5
    assert fitted.stretch(known[0] + 2.0 * (stranger - known[0])) > fitted.stretch(stranger)


def test_a_widened_posterior_has_the_same_mean_and_a_larger_deviation():
    generator = np.random.default_rng(2)
    root = generator.normal(size=(3, 4, 4))
    covariances = root @ root.transpose(0, 2, 1)
    posterior = Posterior(np.array([0.2, 0.5, 0.3]), generator.normal(size=(3, 4)), covariances)
    wide = widened(posterior, 1.7)
    assert np.allclose(wide.mean, posterior.mean)
    assert np.allclose(wide.covariance, 1.7**2 * posterior.covariance)
    assert widened(posterior, 1.0) is posterior
