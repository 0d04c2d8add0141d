"""The count of falling intervals of eq. 18, made smooth."""

from __future__ import annotations

import numpy as np
import pytest
from differences import directional_slopes
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from facecrf_ocio.published.energy.monotonicity import Monotonicity
from facecrf_ocio.response.model import strictly_increasing

wild = arrays(float, (3, 30), elements=st.floats(-1.0, 1.0))


def energy(samples, **softness):
    return Monotonicity(**softness).value_and_gradient(samples)[0]


@given(arrays(float, (3, 64), elements=st.floats(-1.0, 1.0)))
def test_valid_curves_cost_nothing_and_are_not_pushed(samples):
    value, gradient = Monotonicity().value_and_gradient(strictly_increasing(samples))
    assert value == 0.0
    assert not gradient.any()


def test_flat_intervals_are_not_falling():
    assert energy(np.zeros((3, 10))) == 0.0


@given(arrays(np.int64, (3, 40), elements=st.integers(-3, 3)))
def test_it_counts_the_intervals_that_fall(steps):
    samples = np.cumsum(steps, axis=1).astype(float)
    assert energy(samples) == (np.diff(samples, axis=1) < 0).sum()


@given(wild)
def test_it_never_exceeds_the_printed_count(samples):
    assert 0.0 <= energy(samples, softness=5.0) <= (np.diff(samples, axis=1) < 0).sum()


@given(wild, st.sampled_from([0.5, 10.0, 60.0]))
def test_the_gradient_agrees_with_differences(samples, softness):
    term = Monotonicity(softness)
    directions = np.random.default_rng(0).normal(size=(4, 3, 30))
    step = 1e-9 * softness
    slopes = directional_slopes(lambda s: energy(s, softness=softness), samples, directions, step)
    expected = (directions * term.value_and_gradient(samples)[1]).sum(axis=(1, 2))
    # The ramp is only once differentiable: its second derivative jumps at both of its ends.
    assert np.allclose(slopes, expected, atol=2e-3 / softness)


def test_it_grows_smoothly_from_no_slope_to_the_softness():
    slopes = -0.01 * np.linspace(-0.5, 1.5, 41)
    values = [energy(np.array([[0.0, s], [0.0, 1.0], [0.0, 1.0]])) for s in slopes]
    assert values[:11] == [0.0] * 11
    assert values[20] == pytest.approx(0.5)
    assert values[30:] == pytest.approx([1.0] * 11)
    assert (np.diff(values) >= 0).all()
