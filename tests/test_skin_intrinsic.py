"""The factorized decomposition against eq. 27 written out and minimized by brute force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from facecrf_ocio.published.intrinsic import prepare_decomposition
from facecrf_ocio.settings import Settings

SETTINGS = replace(Settings(), albedo_weight=1.3, shading_weight=0.2, nonlocal_weight=0.7)
STEP = np.sin(np.radians(SETTINGS.normal_threshold))


def tiny(seed, height=6, width=7):
    """Encoded colors, normals that lie on a few nodes of the direction grid, and skin."""
    rng = np.random.default_rng(seed)
    encoded = np.exp(np.log([0.6, 0.45, 0.35]) + rng.normal(0, 0.018, (height, width, 3)))
    # Two cells apart: neighboring nodes are as far apart as the threshold of close normals.
    xy = 2 * STEP * rng.integers(-1, 2, (height, width, 2))
    normals = np.concatenate([xy, np.sqrt(1 - (xy**2).sum(axis=2, keepdims=True))], axis=2)
    skin = rng.uniform(size=(height, width)) < 0.85
    return encoded.astype(np.float32), normals.astype(np.float32), skin


def numbered(skin):
    pixels = list(zip(*np.nonzero(skin), strict=True))
    return pixels, {pixel: n for n, pixel in enumerate(pixels)}


def brute_force(encoded, normals, skin, log_radiance, settings):
    """Minimize eq. 27 over `d` as a dense least-squares problem, pair by pair."""
    pixels, number = numbered(skin)
    rows, right = [], []

    def add(p, q, weight, value):
        row = np.zeros(len(pixels))
        row[p], row[q] = -np.sqrt(weight), np.sqrt(weight)
        rows.append(row)
        right.append(np.sqrt(weight) * value)

    closeness = 2 * np.sin(np.radians(settings.normal_threshold) / 2)
    for (y, x), p in number.items():
        for beside in ((y, x + 1), (y + 1, x)):
            if (q := number.get(beside)) is None:
                continue
            colors = [encoded[at].astype(float) for at in ((y, x), beside)]
            chromaticities = [c / c.sum() for c in colors]
            if (
                np.linalg.norm(chromaticities[1] - chromaticities[0])
                < settings.chromaticity_threshold
            ):
                # albedo: w_a (a_q - a_p)^2 with a = r - d
                add(p, q, settings.albedo_weight, log_radiance[q] - log_radiance[p])
            if np.linalg.norm(normals[beside] - normals[y, x]) < closeness:
                add(p, q, settings.shading_weight, 0.0)
    directions = np.rint(normals[skin][:, :2] / STEP).astype(int)
    for direction in np.unique(directions, axis=0):
        same = np.flatnonzero((directions == direction).all(axis=1)).tolist()
        for i, p in enumerate(same):
            for q in same[i + 1 :]:  # all pairs of one direction
                add(p, q, settings.nonlocal_weight / len(same), 0.0)
    rows.append(np.ones(len(pixels)))
    right.append(0.0)
    return np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0]


def smooth_face(size=40):
    """Normals of a bulge, and colors that vary."""
    y, x = (np.mgrid[:size, :size] - size / 2) / size
    xy = np.stack([x, -y], axis=2)
    normals = np.concatenate([xy, np.sqrt(1 - (xy**2).sum(axis=2, keepdims=True))], axis=2)
    rng = np.random.default_rng(0)
    encoded = np.exp(np.log([0.6, 0.45, 0.35]) + rng.normal(0, 0.02, (size, size, 3)))
    return encoded.astype(np.float32), normals.astype(np.float32), np.ones((size, size), bool)


FACE = smooth_face()
DECOMPOSITION = prepare_decomposition(*FACE, SETTINGS)
PIXELS = int(FACE[2].sum())


@pytest.mark.parametrize("seed", range(6))
def test_it_minimizes_eq_27(seed):
    encoded, normals, skin = tiny(seed)
    log_radiance = np.random.default_rng(seed).normal(size=int(skin.sum()))
    found = prepare_decomposition(encoded, normals, skin, SETTINGS).shading(log_radiance)
    expected = brute_force(encoded, normals, skin, log_radiance, SETTINGS)
    assert np.ptp(expected) > 0.2
    assert np.allclose(found - found.mean(), expected - expected.mean(), atol=2e-5)


@pytest.mark.parametrize("name", ["albedo_weight", "shading_weight", "nonlocal_weight"])
def test_every_weight_counts(name):
    encoded, normals, skin = tiny(1)
    settings = replace(SETTINGS, **{name: 5.0 * getattr(SETTINGS, name)})
    r = np.random.default_rng(1).normal(size=int(skin.sum()))
    found = prepare_decomposition(encoded, normals, skin, settings).shading(r)
    expected = brute_force(encoded, normals, skin, r, settings)
    before = prepare_decomposition(encoded, normals, skin, SETTINGS).shading(r)
    assert np.allclose(found - found.mean(), expected - expected.mean(), atol=2e-5)
    assert np.abs(found - before).max() > 0.01


def test_neighbors_are_the_4_connected_pairs_of_skin():
    _, _, skin = tiny(2)
    decomposition = prepare_decomposition(*tiny(2), SETTINGS)
    pixels, number = numbered(skin)
    expected = {
        (number[y, x], number[other])
        for y, x in pixels
        for other in ((y, x + 1), (y + 1, x))
        if other in number
    }
    assert {tuple(pair) for pair in decomposition.neighbors.tolist()} == expected


@given(st.integers(0, 1000), st.floats(-3, 3), st.floats(-3, 3))
@settings(max_examples=20)
def test_it_is_linear_in_log_radiance(seed, a, b):
    r, s = np.random.default_rng(seed).normal(size=(2, PIXELS))
    both = DECOMPOSITION.shading(a * r + b * s)
    apart = a * DECOMPOSITION.shading(r) + b * DECOMPOSITION.shading(s)
    assert np.allclose(both, apart, atol=1e-8)


def test_channels_are_decomposed_alike():
    r = np.random.default_rng(0).normal(size=(PIXELS, 3))
    columns = [DECOMPOSITION.shading(r[:, c]) for c in range(3)]
    assert np.allclose(DECOMPOSITION.shading(r), np.stack(columns, axis=1), atol=1e-10)


def test_more_light_everywhere_is_no_shading():
    r = np.random.default_rng(0).normal(size=PIXELS)
    assert np.allclose(DECOMPOSITION.shading(np.full(PIXELS, 1.7)), 0.0, atol=1e-7)
    assert np.allclose(DECOMPOSITION.shading(r + 1.7), DECOMPOSITION.shading(r), atol=1e-7)


@pytest.mark.parametrize("count", [1, 15, 16, 17, 40])
def test_adjoint_weights_are_differences_of_shading(count):
    rng = np.random.default_rng(count)
    pairs = DECOMPOSITION.neighbors[rng.integers(len(DECOMPOSITION.neighbors), size=count)]
    r = rng.normal(size=PIXELS)
    shading = DECOMPOSITION.shading(r)
    weights = DECOMPOSITION.shading_change_weights(pairs)
    assert weights.shape == (PIXELS, count)
    assert np.allclose(r @ weights, shading[pairs[:, 1]] - shading[pairs[:, 0]], atol=1e-9)


def test_log_shading_linear_in_the_normal_is_recovered_on_skin_of_one_albedo():
    encoded, normals, skin = FACE
    plain = np.broadcast_to(np.float32([0.6, 0.45, 0.35]), encoded.shape)
    free = replace(SETTINGS, shading_weight=0.0)
    shading = 0.8 * normals[skin][:, 0] - 0.5 * normals[skin][:, 1]
    found = prepare_decomposition(plain, normals, skin, free).shading(shading.astype(float))
    assert np.allclose(found - found.mean(), shading - shading.mean(), atol=1e-4)


def test_a_mark_of_another_color_stays_in_the_albedo():
    """Around it the pairs are not close in chromaticity: nothing there is taken for shading."""
    encoded, normals, skin = FACE
    marked = np.broadcast_to(np.float32([0.6, 0.45, 0.35]), encoded.shape).copy()
    marked[18:22, 18:22] = [0.5, 0.25, 0.2]
    r = np.log(marked[skin].astype(float))
    found = prepare_decomposition(marked, normals, skin, SETTINGS).shading(r)
    assert np.abs(found).max() < 0.01
