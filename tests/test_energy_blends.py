"""The energies of edges' blends have the gradients that differences have."""

from __future__ import annotations

import numpy as np
import pytest
from blend_scene import random_blends, random_curves
from differences import directional_slopes
from hypothesis import given
from hypothesis import strategies as st

from facecrf_ocio.published.energy.color_blend import ColorBlend
from facecrf_ocio.published.energy.rank_blend import BlendRank


@pytest.mark.parametrize("kind", [ColorBlend, BlendRank])
@given(st.integers(0, 10_000))
def test_the_gradient_is_that_of_differences(kind, seed):
    energy, curves = kind(random_blends(seed), 128), random_curves(seed)
    directions = np.random.default_rng(seed).normal(size=(3, *curves.shape))
    slopes = directional_slopes(
        lambda at: energy.value_and_gradient(at)[0], curves, directions, 1e-6
    )
    _, gradient = energy.value_and_gradient(curves)
    np.testing.assert_allclose(
        np.einsum("nck,ck->n", directions, gradient), slopes, rtol=2e-4, atol=1e-4
    )
