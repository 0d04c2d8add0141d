"""ISCRF: the noise it measures, and the curves it recovers where its noise model holds exactly."""

from __future__ import annotations

import numpy as np
import pytest
from blend_scene import GAMMA22, GRID, MEAN, MODEL, photograph, plausible_curves, rmse
from hypothesis import given, settings
from hypothesis import strategies as st

from facecrf_ocio.published.answer import FittedCurve
from facecrf_ocio.published.intensity_similarity import (
    BLOCK,
    intensity_similarity_answer,
    noise_levels,
    uniform_blocks,
    without_rounding,
)
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Lacking, Photo

SRGB = np.tile(fixed_curve("srgb", GRID, MODEL), (3, 1))


def patches(*, size=1024, patch=32, seed=1):
    """Linear image (size, size, 3) of uniform patches, each channel with dark and light levels."""
    rng = np.random.default_rng(seed)
    count = size // patch
    level = rng.random((count, count, 3))
    level = np.where(rng.random(level.shape) < 0.5, level, level**3)
    return np.repeat(np.repeat(level, patch, axis=0), patch, axis=1)


def noisy(linear, *, shot=1e-3, read=1e-5, seed=2):
    """The linear image with Gaussian noise of variance `shot R + read`, as a sensor clips it."""
    rng = np.random.default_rng(seed)
    return np.clip(linear + rng.normal(size=linear.shape) * np.sqrt(shot * linear + read), 0, 1)


@pytest.fixture(scope="module")
def scene():
    return noisy(patches())


def estimate(photo, *, shared=False):
    answer = intensity_similarity_answer(photo, MODEL, Settings(shared_curve=shared))
    assert isinstance(answer, FittedCurve), answer
    return answer


# --- what is measured ---


@settings(max_examples=10, deadline=None)
@given(st.floats(0.3, 2.0), st.integers(0, 1000))
def test_the_variance_of_rounding_is_taken_off(noise, seed):
    rng = np.random.default_rng(seed)
    mean = np.linspace(0.0, 1.0, 4000, endpoint=False)[:, None]  # even: drawn means err by 3 %
    rounded = np.round(mean + noise * rng.normal(size=(4000, 64)))
    measured = float(rounded.var(axis=1, ddof=1).mean())
    assert without_rounding(measured / 255**2, 1 / 255) * 255**2 == pytest.approx(
        noise**2, rel=0.03
    )


def test_unrounded_variance_stays_as_it_is():
    assert without_rounding(0.123, 0.0) == 0.123


def test_levels_show_variance_and_skewness_of_the_noise():
    rng = np.random.default_rng(0)
    mean = rng.uniform(0.3, 0.7, (20_000, 1))
    blocks = mean + 0.01 * (rng.gamma(4.0, 1.0, (20_000, BLOCK**2)) / 2.0 - 2.0)
    levels = noise_levels(blocks, 0.0)
    assert np.median(levels.variance) == pytest.approx(1e-4, rel=0.02)
    assert np.median(levels.skewness) == pytest.approx(1.0, rel=0.05)
    assert levels.pixels.sum() == pytest.approx(blocks.size, rel=0.1)


def test_levels_cut_off_by_black_or_white_are_not_used():
    rng = np.random.default_rng(0)
    blocks = np.clip(np.linspace(0, 1, 8000)[:, None] + 0.02 * rng.normal(size=(8000, 64)), 0, 1)
    levels = noise_levels(blocks, 0.0)
    assert levels.encoded.min() > 0.05
    assert levels.encoded.max() < 0.95


def test_blocks_of_white_noise_are_uniform_and_blocks_with_structure_are_not():
    rng = np.random.default_rng(0)
    noise = 0.5 + 0.02 * rng.normal(size=(256, 256, 3))
    assert len(uniform_blocks(noise.astype(np.float32))) > 0.9 * 32 * 32
    slope = noise + np.linspace(0, 4.0, 256)[:, None, None]
    assert len(uniform_blocks(slope.astype(np.float32))) < 0.02 * 32 * 32
    edges = noise + 0.3 * (np.arange(256) % BLOCK == 0)[:, None, None]
    assert len(uniform_blocks(edges.astype(np.float32))) < 0.02 * 32 * 32


def test_a_large_photo_is_read_on_a_lattice_of_blocks():
    assert len(uniform_blocks(np.full((4096, 4096, 3), 0.5, np.float32))) <= 65_536


# --- the curve ---


@pytest.mark.slow
@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("truth", [MEAN, GAMMA22, SRGB], ids=["mean", "gamma22", "srgb"])
def test_uniform_patches_give_the_curve_within_one_percent(scene, truth, bits):
    answer = estimate(photograph(scene, truth, bits=bits))
    assert rmse(answer.samples, truth).max() < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_plausible_curves_are_recovered_from_all_channels_together(seed):
    truth = np.tile(plausible_curves(seed)[0], (3, 1))
    scene = noisy(patches(), shot=2e-4)
    answer = estimate(photograph(scene, truth, bits=16), shared=True)
    assert np.array_equal(answer.samples[0], answer.samples[2])
    assert rmse(answer.samples, truth).max() < 0.01


@pytest.mark.slow
def test_one_curve_serves_channels_of_unlike_noise():
    linear = patches()
    gains = (2.0, 1.0, 1.5)
    scene = np.dstack([noisy(linear[:, :, [c]], shot=5e-4 * gains[c]) for c in range(3)])
    answer = estimate(photograph(scene, MEAN, bits=8), shared=True)
    assert rmse(answer.samples, MEAN).max() < 0.01


def test_the_same_photo_gives_the_same_digits():
    photo = photograph(noisy(patches(size=512)), MEAN)
    assert np.array_equal(estimate(photo).samples, estimate(photo).samples)


def test_its_codes_and_summary_tell_what_it_rests_on():
    answer = estimate(photograph(noisy(patches(size=512)), MEAN))
    assert answer.encoded.shape[1] == 3
    assert (answer.encoded > 0.0).all()
    assert (answer.encoded < 1.0).all()
    assert "uniform regions" in answer.summary


# --- too little evidence ---


def textured(shape):
    y, x = np.mgrid[: shape[0], : shape[1]]
    return np.repeat((0.5 + 0.4 * np.sin(x / 2.0) * np.sin(y / 3.0))[..., None], 3, axis=2)


@pytest.mark.parametrize(
    "encoded",
    [
        np.full((64, 64, 3), 0.5),
        np.full((1, 1, 3), 0.5),
        np.ones((33, 7, 3)),
        textured((256, 256)),
    ],
    ids=["flat", "one pixel", "white", "texture"],
)
def test_a_photo_without_noise_in_uniform_regions_is_lacking(encoded):
    answer = intensity_similarity_answer(
        Photo(encoded=encoded.astype(np.float32)), MODEL, Settings()
    )
    assert isinstance(answer, Lacking)
    assert answer.remedy == "use a photo with plain surfaces and visible noise, not denoised"


def test_noise_that_drowns_in_rounding_is_lacking():
    photo = photograph(noisy(patches(size=512), shot=1e-7, read=1e-9), MEAN, bits=8)
    answer = intensity_similarity_answer(photo, MODEL, Settings())
    assert isinstance(answer, Lacking)
    assert "brightness levels" in answer.reason


def test_levels_within_a_narrow_range_are_lacking():
    photo = photograph(noisy(0.3 + 0.1 * patches(size=512)), GAMMA22, bits=16)
    answer = intensity_similarity_answer(photo, MODEL, Settings())
    assert isinstance(answer, Lacking)
