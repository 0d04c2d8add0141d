"""RankCRF: its energy, its polynomials, and the curves it recovers from exact blends."""

from __future__ import annotations

import numpy as np
import pytest
from blend_scene import (
    GAMMA22,
    GRID,
    MEAN,
    MODEL,
    linear_scene,
    photograph,
    plausible_curves,
    random_blends,
    random_curves,
    rmse,
)
from hypothesis import given
from hypothesis import strategies as st

from facecrf_ocio.published.answer import FittedCurve
from facecrf_ocio.published.edge_patches import find_edge_patches, stack_blends
from facecrf_ocio.published.energy.color_blend import ColorBlend
from facecrf_ocio.published.energy.rank_blend import BlendRank
from facecrf_ocio.published.rank import DEGREE, fit_polynomials, polynomial_basis, rank_answer
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Lacking, Photo

SETTINGS = Settings()
IDENTITY = np.tile(GRID, (3, 1))
seeds = st.integers(0, 10_000)


def nearest_polynomials(curves):
    """The curves (3, K) of RankCRF's own parametrization nearest to given ones."""
    basis = polynomial_basis(GRID, DEGREE)
    return GRID + ((curves - GRID) @ basis.T) @ basis


# --- the energy ---


@given(seeds)
def test_condition_numbers_are_ratios_of_the_singular_values_of_each_patch(seed):
    blends, curves = random_blends(seed), random_curves(seed)
    grid = np.linspace(0.0, 1.0, 128)
    found = BlendRank(blends, 128, softness=0.0).condition_numbers(curves)
    for n, value in enumerate(found):
        colors = np.concatenate([blends.regions[:, n], blends.blends[:, blends.patch == n]], axis=1)
        linear = np.array([np.interp(c, grid, g) for c, g in zip(colors, curves, strict=True)])
        first, second = np.linalg.svd(linear[:, 1:] - linear[:, :1], compute_uv=False)[:2]
        assert value == pytest.approx(second / first, rel=1e-5, abs=1e-7)


@given(seeds, st.floats(0.2, 5.0))
def test_scale_does_not_change_the_rank_energy_but_it_does_change_the_distance(seed, scale):
    blends, curves = random_blends(seed), random_curves(seed)
    rank = BlendRank(blends, 128, softness=0.0)
    distance = ColorBlend(blends, 128, softness=0.0)
    assert rank.value_and_gradient(scale * curves)[0] == pytest.approx(
        rank.value_and_gradient(curves)[0], rel=1e-6
    )
    assert distance.value_and_gradient(scale * curves)[0] == pytest.approx(
        scale * distance.value_and_gradient(curves)[0], rel=1e-6
    )


def test_the_true_curve_has_rank_one_and_other_exponents_do_not():
    linear, _ = linear_scene(rows=4, columns=6)
    blends = stack_blends(find_edge_patches(photograph(linear, GAMMA22).encoded))
    energy = BlendRank(blends, GRID.size, softness=0.0)
    assert energy.condition_numbers(GAMMA22).max() < 0.005
    for exponent in (1.6, 2.0, 2.4, 2.8):
        assert energy.condition_numbers(np.tile(GRID**exponent, (3, 1))).mean() > 0.005


# --- the parametrization ---


def test_the_basis_spans_the_polynomials_of_the_paper():
    basis = polynomial_basis(GRID, DEGREE)
    np.testing.assert_allclose(basis @ basis.T, np.eye(DEGREE - 1), atol=1e-12)
    np.testing.assert_allclose(basis[:, [0, -1]], 0.0, atol=1e-12)
    for power in range(DEGREE - 1):
        paper = GRID * (GRID - 1.0) * GRID**power
        np.testing.assert_allclose((paper @ basis.T) @ basis, paper, atol=1e-9)


def test_the_basis_goes_up_by_degree():
    for degree in range(2, DEGREE):
        np.testing.assert_allclose(
            np.abs(polynomial_basis(GRID, degree)),
            np.abs(polynomial_basis(GRID, DEGREE)[: degree - 1]),
            atol=1e-9,
        )


# --- the estimator ---


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize(
    "truth",
    [
        pytest.param(GAMMA22, id="gamma22"),
        pytest.param(MEAN, id="mean"),
        pytest.param(IDENTITY, id="identity"),
        *(
            pytest.param(nearest_polynomials(plausible_curves(seed)), id=f"drawn{seed}")
            for seed in (1, 2, 3)
        ),
    ],
)
def test_recovers_curves_from_exact_blends(truth, bits):
    linear, _ = linear_scene()
    assert (np.diff(truth) > 0.0).all()
    answer = rank_answer(photograph(linear, truth, bits=bits), MODEL, SETTINGS)
    assert isinstance(answer, FittedCurve)
    assert rmse(answer.samples, truth).max() < 0.01


def test_the_curves_run_from_0_to_1_on_the_models_grid():
    linear, _ = linear_scene(rows=3, columns=5)
    answer = rank_answer(photograph(linear, MEAN), MODEL, SETTINGS)
    assert answer.samples.shape == (3, GRID.size)
    np.testing.assert_allclose(answer.samples[:, [0, -1]], np.tile([0.0, 1.0], (3, 1)), atol=1e-9)
    assert answer.encoded.shape[1] == 3


@pytest.mark.parametrize("seed", range(3))
def test_the_curves_rise_even_where_the_blends_are_noise(seed):
    blends = random_blends(seed)
    curves = fit_polynomials(BlendRank(blends, GRID.size), GRID, shared=False)
    assert (np.maximum.accumulate(curves, axis=1) - curves).max() < 1e-3


def test_one_shared_curve_can_be_asked_for():
    linear, _ = linear_scene(rows=5, columns=8)
    answer = rank_answer(photograph(linear, GAMMA22), MODEL, Settings(shared_curve=True))
    np.testing.assert_array_equal(answer.samples[0], answer.samples[2])
    assert rmse(answer.samples, GAMMA22).max() < 0.01


@pytest.mark.parametrize(
    ("photo", "reason"),
    [
        pytest.param(Photo(encoded=np.full((100, 100, 3), 0.5, np.float32)), "0 found", id="flat"),
        pytest.param(
            Photo(encoded=np.full((100, 100, 3), 0.5, np.float32), grayscale=True),
            "grayscale",
            id="grayscale",
        ),
    ],
)
def test_too_little_evidence_is_said_with_a_remedy(photo, reason):
    answer = rank_answer(photo, MODEL, SETTINGS)
    assert isinstance(answer, Lacking)
    assert reason in answer.reason
    assert answer.remedy
