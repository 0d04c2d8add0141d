"""Second differences, counted many at once, beside counting one pixel after another."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from facecrf_ocio.joint.noise_counts import count_noise
from facecrf_ocio.joint.second_differences import LAGS, LEVELS, RESIDUES, SecondDifferences
from facecrf_ocio.joint.soft_edges import CHANNEL_PAIRS


def a_window(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Codes of all sizes of differences, with clipped parts, and a mask."""
    generator = np.random.default_rng(seed)
    height, width = generator.integers(6, 20, 2)
    smooth = cv2.GaussianBlur(generator.normal(size=(height, width, 3)), (0, 0), 2.0)
    values = 120.0 + generator.uniform(20, 150) * smooth / smooth.std()
    values += generator.uniform(0, 40) * generator.normal(size=values.shape)
    return values.clip(0, 255).astype(np.uint8), generator.random((height, width)) < 0.8


def one_after_another(
    codes: np.ndarray, mask: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Histograms, pairs and lags of the size as stored."""
    histograms, signs, levels = each_pixel(codes, mask)
    return histograms, *beside_each_other(signs, levels)


def each_pixel(codes: np.ndarray, mask: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Histograms, signs of second differences, and levels."""
    height, width, _ = codes.shape
    signs = np.zeros((height, width, 3), int)
    levels = np.zeros((height, width, 3), int)
    histograms = np.zeros((3, LEVELS, RESIDUES.size))
    for row in range(1, height - 1):
        for column in range(1, width - 1):
            for channel in range(3):
                nine = codes[row - 1 : row + 2, column - 1 : column + 2, channel].astype(int)
                second = int(nine[::2, ::2].sum() + 4 * nine[1, 1])
                second -= int(2 * (nine[::2, 1].sum() + nine[1, ::2].sum()))
                level = nine.sum() * LEVELS // (9 * 255 + 1)
                levels[row, column, channel] = level
                if mask[row, column] and nine.min() > 0 and nine.max() < 255:
                    signs[row, column, channel] = np.sign(second)
                    place = np.searchsorted(RESIDUES, abs(second), side="right") - 1
                    histograms[channel, level, place] += 1
    return histograms, signs, levels


def beside_each_other(signs: np.ndarray, levels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How often signs agree and differ: between channels, and between neighbors."""
    height, width, _ = signs.shape
    pairs, lags = np.zeros((3, 2, LEVELS)), np.zeros((len(LAGS), 2, LEVELS))
    for row in range(height):
        for column in range(width):
            here, level = signs[row, column], levels[row, column, 1]
            for number, (one, other) in enumerate(CHANNEL_PAIRS):
                product = here[one] * here[other]
                pairs[number, :, level] += (product > 0, product < 0)
            for number, distance in enumerate(LAGS):
                for down, right in distance:
                    if row + down < height and column + right < width:
                        product = here[1] * signs[row + down, column + right, 1]
                        lags[number, :, level] += (product > 0, product < 0)
    return pairs, lags


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_second_differences_are_counted_as_one_pixel_after_another(seed: int) -> None:
    codes, mask = a_window(seed)
    counts = count_noise([codes], [mask])
    histograms, pairs, lags = one_after_another(codes, mask)
    assert counts.histograms[0] == pytest.approx(histograms)
    assert counts.pairs[0] == pytest.approx(pairs)
    assert counts.lags == pytest.approx(lags)


@pytest.mark.parametrize("white", [255, 4 * 255, 16 * 255])
def test_every_sum_of_nine_pixels_has_its_level(white: int) -> None:
    sums = np.arange(9 * white + 1)
    windows = (sums[:, None] + np.arange(9)) // 9  # as even as can be
    planes = np.tile(windows.reshape(-1, 3, 3), (3, 1, 1, 1))
    planes = planes.astype(np.uint8 if white == 255 else np.int16)
    found = SecondDifferences.of(planes, white, None).level[:, :, 1, 1]
    np.testing.assert_array_equal(found, np.tile(sums * LEVELS // (9 * white + 1), (3, 1)))
