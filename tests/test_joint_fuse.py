"""Fusion: products of messages, and what becomes of one that contradicts the others."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from facecrf_ocio.joint.fuse import agreeing_shares, multiply, squared_distance
from facecrf_ocio.joint.prior import FamilyPrior, Message

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


def test_one_message_alone_cannot_be_contradicted():
    assert agreeing_shares({"a": message(100.0)}, PRIOR, WEIGHTS) == {"a": 1.0}


def test_the_distance_counts_both_spreads():
    distance = squared_distance(message(2.0, 0.5), None, PRIOR, WEIGHTS)
    assert np.isclose(distance, SIZE * 4.0 / (4.0 + 2.0))
