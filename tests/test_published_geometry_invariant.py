"""GICRF: its invariant, and the curves it recovers where irradiance is planar everywhere."""

from __future__ import annotations

import numpy as np
import pytest
from blend_scene import GAMMA22, GRID, MEAN, MODEL, photograph, plausible_curves, rmse
from hypothesis import given, settings
from hypothesis import strategies as st

from facecrf_ocio.published.answer import FittedCurve
from facecrf_ocio.published.energy.log_slope import INTERVALS, log_slope_prior
from facecrf_ocio.published.geometry_invariant import (
    Levels,
    curve_from_invariants,
    geometry_invariant_answer,
    invariant_levels,
)
from facecrf_ocio.published.planar_points import PlanarPoints, planar_points
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Lacking, Photo

SRGB = np.tile(fixed_curve("srgb", GRID, MODEL), (3, 1))
PATCH = 48
ROUNDING_16 = 12.0**-0.5 / 65535.0


def ramp(size, angle, low, high):
    """A plane of irradiance (size, size) that runs from `low` to `high` at an angle."""
    y, x = np.mgrid[:size, :size]
    height = np.cos(angle) * x + np.sin(angle) * y
    height = (height - height.min()) / np.ptp(height)
    return low + (high - low) * height


def planar_scene(*, size=768, seed=1):
    """Linear image (size, size, 3): each patch of each channel is a plane, dark and light ones."""
    rng = np.random.default_rng(seed)
    scene = np.empty((size, size, 3))
    for top in range(0, size, PATCH):
        for left in range(0, size, PATCH):
            for channel in range(3):
                dark = rng.random() < 0.6
                high = np.exp(rng.uniform(np.log(0.004), 0.0)) if dark else rng.uniform(0.1, 1.0)
                plane = ramp(PATCH, rng.uniform(0, 2 * np.pi), rng.uniform(0.02, 0.8) * high, high)
                scene[top : top + PATCH, left : left + PATCH, channel] = plane
    return scene


@pytest.fixture(scope="module")
def scene():
    return planar_scene()


def estimate(photo, *, shared=False):
    answer = geometry_invariant_answer(photo, MODEL, Settings(shared_curve=shared))
    assert isinstance(answer, FittedCurve), answer
    return answer


# --- the invariant ---


@settings(max_examples=25, deadline=None)
@given(
    st.floats(0.0, 2.0 * np.pi),
    st.floats(0.1, 0.5),
    st.floats(0.2, 0.5),
    st.sampled_from([1.0, 1.8, 2.2, 2.6]),
)
def test_it_depends_on_the_response_alone_whatever_the_plane(angle, low, contrast, gamma):
    plane = ramp(64, angle, low, low + contrast) ** (1.0 / gamma)
    points = planar_points(plane, ROUNDING_16)
    assert points.encoded.size > 100
    assert points.invariant == pytest.approx(np.full(points.encoded.size, 1.0 - gamma), abs=0.05)


@pytest.mark.parametrize("exposure", [0.25, 0.5])
def test_it_does_not_depend_on_exposure(exposure):
    plane = ramp(64, 0.4, 0.3, 0.9)
    bright, dim = (planar_points(p ** (1 / 2.2), ROUNDING_16) for p in (plane, exposure * plane))
    assert np.median(dim.invariant) == pytest.approx(np.median(bright.invariant), abs=0.01)


def test_points_on_curved_isophotes_are_not_taken():
    y, x = np.mgrid[:96, :96]
    cone = 0.1 + 0.8 * np.hypot(x - 47.5, y - 47.5) / 68.0
    plane = ramp(96, 0.7, 0.1, 0.9)
    found, expected = (planar_points(p ** (1 / 2.2), ROUNDING_16) for p in (cone, plane))
    assert found.encoded.size < 0.1 * expected.encoded.size


def test_windows_with_a_step_edge_are_not_taken():
    steps = np.kron(np.random.default_rng(0).uniform(0.05, 0.95, (6, 6)), np.ones((32, 32)))
    assert planar_points(steps, ROUNDING_16).encoded.size == 0


def test_a_level_shows_the_mode_of_its_points_in_spite_of_other_surfaces():
    rng = np.random.default_rng(0)
    encoded = rng.uniform(0.1, 0.9, 40_000)
    others = rng.random(encoded.size) < 0.35
    noisy = -1.2 + 0.1 * rng.normal(size=encoded.size)
    invariant = np.where(others, rng.uniform(-8.0, 4.0, encoded.size), noisy)
    points = PlanarPoints(encoded, invariant, np.full(encoded.size, 0.1), np.ones(encoded.size))
    levels = invariant_levels(points)
    assert levels.edge[[0, -1]] == pytest.approx([6, 58])
    inside = slice(1, -1)
    assert np.abs(levels.invariant[inside] + 1.2).max() < 0.03


def test_invariants_of_a_power_at_all_levels_integrate_to_that_power():
    edge = np.arange(1.0, INTERVALS)
    exact = Levels(edge, np.full(edge.size, -1.2), np.full(edge.size, 1e-6), edge + 100.0)
    curve = curve_from_invariants(exact, log_slope_prior(MODEL), GRID)
    assert rmse(curve[None], GAMMA22[:1])[0] < 0.002


def test_a_doubtful_level_that_contradicts_the_others_is_dropped():
    edge = np.arange(1.0, INTERVALS)
    invariant, windows = np.full(edge.size, -1.2), np.full(edge.size, 100.0)
    invariant[20], windows[20] = 5.0, 1.0
    levels = Levels(edge, invariant, np.full(edge.size, 0.01), windows)
    curve = curve_from_invariants(levels, log_slope_prior(MODEL), GRID)
    assert rmse(curve[None], GAMMA22[:1])[0] < 0.005


# --- the curve ---


@pytest.mark.slow
@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("truth", [MEAN, GAMMA22, SRGB], ids=["mean", "gamma22", "srgb"])
def test_planar_irradiance_gives_the_curve_within_one_percent(scene, truth, bits):
    answer = estimate(photograph(scene, truth, bits=bits))
    assert rmse(answer.samples, truth).max() < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_plausible_curves_one_per_channel_are_recovered(scene, seed):
    truth = plausible_curves(seed)
    answer = estimate(photograph(scene, truth, bits=16))
    assert rmse(answer.samples, truth).max() < 0.01


@pytest.mark.slow
def test_one_curve_for_all_channels_uses_the_points_of_all():
    photo = photograph(planar_scene(size=384), MEAN, bits=8)
    answer = estimate(photo, shared=True)
    assert np.array_equal(answer.samples[0], answer.samples[2])
    assert rmse(answer.samples, MEAN).max() < 0.01


def test_unrounded_floats_will_do():
    linear = planar_scene(size=384)
    encoded = np.clip(linear, 0.0, 1.0) ** (1 / 2.2)
    answer = estimate(Photo(encoded=encoded.astype(np.float32)))
    assert rmse(answer.samples, GAMMA22).max() < 0.01


def test_the_same_photo_gives_the_same_digits():
    photo = photograph(planar_scene(size=384), MEAN)
    assert np.array_equal(estimate(photo).samples, estimate(photo).samples)


def test_its_codes_and_summary_tell_what_it_rests_on():
    answer = estimate(photograph(planar_scene(size=384), MEAN))
    assert answer.encoded.shape[1] == 3
    assert (answer.encoded > 0.0).all()
    assert (answer.encoded < 1.0).all()
    assert "locally planar points" in answer.summary


def test_levels_without_planes_are_left_to_the_response_model():
    linear = 0.25 + 0.75 * planar_scene(size=384)
    answer = estimate(photograph(linear, MEAN, bits=16))
    assert rmse(answer.samples, MEAN).max() < 0.04


# --- too little evidence ---


@pytest.mark.parametrize(
    "encoded",
    [
        np.full((64, 64, 3), 0.5),
        np.full((1, 1, 3), 0.5),
        np.zeros((31, 7, 3)),
        np.random.default_rng(0).uniform(0.0, 1.0, (96, 96, 3)),
    ],
    ids=["flat", "one pixel", "black", "noise"],
)
def test_a_photo_without_ramps_is_lacking(encoded):
    answer = geometry_invariant_answer(Photo(encoded=encoded.astype(np.float32)), MODEL, Settings())
    assert isinstance(answer, Lacking)
    assert "brightness levels" in answer.reason
    assert answer.remedy == "use a larger or less noisy photo with soft shading"


def test_evidence_is_not_pieced_together_from_one_plane():
    encoded = np.repeat(ramp(64, 0.2, 0.4, 0.5)[..., None], 3, axis=2)
    answer = geometry_invariant_answer(Photo(encoded=encoded.astype(np.float32)), MODEL, Settings())
    assert isinstance(answer, Lacking)
