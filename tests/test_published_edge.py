"""EdgeCRF: its energy, and the curves it recovers where its assumption holds exactly."""

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

from facecrf_ocio.published import edge_patches
from facecrf_ocio.published.answer import EnergyTerms
from facecrf_ocio.published.edge import edge_answer
from facecrf_ocio.published.edge_patches import find_edge_patches, stack_blends
from facecrf_ocio.published.energy.color_blend import ColorBlend
from facecrf_ocio.published.energy.empirical import Empirical
from facecrf_ocio.published.energy.monotonicity import Monotonicity
from facecrf_ocio.published.solve import Weighted, solve
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Lacking, Photo

SETTINGS = Settings()
seeds = st.integers(0, 10_000)


def estimate(photo, *, shared=False):
    """Curves (3, K) of the cue and the prior, weighed and solved as a calibration does it."""
    answer = edge_answer(photo, MODEL, SETTINGS)
    assert isinstance(answer, EnergyTerms)
    terms = (
        Weighted("empirical", 1.0, Empirical(MODEL)),
        Weighted("monotonicity", SETTINGS.monotonicity_weight, Monotonicity()),
        *answer.terms,
    )
    return MODEL.samples(solve(MODEL, terms, shared=shared).coefficients)


# --- the energy ---


@given(seeds)
def test_the_energy_is_the_sum_of_distances_from_the_line(seed):
    blends, curves = random_blends(seed), random_curves(seed)
    grid = np.linspace(0.0, 1.0, 128)
    total = 0.0
    for pixel, n in zip(blends.blends.T, blends.patch, strict=True):
        first, second, point = (
            np.array([np.interp(c, grid, g) for c, g in zip(color, curves, strict=True)])
            for color in (*blends.regions[:, n].T, pixel)
        )
        along = (second - first) / np.linalg.norm(second - first)
        foot = first + along * ((point - first) @ along)
        total += np.linalg.norm(point - foot)
    value, _ = ColorBlend(blends, 128, softness=1e-9).value_and_gradient(curves)
    assert value == pytest.approx(total, rel=1e-6, abs=1e-6)


def test_the_true_curve_costs_nothing_and_every_other_exponent_does():
    linear, _ = linear_scene(rows=4, columns=6)
    blends = stack_blends(find_edge_patches(photograph(linear, GAMMA22).encoded))
    energy = ColorBlend(blends, GRID.size)
    per_pixel = {
        exponent: energy.value_and_gradient(np.tile(GRID**exponent, (3, 1)))[0] / blends.patch.size
        for exponent in (1.6, 2.0, 2.2, 2.4, 2.8)
    }
    assert per_pixel[2.2] < 1e-5
    assert min(v for k, v in per_pixel.items() if k != 2.2) > 1e-3


def test_flat_curves_do_not_break_it():
    energy = ColorBlend(random_blends(0), 128)
    value, gradient = energy.value_and_gradient(np.zeros((3, 128)))
    assert value == 0.0
    assert np.isfinite(gradient).all()


# --- the estimator ---


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize(
    "truth",
    [
        pytest.param(MEAN, id="mean"),
        *(pytest.param(plausible_curves(seed), id=f"drawn{seed}") for seed in (1, 2, 3)),
    ],
)
def test_recovers_curves_of_the_response_model_from_exact_blends(truth, bits):
    linear, _ = linear_scene()
    error = rmse(estimate(photograph(linear, truth, bits=bits)), truth)
    assert error.max() < (0.01 if bits == 8 else 0.001)


def test_recovers_gamma_which_the_response_model_only_approximates():
    linear, _ = linear_scene()
    error = rmse(estimate(photograph(linear, GAMMA22)), GAMMA22)
    assert error.max() < 0.01


def test_one_shared_curve_can_be_asked_for():
    linear, _ = linear_scene(rows=5, columns=8)
    samples = estimate(photograph(linear, MEAN), shared=True)
    np.testing.assert_array_equal(samples[0], samples[2])
    assert rmse(samples, MEAN).max() < 0.002


def test_the_evidence_is_where_the_blends_are():
    linear, _ = linear_scene(rows=4, columns=6)
    answer = edge_answer(photograph(linear, MEAN), MODEL, SETTINGS)
    assert answer.encoded.shape[1] == 3
    assert "edge patches" in answer.summary
    assert answer.faces == ()


@pytest.mark.parametrize(
    ("photo", "reason"),
    [
        pytest.param(Photo(encoded=np.full((100, 100, 3), 0.5, np.float32)), "0 found", id="flat"),
        pytest.param(Photo(encoded=np.full((1, 1, 3), 0.5, np.float32)), "0 found", id="tiny"),
        pytest.param(
            Photo(encoded=np.full((100, 100, 3), 0.5, np.float32), grayscale=True),
            "grayscale",
            id="grayscale",
        ),
        pytest.param(
            photograph(linear_scene(rows=1, columns=2)[0], MEAN), "are needed", id="two disks"
        ),
    ],
)
def test_too_little_evidence_is_said_with_a_remedy(photo, reason):
    answer = edge_answer(photo, MODEL, SETTINGS)
    assert isinstance(answer, Lacking)
    assert reason in answer.reason
    assert answer.remedy


@pytest.mark.parametrize("rows", [1, 2, 5])
def test_bands_of_any_height_find_the_same_patches(rows, monkeypatch):
    linear, _ = linear_scene(rows=4, columns=6)
    encoded = photograph(linear, MEAN).encoded
    monkeypatch.setattr(edge_patches, "BAND_ROWS", edge_patches.SPACING * 10_000)
    whole = find_edge_patches(encoded)
    monkeypatch.setattr(edge_patches, "BAND_ROWS", edge_patches.SPACING * rows)
    banded = find_edge_patches(encoded)
    assert [p.corner_xy for p in banded] == [p.corner_xy for p in whole]
    assert len(whole) > 10
    for one, other in zip(banded, whole, strict=True):
        np.testing.assert_array_equal(one.blends, other.blends)
