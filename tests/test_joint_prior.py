"""The joint estimator's prior: products of Gaussians against brute force, and family weights."""

from __future__ import annotations

import numpy as np
import pytest

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.joint.prior import FamilyPrior, Message

GRID = np.linspace(0.0, 1.0, 33)
BASIS = np.stack([GRID * (1.0 - GRID), GRID**2 * (1.0 - GRID)])
PRIOR = FamilyPrior(
    GRID,
    GRID,
    BASIS,
    np.array([0.25, 0.25, 0.5]),
    np.array([[-1.0, 0.5], [1.5, 0.0], [0.2, -0.8]]),
    np.array([[[0.5, 0.1], [0.1, 0.4]], [[0.3, -0.1], [-0.1, 0.6]], [[0.4, 0.0], [0.0, 0.2]]]),
    np.array([0.0, 1.0, 2.0]),
)
MESSAGE = Message(np.array([0.4, -0.3]), np.array([2.0, 0.7]))


def gaussian(points, mean, covariance):
    offset = points - mean
    exponent = -0.5 * np.einsum("nm,mk,nk->n", offset, np.linalg.inv(covariance), offset)
    return np.exp(exponent) / np.sqrt(np.linalg.det(2.0 * np.pi * covariance))


def brute_force():
    axis = np.linspace(-6.0, 6.0, 481)
    points = np.stack(np.meshgrid(axis, axis, indexing="ij"), -1).reshape(-1, 2)
    density = sum(
        w * gaussian(points, m, c)
        for w, m, c in zip(PRIOR.weights, PRIOR.means, PRIOR.covariances, strict=True)
    )
    density *= gaussian(points, MESSAGE.mean, np.diag(1.0 / MESSAGE.precision))
    return points, density / density.sum()


def test_the_posterior_is_the_product_of_prior_and_message():
    points, density = brute_force()
    posterior = PRIOR.posterior(MESSAGE, PRIOR.weights)
    mean = density @ points
    assert np.allclose(posterior.mean, mean, atol=1e-6)
    offset = points - mean
    covariance = np.einsum("n,nm,nk->mk", density, offset, offset)
    assert np.allclose(posterior.covariance, covariance, atol=1e-6)


def test_several_messages_at_once_leave_what_each_leaves_alone():
    means, precisions = np.array([[0.4, -0.3], [2.0, 1.0]]), np.array([[2.0, 0.7], [1e-3, 50.0]])
    mean, covariance = PRIOR.posteriors(means, precisions, PRIOR.weights)
    for number, message in enumerate(map(Message, means, precisions)):
        alone = PRIOR.posterior(message, PRIOR.weights)
        assert np.allclose(mean[number], alone.mean, rtol=1e-12)
        assert np.allclose(covariance[number], alone.covariance, rtol=1e-12)


def test_without_a_message_the_posterior_is_the_prior():
    posterior = PRIOR.posterior(None, PRIOR.weights)
    assert np.allclose(posterior.mean, PRIOR.weights @ PRIOR.means)


def test_a_precise_message_overrules_the_prior():
    message = Message(np.array([0.7, 0.1]), np.full(2, 1e8))
    posterior = PRIOR.posterior(message, PRIOR.weights)
    assert np.allclose(posterior.mean, message.mean, atol=1e-6)
    assert PRIOR.deviations(posterior).max() < 1e-4


def test_deviations_are_those_of_drawn_curves():
    posterior = PRIOR.posterior(MESSAGE, PRIOR.weights)
    generator = np.random.default_rng(1)
    draws = generator.multivariate_normal(posterior.mean, posterior.covariance, 40_000)
    assert np.allclose(PRIOR.samples(draws).std(axis=0), PRIOR.deviations(posterior), atol=2e-3)


@pytest.mark.parametrize(
    ("prior", "leaning", "expected"),
    [
        ("auto", 0.0, [0.4, 0.2, 0.4]),
        ("dorf", 5.0, [1.0, 0.0, 0.0]),
        ("modern", -5.0, [0.0, 1.0 / 3.0, 2.0 / 3.0]),
    ],
)
def test_families_are_weighed_as_asked(prior, leaning, expected):
    assert np.allclose(PRIOR.weights_for(prior, leaning), expected)


def test_metadata_move_the_weights_of_auto_only():
    told = PRIOR.weights_for("auto", 2.0)
    assert told[1:].sum() > PRIOR.weights_for("auto")[1:].sum()
    assert np.allclose(PRIOR.weights_for("dorf", 2.0), PRIOR.weights_for("dorf"))


def test_metadata_tell_phones_from_cameras():
    plain, phone = PRIOR.weights_for("modern"), PRIOR.weights_for("modern", phone=2.0)
    assert phone[2] / phone[1] == pytest.approx(np.exp(2.0) * plain[2] / plain[1])
    assert phone[0] == 0.0


def test_curves_are_the_squares_of_what_the_coefficients_say():
    draws = np.random.default_rng(2).normal(size=(5, 2))
    roots = PRIOR.roots(draws)
    assert np.allclose(roots, GRID + draws @ BASIS)
    assert np.allclose(PRIOR.samples(draws), np.maximum(roots, 0.0) ** 2)


def test_an_unknown_prior_is_refused():
    with pytest.raises(SettingsError, match="no prior 'film'; known: auto, dorf, modern"):
        PRIOR.weights_for("film")
