"""Portraits without a truth: what is asked of two versions of one portrait, and what is not."""

from __future__ import annotations

import numpy as np
import pytest
from face_photos import grace_hopper
from hypothesis import given
from hypothesis import strategies as st
from photo_files import write

from facecrf_ocio import read_photo
from facecrf_ocio.joint import shipped_joint
from facecrf_ocio.joint.evidence import observe
from facecrf_ocio.joint.prior import FAMILIES, FamilyPrior
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.settings import JointSettings
from facecrf_ocio.training.portraits import (
    VERSIONS,
    Versions,
    known_curve,
    observe_portraits,
    read_versions,
    write_versions,
)

GRID = np.linspace(0.0, 1.0, 1024)
POWER = 2.0  # the known curve of the second version


@given(st.integers(0, 1000))
def test_a_known_curve_rises_from_black_to_white_and_loses_few_codes(seed):
    curve = known_curve(np.random.default_rng(seed))
    assert (curve[0], curve[-1]) == (0.0, 1.0)
    assert (np.diff(curve) >= 0.0).all()
    codes = np.unique(np.rint(255.0 * curve[::4]))
    assert len(codes) > 120


def test_versions_are_the_portrait_and_the_portrait_through_curves(tmp_path):
    write(tmp_path / "hopper.png", grace_hopper(), "uint8")
    (tmp_path / "text.jpg").write_text("no photo")
    write(tmp_path / "nobody.png", np.full((64, 64, 3), 0.5, np.float32), "uint8")
    seen = observe_portraits(tmp_path, 1, 1)
    assert seen.curves.shape == (1, VERSIONS, 1024)
    np.testing.assert_array_equal(seen.curves[0, 0], GRID.astype(np.float32))
    plain = observe(read_photo(tmp_path / "hopper.png"), JointSettings()).statistics.by_cue
    for cue in CUES:
        np.testing.assert_allclose(seen.by_cue[cue][0, 0], plain[cue], rtol=1e-6)
        assert not np.array_equal(seen.by_cue[cue][0, 0], seen.by_cue[cue][0, 1])
    write_versions(tmp_path / "versions.npz", seen)
    again = read_versions(tmp_path / "versions.npz")
    np.testing.assert_array_equal(again.curves, seen.curves)
    for cue in CUES:
        np.testing.assert_array_equal(again.by_cue[cue], seen.by_cue[cue])


@given(st.integers(0, 1000))
def test_a_truth_through_a_known_curve_is_what_that_curve_makes_of_it(seed):
    """Coefficients of g(h^-1), against that curve itself, where the basis can bend so."""
    pytest.importorskip("torch", reason="needs the extra train")
    from facecrf_ocio.training.likely_truths import through  # noqa: PLC0415

    prior = shipped_joint().prior
    generator = np.random.default_rng(seed)
    known = GRID ** np.exp(generator.normal(0.0, 0.15))
    coefficients = prior.means[-1] + 0.3 * generator.standard_normal(prior.means.shape[1])
    offset, turned = through(prior, np.linalg.pinv(prior.basis), known.astype(np.float32))
    root = prior.mean + coefficients @ prior.basis
    expected = np.interp(np.interp(prior.grid, known, GRID), prior.grid, root)
    found = prior.mean + (offset + coefficients @ turned) @ prior.basis
    assert np.sqrt(np.mean((found - expected) ** 2)) < 0.01


def test_truths_are_spread_as_the_cameras_prior_is():
    torch = pytest.importorskip("torch", reason="needs the extra train")
    from facecrf_ocio.training.likely_truths import LikelyTruths  # noqa: PLC0415

    torch.manual_seed(0)
    prior = shipped_joint().prior
    likely = LikelyTruths(prior, np.linalg.pinv(prior.basis), GRID[None], {})
    drawn = likely.truths(torch.zeros(20000, dtype=torch.int64)).numpy()
    cameras = prior.family == FAMILIES.index("camera")
    share = prior.weights[cameras] / prior.weights[cameras].sum()
    mean = share @ prior.means[cameras]
    away = prior.means[cameras] - mean
    spread = np.einsum("k,kij->ij", share, prior.covariances[cameras]) + (away.T * share) @ away
    np.testing.assert_allclose(drawn.mean(axis=0), mean, atol=0.05)
    np.testing.assert_allclose(drawn.std(axis=0), np.sqrt(np.diag(spread)), rtol=0.05)


@pytest.fixture
def agreement():
    """One portrait and its square; the root of light is v, plus c (v^(1/2) - v)."""
    pytest.importorskip("torch", reason="needs the extra train")
    from facecrf_ocio.training.agreement import Agreement  # noqa: PLC0415

    basis = np.sqrt(GRID) - GRID
    prior = FamilyPrior(
        *(GRID, GRID, basis[None]),
        *(np.ones(1), np.zeros((1, 1)), np.ones((1, 1, 1)), np.zeros(1, int)),
    )
    curves = np.array([[GRID, GRID**POWER]], np.float32)
    portraits = Versions(curves, {cue: np.zeros((1, 2, 3), np.float32) for cue in CUES})
    return Agreement(prior, portraits, {cue: (np.zeros(3), np.ones(3)) for cue in CUES})


def distances(agreement, *coefficients):
    import torch  # noqa: PLC0415

    apart = agreement.distances(torch.tensor(coefficients)[:, None], torch.tensor([[0, 1]]))
    return float(apart.tones[0]), float(apart.error[0])


def test_estimates_that_follow_the_known_curve_agree(agreement):
    """Light is v^2 of the portrait; of its square it must be v."""
    tones, error = distances(agreement, 0.0, 1.0)
    assert tones < 0.01
    assert error < 0.005


def test_the_same_estimate_of_both_is_apart_by_the_known_curve(agreement):
    """Brute force: v^2 of the portrait against v^4 of its square's estimate, in the same places."""
    tones, error = distances(agreement, 0.0, 0.0)
    v = GRID[::8]
    assert error == pytest.approx(np.sqrt(((v**2 - v**4) ** 2).mean()), rel=0.01)
    both = v[(v**POWER >= 64 / 255) & (v <= 235 / 255)]
    middle = v[np.abs(v + v**POWER - 256 / 255).argmin()]
    assert tones == pytest.approx(np.abs(2.0 * np.log2(both / middle)).mean(), rel=0.02)


def test_pairs_are_of_one_portrait_and_of_two_versions(agreement):
    pairs = agreement.some_pairs(50).numpy()
    assert set(map(tuple, pairs.tolist())) == {(0, 1), (1, 0)}
