"""Single-pigment pairs against eq. 25 written out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from facecrf_ocio.published.gradients import single_pigment_pairs
from facecrf_ocio.published.pigments import Pigments
from facecrf_ocio.settings import Settings

SETTINGS = Settings()


def skin(seed, count=1500):
    rng = np.random.default_rng(seed)
    pigments = Pigments(rng.laplace(size=count), rng.laplace(size=count), np.zeros((2, 3)))
    neighbors = rng.integers(count, size=(4 * count, 2))
    return pigments, neighbors, rng.uniform(size=count) < 0.8


def by_hand(pigments, neighbors, diffuse, settings):
    """Eq. 25, pair by pair."""
    used = [(p, q) for p, q in neighbors.tolist() if diffuse[p] and diffuse[q]]
    change = {
        name: [abs(density[q] - density[p]) for p, q in used]
        for name, density in (("m", pigments.melanin), ("h", pigments.hemoglobin))
    }
    low = {k: np.quantile(v, settings.gradient_low) for k, v in change.items()}
    high = {k: np.quantile(v, settings.gradient_high) for k, v in change.items()}
    found = []
    for pair, m, h in zip(used, change["m"], change["h"], strict=True):
        if m > high["m"] and h < low["h"]:
            found.append((*pair, True))
        elif h > high["h"] and m < low["m"]:
            found.append((*pair, False))
    return found


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "settings",
    [SETTINGS, replace(SETTINGS, gradient_low=0.3, gradient_high=0.8)],
    ids=["default", "wide"],
)
def test_pairs_are_those_of_eq_25(seed, settings):
    given = skin(seed)
    found = single_pigment_pairs(*given, settings)
    pairs = [(*p, m) for p, m in zip(found.pairs.tolist(), found.is_melanin.tolist(), strict=True)]
    expected = by_hand(*given, settings)
    assert len(expected) > 10
    assert [(p, q, m) for p, q, m in pairs] == expected


def test_both_pixels_of_a_pair_are_diffuse():
    pigments, neighbors, diffuse = skin(0)
    found = single_pigment_pairs(pigments, neighbors, diffuse, SETTINGS)
    assert diffuse[found.pairs].all()


def test_no_usable_pair_gives_none():
    pigments, neighbors, diffuse = skin(0)
    found = single_pigment_pairs(pigments, neighbors, np.zeros_like(diffuse), SETTINGS)
    assert found.pairs.shape == (0, 2)
    assert found.is_melanin.shape == (0,)


def test_flat_skin_gives_none():
    _, neighbors, diffuse = skin(0)
    flat = Pigments(np.ones(diffuse.size), np.ones(diffuse.size), np.zeros((2, 3)))
    assert not len(single_pigment_pairs(flat, neighbors, diffuse, SETTINGS).pairs)
