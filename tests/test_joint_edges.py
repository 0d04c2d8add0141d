"""Edges: where the middle of a blurred step lies tells how the curve bends between its sides."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from facecrf_ocio.joint.color_lines import bend_profile
from facecrf_ocio.joint.edge_counts import EDGE_LEVELS
from facecrf_ocio.joint.edges import edge_profile, soft_edge_profile
from facecrf_ocio.joint.noise_counts import count_noise
from facecrf_ocio.joint.second_differences import sizes_of
from facecrf_ocio.joint.soft_edges import (
    SOFT_LEVELS,
    SOFT_SIZES,
    SoftEdges,
    count_soft_edges,
)

PAIRS = EDGE_LEVELS * (EDGE_LEVELS - 1) // 2


def soft_edges_of(codes: np.ndarray) -> SoftEdges:
    """Those of one window (H, W, 3)."""
    return count_soft_edges(sizes_of(codes[None], len(SOFT_SIZES)))


def stripes(power: float) -> np.ndarray:
    """Blurred steps between two levels of light, encoded so that light is encoded ** power."""
    dark, bright = (np.array([70.0, 190.0]) / 255.0) ** power
    steps = np.repeat(np.tile([dark, bright], 12), 16)
    shifted = np.stack([np.interp(np.arange(384) + s, np.arange(384), steps) for s in
                        np.linspace(0.0, 1.0, 200)])  # fmt: skip
    light = cv2.blur(shifted, (3, 1))
    return np.repeat(light[..., None] ** (1.0 / power), 3, axis=2).astype(np.float32)


def place(power: float) -> float:
    vector = edge_profile(count_noise([stripes(power)]))
    assert vector is not None
    means, trust = vector[:PAIRS], vector[PAIRS : 2 * PAIRS]
    seen = trust > 0.5
    assert seen.any()
    return float(np.average(means[seen] / trust[seen], weights=trust[seen]))


def test_in_linear_codes_the_middle_lies_halfway():
    assert place(1.0) == pytest.approx(0.0, abs=0.01)


def test_the_steeper_the_curve_the_brighter_the_middle():
    found = [place(power) for power in (0.6, 1.0, 1.6, 2.4)]
    assert found == sorted(found)
    assert found[-1] - found[0] > 0.05


def test_a_flat_photo_has_no_edges():
    assert edge_profile(count_noise([np.full((64, 64, 3), 0.4, np.float32)])) is None


def soft_steps(power: float, width: float) -> np.ndarray:
    """Steps 96 px apart that rise over about `width` px, encoded so that light is a power.

    They lean, so that they fall between the pixels in every way.
    """
    dark, bright = (np.array([48.0, 208.0]) / 255.0) ** power
    steps = np.repeat(np.tile([dark, bright], 4), 96)
    blurred = cv2.GaussianBlur(steps[None], (0, 0), width / 4.0)[0]
    leaning = np.arange(576) + np.linspace(0.0, 96.0, 192)[:, None]
    encoded = np.rint(255.0 * np.interp(leaning, np.arange(768), blurred) ** (1.0 / power))
    return np.repeat(encoded[..., None], 3, axis=2).astype(np.uint8)


@pytest.mark.parametrize("size", SOFT_SIZES)
def test_in_linear_codes_soft_middles_lie_halfway_at_every_size(size):
    number = SOFT_SIZES.index(size)
    counted, total, _ = soft_edges_of(soft_steps(1.0, 4.5 * size)).middles[number].sum((0, 1))
    assert counted > 100.0
    assert total / counted == pytest.approx(0.5, abs=0.01)


def test_a_hard_step_is_not_soft():
    hard = np.zeros((64, 64, 3), np.uint8) + np.repeat([60, 200], 32).astype(np.uint8)[:, None]
    assert not soft_edges_of(hard).middles[0].any()


def brute_force(plane: np.ndarray) -> np.ndarray:
    """(8, 8, 3) of one plane, edges down it, one pixel after another as the docstring says."""
    found = np.zeros((SOFT_LEVELS, SOFT_LEVELS, 3))
    for column in plane.T.astype(np.float32):
        for first in range(len(column) - 6):
            run = column[first : first + 7]
            rise = run[5] - run[1]
            if abs(rise) < 14.0 or run.max() >= 254.5:
                continue
            steps = np.diff(run) / rise
            if (
                steps[1:5].min() >= 0.04
                and steps[1:5].max() <= 0.45
                and abs(steps[[0, 5]]).max() <= 0.2
            ):
                low, high = sorted((run[1], run[5]))
                middle = (run[2:5].mean() - low) / (high - low)
                found[int(low // 32), int(high // 32)] += (1.0, middle, middle**2)
    return found


@settings(max_examples=20)
@given(st.integers(0, 2**32 - 1))
def test_soft_edges_are_counted_as_one_pixel_after_another(seed):
    noise = np.random.default_rng(seed).normal(size=(40, 40, 3))
    smooth = cv2.GaussianBlur(noise, (0, 0), 1.5)
    codes = np.clip(128.0 + 100.0 * smooth / smooth.std(), 0.0, 255.0).astype(np.uint8)
    channels = np.moveaxis(codes, 2, 0)
    finest = sum(brute_force(one[:, ::2]) + brute_force(one.T[:, ::2]) for one in channels)
    halves = channels.reshape(3, 20, 2, 20, 2).mean(axis=(2, 4))
    halved = sum(brute_force(one) + brute_force(one.T) for one in halves)
    counts = soft_edges_of(codes).middles
    assert counts[0] == pytest.approx(finest, rel=1e-5)
    assert counts[1] == pytest.approx(halved, rel=1e-5)


def test_turning_a_photo_changes_no_soft_edge():
    codes = soft_steps(1.6, 9.0)
    turned = np.ascontiguousarray(np.rot90(codes))
    found, expected = soft_edges_of(turned), soft_edges_of(codes)
    assert found.middles[1:] == pytest.approx(expected.middles[1:])
    assert found.lines[1:] == pytest.approx(expected.lines[1:])


def test_without_soft_edges_their_profile_trusts_nothing():
    nothing = soft_edges_of(np.full((64, 64, 3), 100, np.uint8)).middles
    assert not soft_edge_profile(nothing, nothing).any()
    assert soft_edge_profile(nothing, soft_edges_of(soft_steps(1.0, 4.5)).middles).any()


def disks(power: float) -> np.ndarray:
    """Counts of ten pictures of blurred disks in all colors; light is encoded ** power."""
    generator = np.random.default_rng(0)
    total = np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS + 3))
    for _ in range(10):
        light = np.zeros((192, 192, 3)) + generator.random(3)
        for _ in range(60):
            color = tuple(0.02 + 0.9 * generator.random(3) ** 1.5)
            place = tuple(map(int, generator.integers(0, 192, 2)))
            cv2.circle(light, place, int(generator.integers(5, 40)), color, -1)
        light = cv2.GaussianBlur(light, (0, 0), float(generator.uniform(1.0, 4.0)))
        total += soft_edges_of(np.rint(255.0 * light ** (1.0 / power)).astype(np.uint8)).lines
    return total


@pytest.mark.parametrize("power", [1.0, 1.8, 2.2])
@pytest.mark.parametrize("size", [1, 2])
def test_colors_across_soft_edges_give_the_bend_of_the_response(power, size):
    """Of light as a power of codes, `e g'' / g'` is that power less one at every level."""
    number = SOFT_SIZES.index(size)
    profile = bend_profile(disks(power)[[number]])[: 2 * SOFT_LEVELS]
    bend, trust = 1.2 + profile[:SOFT_LEVELS], profile[SOFT_LEVELS:]
    assert (trust[2:7] > 0.9).all()
    assert bend[2:7] == pytest.approx(power - 1.0, abs=0.25)


def test_without_edges_the_bend_is_the_usual_one_and_not_trusted():
    nothing = np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS + 3))
    told = bend_profile(nothing).reshape(len(SOFT_SIZES) + 1, -1)
    assert not told[:, : 2 * SOFT_LEVELS + 1].any()
