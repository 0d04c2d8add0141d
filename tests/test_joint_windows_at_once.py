"""Windows are counted several at once: as they are one by one."""

from __future__ import annotations

from dataclasses import fields

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from facecrf_ocio.joint.noise_counts import NoiseCounts, count_noise


def windows(seed: int) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Up to eight windows of three shapes, smooth and rough ones, and masks."""
    generator = np.random.default_rng(seed)
    shapes = [(int(h), int(w)) for h, w in generator.integers(5, 70, (3, 2))]
    shapes[0] = (shapes[0][0], shapes[0][0])
    chosen = sorted(generator.integers(0, 3, generator.integers(1, 9)).tolist())
    codes = []
    for number in chosen:
        noise = generator.normal(size=(*shapes[number], 3))
        smooth = cv2.GaussianBlur(noise, (0, 0), generator.uniform(0.5, 3.0))
        values = generator.uniform(60, 200) + generator.uniform(5, 90) * smooth / smooth.std()
        codes.append(values.clip(0, 255).astype(np.uint8))
    return codes, [generator.random(one.shape[:2]) < 0.8 for one in codes]


def require_same(found: NoiseCounts, expected: NoiseCounts) -> None:
    for item in fields(NoiseCounts):
        here, there = getattr(found, item.name), getattr(expected, item.name)
        assert here == pytest.approx(there, rel=1e-9, abs=1e-9), item.name


def one_by_one(
    codes: list[np.ndarray], masks: list[np.ndarray] | None, weights: list[float]
) -> NoiseCounts:
    parts = [
        count_noise([one], None if masks is None else [masks[number]], [weights[number]])
        for number, one in enumerate(codes)
    ]
    total = parts[0]
    for part in parts[1:]:
        total = total.plus(part)
    return total


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_several_windows_count_as_one_by_one(seed: int, masked: bool) -> None:
    codes, masks = windows(seed)
    chosen = masks if masked else None
    require_same(count_noise(codes, chosen), one_by_one(codes, chosen, [1.0] * len(codes)))


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_windows_of_several_weights_count_as_one_by_one(seed: int) -> None:
    codes, masks = windows(seed)
    weights = np.random.default_rng(seed).choice([1.0, 2.5], len(codes)).tolist()
    require_same(count_noise(codes, masks, weights), one_by_one(codes, masks, weights))


def test_where_one_window_ends_and_the_next_begins_nothing_is_seen() -> None:
    # Plain ones of several levels, beside each other: no difference, and no edge.
    plain = [np.full((64, 64, 3), level, np.uint8) for level in (40, 200, 90)]
    counts = count_noise(plain)
    assert not counts.edges.any()
    assert not counts.soft_edges.any()
    assert not counts.blocks[..., 0].any()
    assert not counts.histograms[..., 1:].any()
    assert counts.histograms[0].sum(axis=(1, 2)).tolist() == [3.0 * 62 * 62] * 3
