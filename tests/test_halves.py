"""Small copies of a photo: made once, and let go with it."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest

from facecrf_ocio.photo.raster.halves import halved, halved_part
from facecrf_ocio.photo.raster.pixels import Pixels


def photo_of(height: int, width: int, *, writeable: bool = False) -> Pixels:
    codes = np.random.default_rng(0).integers(0, 256, (height, width, 3), np.uint8)
    codes.flags.writeable = writeable
    return codes


@pytest.mark.parametrize("kind", [np.uint8, np.float32])
def test_each_pixel_is_the_mean_of_four(kind: type) -> None:
    pixels = photo_of(8, 12).astype(kind)
    means = pixels.astype(np.float64).reshape(4, 2, 6, 2, 3).mean(axis=(1, 3))
    assert np.abs(halved(pixels, 1) - means).max() <= 0.5
    assert halved(pixels, 1).dtype == kind


def test_an_odd_row_and_column_are_left_out() -> None:
    pixels = photo_of(9, 13)
    assert (halved(pixels, 1) == halved(pixels[:8, :12].copy(), 1)).all()
    assert halved(pixels, 3).shape == (1, 1, 3)


def test_a_photo_is_halved_once_for_all_who_look_at_it() -> None:
    pixels = photo_of(64, 64)
    assert halved(pixels, 2) is halved(pixels, 2)
    assert not halved(pixels, 2).flags.writeable


def test_what_may_be_written_to_is_halved_anew() -> None:
    pixels = photo_of(64, 64, writeable=True)
    before = halved(pixels, 2)
    pixels[:] = 0
    assert before.any()
    assert not halved(pixels, 2).any()


def test_another_photo_is_not_taken_for_the_last_one() -> None:
    first, second = photo_of(64, 64), photo_of(32, 32)
    halved(first, 2)
    assert halved(second, 2).shape == (8, 8, 3)


@pytest.mark.parametrize("kept", [0, 1, 2, 3])
@pytest.mark.parametrize("times", [0, 1, 2, 3])
def test_a_part_is_that_of_the_whole_whatever_is_kept(times: int, kept: int) -> None:
    pixels = photo_of(67, 93)
    part = slice(1, 7), slice(0, 11)
    whole = halved(pixels.copy(), times)
    halved(pixels, kept)
    found = halved_part(pixels, times, part)
    assert found.shape == (6, 11, 3)
    assert (found == whole[part]).all()


def test_nothing_is_kept_longer_than_the_photo() -> None:
    pixels = photo_of(64, 64)
    small = weakref.ref(halved(pixels, 2))
    assert small() is not None
    del pixels
    gc.collect()
    assert small() is None
