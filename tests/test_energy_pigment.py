"""The skin pigment prior of eq. 12-16: its value, its gradient, and what it cannot see."""

from __future__ import annotations

import numpy as np
import pytest
from differences import directional_slopes
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from facecrf_ocio.published.energy.pigment import (
    PigmentPairs,
    SkinPigment,
    balanced_ratio,
    singular_ratio,
)
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.synthetic.skin_layers import DIRECTIONS

SIZE = 256
GRID = np.linspace(0.0, 1.0, SIZE)
MODEL = dorf_model()

curves = st.tuples(st.floats(0.6, 3.0), st.floats(-0.3, 0.3), st.integers(0, 1000)).map(
    lambda given: bent(*given)
)
seeds = st.integers(0, 10_000)


def bent(exponent, bend, seed):
    """Three different positive curves that rise from 0 to 1."""
    rng = np.random.default_rng(seed)
    exponents = exponent * rng.uniform(0.8, 1.2, (3, 1))
    return GRID**exponents + bend * GRID * (1.0 - GRID) ** 2 * GRID


def some_pairs(seed, *, shaded, count=12):
    """Arbitrary pairs and an arbitrary linear map from log g to shading changes."""
    rng = np.random.default_rng(seed)
    near = rng.uniform(0.15, 0.85, (3, count, 1))
    encoded = np.concatenate([near, near + rng.uniform(-0.1, 0.1, near.shape)], axis=2)
    nodes = np.linspace(0.0, 1.0, 30)
    weights = rng.normal(0.0, 0.02, (3, count, 30)) if shaded else None
    return PigmentPairs(encoded, np.arange(count) < count // 2, nodes, weights)


def single_pigment(seed, inverse, *, contrast=0.3):
    """Pairs between which one true pigment changes, encoded by the inverse of `inverse(x)`."""
    rng = np.random.default_rng(seed)
    is_melanin = np.arange(40) < 20
    start = rng.uniform(-1.8, -0.7, (3, 40))
    change = rng.uniform(-contrast, contrast, 40) * np.where(
        is_melanin, DIRECTIONS[0][:, None], DIRECTIONS[1][:, None]
    )
    fine = np.linspace(0.0, 1.0, 20_001)
    linear = np.exp(np.stack([start, start + change], axis=2))
    return PigmentPairs(np.interp(linear, inverse(fine), fine), is_melanin, GRID, None)


# --- the singular values ---


@given(arrays(float, st.tuples(st.just(3), st.integers(3, 30)), elements=st.floats(-2, 2)), seeds)
def test_singular_ratio_is_that_of_the_singular_values(offsets, seed):
    columns = offsets + np.random.default_rng(seed).normal(size=offsets.shape)
    first, second, _ = np.linalg.svd(columns, compute_uv=False)
    assert singular_ratio(columns)[0] == pytest.approx(second / first, rel=1e-6)


@given(st.integers(3, 30), seeds)
def test_gradient_of_the_singular_ratio_agrees_with_differences(count, seed):
    rng = np.random.default_rng(seed)
    columns = np.array([[3.0], [2.0], [1.0]]) * rng.normal(size=(3, count))
    _, gradient = singular_ratio(columns)
    directions = rng.normal(size=(4, 3, count))
    slopes = directional_slopes(lambda c: singular_ratio(c)[0], columns, directions, 1e-6)
    singular = np.linalg.svd(columns, compute_uv=False)
    gap = np.abs(np.diff(singular**2)).min() / singular[0] ** 2  # where two meet it has a corner
    expected = (directions * gradient).sum(axis=(1, 2))
    assert np.allclose(slopes, expected, atol=1e-5 + 1e-9 / gap)


@given(arrays(float, 3, elements=st.floats(0.1, 1.0)), st.integers(1, 40), seeds)
def test_rank_one_columns_have_ratio_0(direction, count, seed):
    densities = np.random.default_rng(seed).normal(size=count) + 3.0
    value, gradient = singular_ratio(np.outer(direction, densities))
    assert value == pytest.approx(0.0, abs=1e-6)
    assert np.isfinite(gradient).all()


@given(seeds, st.floats(0.01, 100.0))
def test_the_ratio_ignores_the_scale_of_all_columns(seed, scale):
    columns = np.random.default_rng(seed).normal(size=(3, 8))
    assert singular_ratio(scale * columns)[0] == pytest.approx(singular_ratio(columns)[0])


@given(st.integers(3, 30), seeds)
def test_gradient_of_the_balanced_ratio_agrees_with_differences(count, seed):
    rng = np.random.default_rng(seed)
    columns = np.array([[3.0], [2.0], [1.0]]) * rng.normal(size=(3, count))
    _, gradient = balanced_ratio(columns)
    directions = rng.normal(size=(4, 3, count))
    slopes = directional_slopes(lambda c: balanced_ratio(c)[0], columns, directions, 1e-6)
    lengths = np.sqrt((columns**2).mean(axis=1, keepdims=True))
    singular = np.linalg.svd(columns / lengths, compute_uv=False)
    gap = np.abs(np.diff(singular**2)).min() / singular[0] ** 2
    expected = (directions * gradient).sum(axis=(1, 2))
    assert np.allclose(slopes, expected, atol=1e-5 + 1e-9 / gap)


@given(seeds, arrays(float, (3, 1), elements=st.floats(0.01, 100.0)))
def test_the_balanced_ratio_ignores_the_scale_of_each_channel(seed, scales):
    """So a curve cannot lower it by being steep in one channel; rank one stays rank one."""
    rng = np.random.default_rng(seed)
    columns = rng.normal(size=(3, 8))
    assert balanced_ratio(scales * columns)[0] == pytest.approx(balanced_ratio(columns)[0])
    rank_one = np.outer(rng.uniform(0.1, 1.0, 3), rng.normal(size=8))
    assert balanced_ratio(rank_one)[0] == pytest.approx(0.0, abs=1e-6)


# --- value and gradient of E_p ---


def test_exact_columns_are_log_albedo_ratios():
    """log g(I_q) - log g(I_p) - (d_q - d_p), computed here from the curves directly."""
    given_pairs, samples = some_pairs(3, shaded=True), bent(2.2, 0.1, 0)
    log_g = [
        np.log(np.interp(e, GRID, s)) for e, s in zip(given_pairs.encoded, samples, strict=True)
    ]
    nodes = [np.interp(given_pairs.nodes, GRID, s) for s in samples]
    shading = [
        w @ np.log(np.maximum(n, 1e-5)) for w, n in zip(given_pairs.shading, nodes, strict=True)
    ]
    expected = np.stack([pair[:, 1] - pair[:, 0] for pair in log_g]) - shading
    assert np.allclose(SkinPigment(given_pairs, SIZE).columns(samples), expected)


def test_first_order_columns_are_eq_15():
    """log(g'(I) dI / g(I) - dD/D + 1), with forward differences."""
    given_pairs = some_pairs(3, shaded=False)
    exponents = np.array([[1.8], [2.2], [2.6]])
    fine = np.linspace(0.0, 1.0, 100_001)
    near, far = given_pairs.encoded.transpose(2, 0, 1)
    expected = np.log(exponents * (far - near) / near + 1.0)  # g'/g of a power is k / I
    term = SkinPigment(given_pairs, fine.size, first_order=True)
    assert np.allclose(term.columns(fine**exponents), expected, atol=2e-4)


def test_first_order_approaches_the_exact_columns_as_the_steps_shrink():
    gaps = []
    for contrast in (0.2, 0.1, 0.05):
        pairs = single_pigment(1, lambda e: e**2.2, contrast=contrast)
        samples = np.tile(np.linspace(0, 1, 20_001) ** 2.2, (3, 1))
        exact, first = (
            SkinPigment(pairs, 20_001, first_order=order).columns(samples)
            for order in (False, True)
        )
        gaps.append(np.abs(exact - first).max())
    assert gaps[0] / gaps[1] == pytest.approx(4.0, abs=1.0)
    assert gaps[1] / gaps[2] == pytest.approx(4.0, abs=1.0)


@pytest.mark.parametrize("shaded", [True, False])
@pytest.mark.parametrize("first_order", [True, False])
def test_e_p_is_the_sum_of_both_pigments_ratios(shaded, first_order):
    given_pairs, samples = some_pairs(5, shaded=shaded), bent(2.0, 0.2, 1)
    term = SkinPigment(given_pairs, SIZE, first_order=first_order)
    columns = term.columns(samples)
    ratios = []
    for chosen in (given_pairs.is_melanin, ~given_pairs.is_melanin):
        singular = np.linalg.svd(columns[:, chosen], compute_uv=False)
        ratios.append(singular[1] / singular[0])
    assert term.value_and_gradient(samples)[0] == pytest.approx(sum(ratios))


@pytest.mark.parametrize("shaded", [True, False])
@pytest.mark.parametrize("first_order", [True, False])
@settings(max_examples=25)
@given(samples=curves, seed=seeds)
def test_the_gradient_agrees_with_differences(shaded, first_order, samples, seed):
    term = SkinPigment(some_pairs(seed, shaded=shaded), SIZE, first_order=first_order)
    _, gradient = term.value_and_gradient(samples)
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(4, 3, SIZE)) * GRID  # relative to g(0) = 0: none below zero
    directions[:2] = rng.normal(size=(2, 3, 1)) * np.sin(np.pi * GRID)
    expected = (directions * gradient).sum(axis=(1, 2))
    for step in (1e-6, 1e-7):  # near a corner of the singular values only the smaller one holds
        slopes = directional_slopes(
            lambda s: term.value_and_gradient(s)[0], samples, directions, step
        )
        if np.allclose(slopes, expected, rtol=1e-4, atol=1e-4 * np.abs(expected).max() + 1e-5):
            return
    raise AssertionError((slopes, expected))


def test_curves_that_touch_zero_stay_finite():
    samples = np.maximum(GRID - 0.4, 0.0) * np.ones((3, 1))
    for first_order in (False, True):
        term = SkinPigment(some_pairs(2, shaded=True), SIZE, first_order=first_order)
        value, gradient = term.value_and_gradient(samples)
        assert np.isfinite(value)
        assert np.isfinite(gradient).all()


# --- what it sees and what it cannot ---


@given(st.floats(0.5, 3.0), seeds)
def test_single_pigment_pairs_have_no_energy_under_the_true_curve(exponent, seed):
    pairs = single_pigment(seed, lambda e: e**exponent)
    samples = np.tile(np.linspace(0, 1, 20_001) ** exponent, (3, 1))
    assert SkinPigment(pairs, 20_001).value_and_gradient(samples)[0] < 2e-3


@pytest.mark.parametrize("seed", range(5))
def test_they_have_energy_under_a_curve_of_another_shape(seed):
    pairs = single_pigment(seed, lambda e: 0.4 * e + 0.6 * e**4)
    fine = np.linspace(0, 1, 20_001)
    term = SkinPigment(pairs, fine.size)
    right, wrong = (
        term.value_and_gradient(np.tile(g, (3, 1)))[0]
        for g in (0.4 * fine + 0.6 * fine**4, fine**2)
    )
    assert right < 2e-3
    assert wrong > 20 * right


@given(samples=curves, seed=seeds, k=st.floats(0.4, 2.5), shaded=st.booleans())
def test_the_exponent_is_invisible_in_exact_mode(samples, seed, k, shaded):
    """g -> g^k multiplies every log by k; ratios of singular values do not move."""
    pairs = some_pairs(seed, shaded=shaded)
    nodes = np.linspace(0.0, 1.0, 30)[1:]
    snapped = PigmentPairs(
        np.rint(pairs.encoded * (SIZE - 1)) / (SIZE - 1),  # codes of the grid: no interpolation
        pairs.is_melanin,
        np.rint(nodes * (SIZE - 1)) / (SIZE - 1),
        None if pairs.shading is None else pairs.shading[:, :, 1:],
    )
    term = SkinPigment(snapped, SIZE)
    floor = np.maximum(samples, 1e-4) ** (1.0 / 2.5)  # so that no power meets the floor of the log
    expected = term.value_and_gradient(floor)[0]
    assert term.value_and_gradient(floor**k)[0] == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("seed", range(5))
def test_first_order_breaks_the_tie_but_not_toward_the_truth(seed):
    """Among pure gammas only truncation decides: the minimum lies far below the truth, 2.2."""
    pairs = single_pigment(seed, lambda e: e**2.2)
    fine = np.linspace(0, 1, 20_001)
    exponents = np.arange(0.6, 3.4, 0.2)
    exact, first = (
        [
            SkinPigment(pairs, fine.size, first_order=order).value_and_gradient(
                np.tile(fine**k, (3, 1))
            )[0]
            for k in exponents
        ]
        for order in (False, True)
    )
    assert np.ptp(exact) < 1e-3
    assert np.ptp(first) > 20 * np.ptp(exact)
    assert exponents[np.argmin(first)] < 1.6


@given(arrays(float, 3, elements=st.floats(0.5, 1.5)), seeds)
def test_channel_gains_do_not_change_it_under_the_true_curve(gains, seed):
    """Property 1: factors on the linear channels drop out of log ratios."""
    pairs = single_pigment(seed, lambda e: e**2.2)
    scaled = PigmentPairs(
        np.clip(pairs.encoded * gains[:, None, None] ** (1 / 2.2), 0, 1),
        pairs.is_melanin,
        pairs.nodes,
        None,
    )
    samples = np.tile(np.linspace(0, 1, 20_001) ** 2.2, (3, 1))
    before, after = (SkinPigment(p, 20_001).columns(samples) for p in (pairs, scaled))
    inside = (scaled.encoded < 1.0).all(axis=(0, 2))
    assert np.allclose(before[:, inside], after[:, inside], atol=1e-4)
