"""Fusion: products of messages, and what becomes of one that contradicts the others."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from facecrf_ocio.joint.cue_weights import agreeing_shares, squared_distances
from facecrf_ocio.joint.fuse import average, multiply
from facecrf_ocio.joint.prior import FamilyPrior, Message, Posterior

SIZE = 3
PRIOR = FamilyPrior(
    np.linspace(0.0, 1.0, 9),
    np.linspace(0.0, 1.0, 9),
    np.zeros((SIZE, 9)),
    np.ones(1),
    np.zeros((1, SIZE)),
    4.0 * np.eye(SIZE)[None],
    np.zeros(1),
)
WEIGHTS = np.ones(1)
NUMBERS = st.floats(-3.0, 3.0)


def message(center, precision=4.0):
    return Message(np.full(SIZE, float(center)), np.full(SIZE, float(precision)))


def test_two_messages_multiply_as_gaussians_do():
    joined = multiply([message(1.0, 1.0), message(4.0, 2.0)], [1.0, 1.0])
    assert np.allclose(joined.precision, 3.0)
    assert np.allclose(joined.mean, 3.0)


def test_a_share_is_a_power_of_the_likelihood():
    assert np.allclose(multiply([message(1.0, 2.0)], [0.25]).precision, 0.5)


def test_nothing_multiplies_to_nothing():
    assert multiply([], []) is None


@given(st.lists(NUMBERS, min_size=2, max_size=5), st.randoms())
def test_the_order_of_messages_does_not_matter(centers, random):
    messages = [message(c, i + 1.0) for i, c in enumerate(centers)]
    shuffled = random.sample(messages, len(messages))
    ones = [1.0] * len(messages)
    assert np.allclose(multiply(messages, ones).mean, multiply(shuffled, ones).mean)


def test_messages_that_agree_count_in_full():
    shares = agreeing_shares(
        {c: message(0.5 + 0.1 * i) for i, c in enumerate("abc")}, PRIOR, WEIGHTS
    )
    assert shares == {"a": 1.0, "b": 1.0, "c": 1.0}


def test_a_message_that_contradicts_the_others_counts_less():
    messages = {"a": message(0.0, 50), "b": message(0.1, 50), "c": message(0.05, 50)}
    shares = agreeing_shares({**messages, "liar": message(5.0, 50)}, PRIOR, WEIGHTS)
    assert shares["liar"] < 0.1
    assert min(shares[name] for name in messages) > 0.5


@given(st.lists(NUMBERS, min_size=2, max_size=5))
def test_shares_are_those_of_distances_from_the_product_of_the_others_three_times_over(centers):
    messages = {str(i): message(c, i + 1.0) for i, c in enumerate(centers)}
    shares = dict.fromkeys(messages, 1.0)
    for _ in range(3):
        distances = {}
        for name, one in messages.items():
            others = [other for other in messages if other != name]
            joined = multiply([messages[o] for o in others], [shares[o] for o in others])
            left = PRIOR.posterior(joined, WEIGHTS)
            offset = one.mean - left.mean
            spread = left.covariance + np.diag(1.0 / one.precision)
            distances[name] = offset @ np.linalg.solve(spread, offset)
        shares = {name: min(1.0, (4 + SIZE) / (4 + d)) for name, d in distances.items()}
    found = agreeing_shares(messages, PRIOR, WEIGHTS)
    assert np.allclose(list(found.values()), list(shares.values()), rtol=1e-10)


def test_one_message_alone_cannot_be_contradicted():
    assert agreeing_shares({"a": message(100.0)}, PRIOR, WEIGHTS) == {"a": 1.0}


def test_the_distance_counts_both_spreads():
    one = message(2.0, 0.5)
    left = np.zeros((1, SIZE)), 4.0 * np.eye(SIZE)[None]
    distance = squared_distances(one.mean[None], one.precision[None], *left)
    assert np.isclose(distance, SIZE * 4.0 / (4.0 + 2.0))


def posterior(center, variance=1.0):
    return Posterior(np.ones(1), np.full((1, SIZE), float(center)), variance * np.eye(SIZE)[None])


def test_the_average_of_one_posterior_is_itself():
    one = average([posterior(0.7, 2.0)], [5.0], 0.3)
    assert np.allclose(one.mean, 0.7)
    assert np.allclose(one.covariance, 2.0 * np.eye(SIZE))


@given(st.integers(1, 20), st.floats(0.0, 1.0))
def test_the_band_of_an_average_is_that_of_errors_alike_in_part(count, correlation):
    """Of n errors with variance 1 and this correlation, the mean has 1/n of the sum of all."""
    joined = average([posterior(0.0)] * count, [1.0] * count, correlation)
    alike = np.full((count, count), correlation) + (1.0 - correlation) * np.eye(count)
    assert np.allclose(joined.covariance, alike.mean() * np.eye(SIZE))


@given(st.lists(st.tuples(NUMBERS, st.floats(0.01, 10.0)), min_size=2, max_size=6))
def test_an_average_lies_among_its_posteriors_nearer_to_the_trusted(drawn):
    centers, trust = zip(*drawn, strict=True)
    mean = average([posterior(c) for c in centers], trust, 0.3).mean
    assert min(centers) - 1e-9 <= mean[0] <= max(centers) + 1e-9
    assert np.isclose(mean[0], np.average(centers, weights=trust))


@given(st.integers(2, 20), st.floats(0.0, 0.99))
def test_more_photos_never_widen_the_band(count, correlation):
    def width(n):
        return average([posterior(0.0)] * n, [1.0] * n, correlation).covariance[0, 0]

    assert width(count) < width(count - 1)
