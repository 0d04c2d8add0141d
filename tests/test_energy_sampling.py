"""Reading curves at points, and its transpose."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from facecrf_ocio.published.energy.sampling import Sampling

sizes = st.integers(2, 50)
points = arrays(float, st.tuples(st.just(3), st.integers(1, 20)), elements=st.floats(0.0, 1.0))


def curves(size, seed=0):
    return np.random.default_rng(seed).normal(size=(3, size))


@given(points, sizes)
def test_values_are_numpy_s_interpolation(encoded, size):
    samples, grid = curves(size), np.linspace(0.0, 1.0, size)
    expected = [np.interp(e, grid, s) for e, s in zip(encoded, samples, strict=True)]
    assert np.allclose(Sampling.at(encoded, size).values(samples), expected, atol=1e-9)


@given(points, sizes)
def test_slopes_are_those_of_a_straight_curve(encoded, size):
    steepness = np.array([[0.5], [1.0], [-2.0]])
    straight = steepness * np.linspace(0.0, 1.0, size)
    assert np.allclose(Sampling.at(encoded, size).slopes(straight), steepness)


@given(points, sizes)
def test_gradient_is_the_transpose_of_values_and_slopes(encoded, size):
    """<values(c), v> + <slopes(c), s> = <c, gradient(v, s)> for every c, v, s."""
    sampling, samples = Sampling.at(encoded, size), curves(size)
    rng = np.random.default_rng(1)
    v, s = rng.normal(size=encoded.shape), rng.normal(size=encoded.shape)
    left = (sampling.values(samples) * v).sum() + (sampling.slopes(samples) * s).sum()
    assert np.isclose(left, (samples * sampling.gradient(v, s)).sum(), atol=1e-8)
    only = (sampling.values(samples) * v).sum()
    assert np.isclose(only, (samples * sampling.gradient(v)).sum(), atol=1e-9)


def test_channels_are_kept_apart_in_any_shape():
    samples = np.stack([np.zeros(5), np.ones(5), np.full(5, 2.0)])
    values = Sampling.at(np.full((3, 4, 2), 0.3), 5).values(samples)
    assert values.shape == (3, 4, 2)
    assert (values == np.arange(3.0)[:, None, None]).all()


def test_the_ends_belong_to_the_first_and_last_interval():
    grid = np.tile(np.linspace(0.0, 1.0, 11) ** 2, (3, 1))
    at = np.tile([[0.0, 1.0]], (3, 1))
    assert np.allclose(Sampling.at(at, 11).values(grid), at)
    assert np.allclose(Sampling.at(at, 11).slopes(grid), [[0.1, 1.9]])
