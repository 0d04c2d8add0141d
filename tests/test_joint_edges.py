"""Edges: where the middle of a blurred step lies tells how the curve bends between its sides."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from facecrf_ocio.joint.edge_counts import EDGE_LEVELS
from facecrf_ocio.joint.edges import edge_profile
from facecrf_ocio.joint.noise_counts import count_noise

PAIRS = EDGE_LEVELS * (EDGE_LEVELS - 1) // 2


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
