"""The mixture against scikit-learn's, its gradient against differences, EM against its theory."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.stats import multivariate_normal
from sklearn.mixture import GaussianMixture

from facecrf_ocio.response.mixture import Mixture, fit_mixture
from facecrf_ocio.response.model import dorf_model


def scikit_learn_s(mixture):
    other = GaussianMixture(len(mixture.means))
    other.weights_ = np.full(len(mixture.means), 1.0 / len(mixture.means))
    other.means_, other.covariances_ = mixture.means, mixture.covariances
    other.precisions_cholesky_ = np.array(
        [np.linalg.cholesky(np.linalg.inv(c)) for c in mixture.covariances]
    )
    return other


def drawn(mixture, count, seed=0):
    """Points about every component, out to four times its spread."""
    rng = np.random.default_rng(seed)
    which = rng.integers(len(mixture.means), size=count)
    roots = np.linalg.cholesky(mixture.covariances)[which]
    steps = rng.normal(size=(count, mixture.means.shape[1])) * rng.uniform(0, 4, (count, 1))
    return mixture.means[which] + (roots @ steps[..., None])[..., 0]


@pytest.fixture(scope="module")
def blobs():
    rng = np.random.default_rng(4)
    centers = rng.normal(0.0, 4.0, (3, 4))
    return np.concatenate([rng.normal(c, rng.uniform(0.3, 1.0, 4), (80, 4)) for c in centers])


def test_log_density_is_scikit_learn_s():
    mixture = dorf_model().mixture
    points = drawn(mixture, 500)
    expected = scikit_learn_s(mixture).score_samples(points)
    assert np.allclose(mixture.log_density(points), expected, rtol=1e-9, atol=1e-7)


def test_each_component_is_a_normal_density():
    mixture = dorf_model().mixture
    points = drawn(mixture, 20)
    for k in range(5):
        normal = multivariate_normal(mixture.means[k], mixture.covariances[k])
        assert np.allclose(mixture.log_components(points)[:, k], normal.logpdf(points), rtol=1e-8)


def test_log_density_stays_finite_far_away():
    mixture = dorf_model().mixture
    far = np.full((2, 5), [[1e3], [-1e4]])
    assert np.isfinite(mixture.log_density(far)).all()
    assert np.isfinite(mixture.gradient(far)).all()


@given(arrays(float, 5, elements=st.floats(-3.0, 3.0)))
def test_the_gradient_agrees_with_differences(offset):
    mixture = dorf_model().mixture
    scale = np.sqrt(np.diagonal(mixture.covariances, axis1=1, axis2=2).mean(axis=0))
    point, steps = offset * scale, 1e-5 * np.diag(scale)
    slopes = (mixture.log_density(point + steps) - mixture.log_density(point - steps)) / 2e-5
    expected = mixture.gradient(point) * scale
    assert np.allclose(slopes, expected, rtol=1e-4, atol=1e-4 * np.abs(expected).max() + 1e-6)


def test_more_steps_of_em_never_fit_worse(blobs):
    """Stopping later (a smaller tolerance) does not lower the likelihood of the points."""
    likelihoods = [
        fit_mixture(blobs, 4, floor=1e-9, tolerance=t).log_density(blobs).mean()
        for t in (1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 1e-13)
    ]
    assert (np.diff(likelihoods) >= -1e-12).all()
    assert likelihoods[-1] > likelihoods[0]


def test_separate_clusters_are_found_with_their_own_moments(blobs):
    mixture = fit_mixture(blobs, 3, floor=1e-9)
    for cluster in blobs.reshape(3, 80, 4):
        near = int(np.argmin(((mixture.means - cluster.mean(axis=0)) ** 2).sum(axis=1)))
        assert np.allclose(mixture.means[near], cluster.mean(axis=0), atol=1e-3)
        assert np.allclose(mixture.covariances[near], np.cov(cluster.T, bias=True), atol=1e-3)


def test_it_fits_the_responses_about_as_well_as_scikit_learn_does(development_data):
    from facecrf_ocio.response.dorf import read_dorf_inverse  # noqa: PLC0415

    model = dorf_model()
    points = model.coefficients(read_dorf_inverse(development_data / "crf" / "dorf_201_curves.mat"))
    other = GaussianMixture(5, n_init=5, random_state=0, reg_covar=1e-5).fit(points)
    assert model.mixture.log_density(points).mean() > other.score(points) - 0.5


def test_one_component_is_the_sample_s_mean_and_covariance(blobs):
    mixture = fit_mixture(blobs, 1, floor=0.0)
    assert np.allclose(mixture.means[0], blobs.mean(axis=0))
    assert np.allclose(mixture.covariances[0], np.cov(blobs.T, bias=True))


def test_the_fit_is_the_same_every_time(blobs):
    first, second = fit_mixture(blobs, 3), fit_mixture(blobs.copy(), 3)
    assert np.array_equal(first.means, second.means)
    assert np.array_equal(first.covariances, second.covariances)


def test_repeated_points_do_not_collapse_a_component():
    points = np.concatenate([np.zeros((30, 2)), np.random.default_rng(0).normal(5, 1, (30, 2))])
    mixture = fit_mixture(points, 2)
    assert (np.linalg.eigvalsh(mixture.covariances) > 0).all()
    assert np.isfinite(mixture.log_density(points)).all()


def test_a_mixture_does_not_follow_changes_of_its_sources():
    means, covariances = np.zeros((1, 2)), np.eye(2)[None].copy()
    mixture = Mixture(means, covariances)
    before = mixture.log_density(np.ones(2))
    means += 1.0
    covariances *= 2.0
    assert mixture.log_density(np.ones(2)) == before
    assert (mixture.means == 0).all()
