"""Pigment separation on mixtures whose ingredients are known."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from skin_truth import unit
from sklearn.decomposition import FastICA
from sklearn.exceptions import ConvergenceWarning

from facecrf_ocio.published.pigments import separate_pigments
from facecrf_ocio.synthetic.skin_layers import DIRECTIONS

SIDE = 70
BASE = np.array([-0.9, -1.5, -1.8])


def grid_neighbors(side=SIDE):
    number = np.arange(side * side).reshape(side, side)
    beside = np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)
    below = np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1)
    return np.concatenate([beside, below])


NEIGHBORS = grid_neighbors()
EVERYWHERE = np.ones(SIDE * SIDE, dtype=bool)


def sparse_densities(seed):
    """Independent marks on plain skin: (2, n), melanin first."""
    rng = np.random.default_rng(seed)
    shape = (2, SIDE * SIDE)
    marks = (rng.uniform(size=shape) < 0.06) * rng.uniform(0.1, 0.6, shape)
    return marks + rng.normal(0.0, 0.01, shape)


def log_albedo(densities, directions=DIRECTIONS):
    return BASE + densities.T @ directions


def smooth_shading(strength):
    y, x = np.mgrid[:SIDE, :SIDE] / SIDE
    return strength * (np.sin(3 * x + 1) * np.cos(2 * y)).ravel()[:, None] * np.ones(3)


def angles(found, true):
    return np.degrees(np.arccos(np.clip((unit(found) * unit(true)).sum(axis=1), -1.0, 1.0)))


@pytest.mark.parametrize("seed", range(6))
def test_directions_are_found_and_named(seed):
    found = separate_pigments(log_albedo(sparse_densities(seed)), EVERYWHERE, NEIGHBORS)
    assert angles(found.directions, DIRECTIONS).max() < 2.0


@pytest.mark.parametrize("seed", range(3))
def test_densities_are_found_up_to_an_offset_in_units_of_the_directions(seed):
    true = sparse_densities(seed)
    found = separate_pigments(log_albedo(true), EVERYWHERE, NEIGHBORS)
    for estimate, density in zip((found.melanin, found.hemoglobin), true, strict=True):
        assert np.corrcoef(estimate, density)[0, 1] > 0.99
        assert np.polyfit(density, estimate, 1)[0] == pytest.approx(1.0, abs=0.1)


def test_directions_are_unit_and_darken():
    directions = separate_pigments(
        log_albedo(sparse_densities(0)), EVERYWHERE, NEIGHBORS
    ).directions
    assert np.allclose(np.linalg.norm(directions, axis=1), 1.0)
    assert (directions.sum(axis=1) < 0).all()


@pytest.mark.parametrize("turn", [-5.0, 5.0])
@pytest.mark.parametrize("pigment", [0, 1])
def test_names_hold_for_the_pigments_of_other_cameras_and_skins(turn, pigment):
    """Single cameras' directions lie about 5 degrees rms around the mean used here."""
    directions = DIRECTIONS.copy()
    other = np.cross(DIRECTIONS[0], DIRECTIONS[1])
    directions[pigment] += np.tan(np.radians(turn)) * unit(other)
    found = separate_pigments(log_albedo(sparse_densities(1), directions), EVERYWHERE, NEIGHBORS)
    assert angles(found.directions, directions).max() < 3.0


@pytest.mark.parametrize("strength", [0.1, 0.5])
def test_smooth_achromatic_residue_of_shading_is_not_taken_for_a_pigment(strength):
    densities = sparse_densities(2)
    plain = separate_pigments(log_albedo(densities), EVERYWHERE, NEIGHBORS)
    shaded = separate_pigments(
        log_albedo(densities) + smooth_shading(strength), EVERYWHERE, NEIGHBORS
    )
    assert angles(shaded.directions, plain.directions).max() < 2.0
    assert np.corrcoef(shaded.melanin, plain.melanin)[0, 1] > 0.999
    assert np.corrcoef(shaded.hemoglobin, plain.hemoglobin)[0, 1] > 0.999


def test_the_color_of_the_light_changes_nothing():
    """Gains on the channels are offsets of log albedo (Property 1)."""
    albedo = log_albedo(sparse_densities(3))
    plain, tinted = (
        separate_pigments(albedo + gains, EVERYWHERE, NEIGHBORS)
        for gains in (np.zeros(3), np.array([0.3, -0.2, -0.9]))
    )
    assert np.allclose(tinted.directions, plain.directions, atol=1e-9)


def test_only_diffuse_pixels_teach():
    albedo = log_albedo(sparse_densities(4))
    diffuse = np.arange(len(albedo)) < len(albedo) // 2
    spoiled = albedo.copy()
    spoiled[~diffuse] = np.random.default_rng(0).normal(size=(int((~diffuse).sum()), 3))
    clean = separate_pigments(albedo, diffuse, NEIGHBORS)
    assert np.array_equal(
        separate_pigments(spoiled, diffuse, NEIGHBORS).directions, clean.directions
    )


def fast_ica(chromaticity):
    """Mixing directions of scikit-learn's FastICA, the best of several starts by its contrast."""
    best, directions = -np.inf, None
    for start in range(6):
        ica = FastICA(fun="logcosh", whiten="unit-variance", random_state=start, max_iter=1000)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ConvergenceWarning)
            sources = ica.fit_transform(chromaticity)
        contrast = ((np.log(np.cosh(sources)).mean(axis=0) - 0.3745672) ** 2).sum()
        if contrast > best:
            best, directions = contrast, ica.mixing_.T
    return directions


@pytest.mark.parametrize("seed", range(3))
def test_chromatic_directions_are_fast_ica_s(seed):
    albedo = log_albedo(sparse_densities(seed))
    chromaticity = np.stack([albedo[:, 0] - albedo[:, 1], albedo[:, 1] - albedo[:, 2]], axis=1)
    found = separate_pigments(albedo, EVERYWHERE, NEIGHBORS).directions
    ours = unit(np.stack([found[:, 0] - found[:, 1], found[:, 1] - found[:, 2]], axis=1))
    cosines = np.abs(ours @ unit(fast_ica(chromaticity)).T)
    assert np.degrees(np.arccos(np.minimum(cosines.max(axis=1), 1.0))).max() < 1.5
    assert set(cosines.argmax(axis=1)) == {0, 1}
