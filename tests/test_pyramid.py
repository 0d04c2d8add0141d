"""Smaller copies of a photo: the same averages, however they were made."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from facecrf_ocio.face.pyramid import Pyramid


def scene(height: int, width: int) -> npt.NDArray[np.uint8]:
    """(H, W, 3) codes of smooth shades with noise."""
    y, x = np.mgrid[:height, :width] / 90.0
    shades = 120 + 90 * np.sin(x)[..., None] * np.cos(y[..., None] + np.arange(3))
    noise = np.random.default_rng(0).normal(0, 4, (height, width, 3))
    return np.clip(np.rint(shades + noise), 0, 255).astype(np.uint8)


def shrunk(image: npt.NDArray[np.float32], width: int, height: int) -> npt.NDArray[np.float32]:
    return np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.float32)


@pytest.mark.parametrize("size", [(601, 803), (1281, 977), (3, 999), (1, 700)])
def test_levels_are_area_averages_of_what_they_cover(size: tuple[int, int]) -> None:
    codes = scene(*size)
    pyramid = Pyramid(codes, 320, 160, 80)
    for index in range(1, len(pyramid)):
        level, (x, y) = pyramid.level(index), pyramid.scale_xy(index)
        height, width = level.shape[:2]
        covered = codes[: round(height / y), : round(width / x)] / np.float32(255)
        plain = shrunk(covered, width, height)
        assert np.abs(level - plain).mean() < 1.5 / 255
        assert abs(float((level - plain).mean())) < 0.6 / 255  # each half rounds up by 1/8


def test_of_a_photo_no_larger_than_the_first_level_each_is_made_of_the_one_before() -> None:
    codes = scene(300, 200)
    pyramid = Pyramid(codes, 320, 160, 80)
    half = shrunk((codes / 255).astype(np.float32), 107, 160)
    assert np.array_equal(pyramid.level(1), half)
    assert np.array_equal(pyramid.level(2), shrunk(half, 54, 80))
    assert pyramid.level(0) is codes


def test_codes_and_encoded_values_give_the_same_levels_of_a_small_photo() -> None:
    codes = scene(300, 200)
    encoded = (codes / 255).astype(np.float32)
    assert np.array_equal(Pyramid(codes, 320, 160).level(1), Pyramid(encoded, 320, 160).level(1))


def test_the_level_for_a_step_is_the_smallest_that_is_fine_enough() -> None:
    pyramid = Pyramid(scene(640, 480), 320, 160)
    level, scale = pyramid.level_for(2.0)
    assert level.shape == (320, 240, 3)
    assert scale == pytest.approx([0.5, 0.5])
    assert pyramid.level_for(1.5)[0].shape == (640, 480, 3)
