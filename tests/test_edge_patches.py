"""Finding edge patches: what is one, what is none, and which are kept."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from blend_scene import CELL, GAMMA22, GRID, linear_scene, photograph, sharpened

from facecrf_ocio.published import edge_patches
from facecrf_ocio.published.edge_patches import (
    INNER,
    MAX_BLENDS,
    MIN_BLENDS,
    WINDOW,
    find_edge_patches,
    stack_blends,
)
from facecrf_ocio.published.edge_selection import CODE_BINS, select_patches

LINEAR, COLORS = linear_scene(rows=4, columns=6)
PHOTO = photograph(LINEAR, GAMMA22)
HALF_STEP = 0.5 / 65535.0


@pytest.fixture(scope="module")
def patches():
    return find_edge_patches(PHOTO.encoded)


def two_colors(first, second, *, blur=1.0, size=64):
    """One straight edge across an image, blended in linear light and encoded with gamma 2.2."""
    share = 1.0 / (1.0 + np.exp(-(np.arange(size) - size / 2 + 0.3) / (0.4 * blur)))
    linear = share[None, :, None] * np.array(first) + (1 - share[None, :, None]) * np.array(second)
    return photograph(np.tile(linear, (size, 1, 1)), GAMMA22).encoded


def test_every_patch_lies_on_the_rim_of_one_disk(patches):
    assert len(patches) >= COLORS.shape[0] * COLORS.shape[1]
    for patch in patches:
        x, y = patch.corner_xy
        assert x // CELL == (x + WINDOW - 1) // CELL
        assert y // CELL == (y + WINDOW - 1) // CELL


def test_the_regions_are_the_two_true_colors(patches):
    for patch in patches:
        x, y = patch.corner_xy
        true = np.interp(COLORS[y // CELL, x // CELL], GAMMA22[0], GRID)
        nearest = min(np.abs(patch.regions - t).max() for t in (true, true[::-1]))
        assert nearest < 0.006  # the blend's tails reach into the regions a little


def test_the_blends_are_straight_under_the_true_curve_and_lie_between_the_regions(patches):
    for patch in patches:
        first, second = patch.regions**2.2
        share = ((patch.blends**2.2 - first) @ (second - first)) / ((second - first) ** 2).sum()
        straight = first + share[:, None] * (second - first)
        assert np.abs(patch.blends**2.2 - straight).max() < 0.003
        assert (share > 0.0).all()
        assert (share < 1.0).all()
        assert MIN_BLENDS <= len(patch.blends) <= MAX_BLENDS


def test_patches_share_no_pixel(patches):
    taken = np.zeros(PHOTO.encoded.shape[:2], dtype=int)
    for patch in patches:
        x, y = patch.corner_xy
        taken[y : y + WINDOW, x : x + WINDOW] += 1
    assert taken.max() == 1


def test_the_strongest_contrast_for_its_noise_comes_first(patches):
    quality = [p.contrast / (p.deviation + 1.0 / 255.0) for p in patches]
    assert quality == sorted(quality, reverse=True)


def test_the_same_photo_gives_the_same_patches(patches):
    again = find_edge_patches(PHOTO.encoded)
    assert [p.corner_xy for p in again] == [p.corner_xy for p in patches]


@pytest.mark.parametrize("blur", [0.5, 1.0, 2.0, 3.0])
def test_sharp_and_soft_edges_are_found(blur):
    found = find_edge_patches(two_colors((0.8, 0.3, 0.1), (0.1, 0.5, 0.6), blur=blur))
    assert len(found) >= 64 // WINDOW - 1  # four would fit on top of each other


@pytest.mark.parametrize(
    ("first", "second"),
    [
        pytest.param((0.6, 0.6, 0.6), (0.1, 0.1, 0.1), id="neutral"),
        pytest.param((0.30, 0.2, 0.1), (0.32, 0.22, 0.1), id="too alike"),
        pytest.param((1.0, 0.3, 0.1), (0.1, 0.5, 0.6), id="clipped"),
    ],
)
def test_edges_that_prove_nothing_are_left_out(first, second):
    assert find_edge_patches(two_colors(first, second)) == []


def test_regions_must_be_uniform():
    rng = np.random.default_rng(0)
    clean = two_colors((0.8, 0.3, 0.1), (0.1, 0.5, 0.6))
    noisy = np.clip(clean + rng.normal(0.0, 0.06, clean.shape), 0.0, 1.0).astype(np.float32)
    assert find_edge_patches(noisy) == []


def test_an_edge_without_blended_pixels_gives_nothing():
    hard = np.empty((64, 64, 3), np.float32)
    hard[:, :32], hard[:, 32:] = (0.8, 0.3, 0.1), (0.1, 0.5, 0.6)
    assert find_edge_patches(hard) == []


def test_halos_of_sharpening_are_no_blends(patches):
    left = find_edge_patches(sharpened(PHOTO).encoded)
    assert len(left) < 0.1 * len(patches)


@pytest.mark.parametrize("seed", range(20))
def test_a_window_never_holds_a_third_color(seed):
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[:96, :96] - 47.5 - rng.uniform(-8, 8, (2, 1, 1))
    sector = (np.arctan2(y, x) - rng.uniform(0, 2 * np.pi)) % (2 * np.pi)
    label = np.searchsorted(np.cumsum(rng.dirichlet((4, 4, 4)))[:2] * 2 * np.pi, sector)
    shares = cv2.GaussianBlur((label[..., None] == np.arange(3)).astype(np.float64), (0, 0), 0.8)
    colors = np.array([(0.8, 0.3, 0.1), (0.1, 0.5, 0.6), (0.2, 0.9, 0.3)])
    found = find_edge_patches(photograph(shares @ colors, GAMMA22).encoded)
    assert found
    for patch in found:
        column, row = patch.corner_xy
        window = shares[row : row + WINDOW, column : column + WINDOW][INNER]
        assert window.min(axis=2).max() < 0.02
        assert (window.max(axis=(0, 1)) > 0.5).sum() == 2


@pytest.mark.parametrize("shape", [(1, 1, 3), (14, 200, 3), (15, 15, 3), (100, 100, 3)])
def test_photos_without_any_edge_give_no_patches(shape):
    assert find_edge_patches(np.full(shape, 0.4, np.float32)) == []


def test_a_photo_with_more_windows_than_the_limit_is_sampled_evenly(monkeypatch, patches):
    monkeypatch.setattr(edge_patches, "MAX_WINDOWS", 60)
    fewer = find_edge_patches(PHOTO.encoded)
    assert 0 < len(fewer) < len(patches)
    assert {p.corner_xy[1] // CELL for p in fewer} == set(range(COLORS.shape[0]))


def test_blends_are_gathered_patch_by_patch(patches):
    blends = stack_blends(patches)
    assert blends.regions.shape == (3, len(patches), 2)
    for n, patch in enumerate(patches):
        np.testing.assert_array_equal(blends.regions[:, n].T, patch.regions)
        np.testing.assert_array_equal(blends.blends[:, blends.patch == n].T, patch.blends)


# --- which patches are kept ---


def emptiest_code_range(patches):
    """How many patches reach the code range, of any channel, that the fewest reach."""
    counts = np.zeros((3, CODE_BINS), dtype=int)
    for patch in patches:
        codes = np.concatenate([patch.regions, patch.blends])
        for channel in range(3):
            counts[channel, np.unique((codes[:, channel] * CODE_BINS).astype(int))] += 1
    return counts[:, 4:].min()  # gamma 2.2 encodes the darkest color as 0.17


def test_few_patches_are_all_kept(patches):
    assert select_patches(patches, len(patches)) == patches


def test_the_kept_patches_cover_more_codes_than_the_best_alone(patches):
    count = 20
    kept = select_patches(patches, count)
    assert len(kept) == count
    assert emptiest_code_range(kept) > emptiest_code_range(patches[:count])


def test_no_single_swap_makes_the_kept_patches_better(patches):
    few = patches[::6]
    kept = select_patches(few, len(few) // 2)
    best = set_score(kept)
    for out in kept:
        for other in few:
            if other not in kept:
                swapped = [other if patch is out else patch for patch in kept]
                assert set_score(swapped) <= best + 1e-9


def set_score(patches):
    """Coverage, contrast and noise of a set, written out a second time."""
    score = 0.0
    for channel in range(3):
        for code in range(CODE_BINS):
            low, high = code / CODE_BINS, (code + 1) / CODE_BINS
            reaching = sum(
                any(low <= c < high for c in (*p.regions[:, channel], *p.blends[:, channel]))
                for p in patches
            )
            score += np.log(1.0 + reaching)
    return score + sum(p.contrast - 10.0 * p.deviation for p in patches)
