"""Codes are scaled down to the means that OpenCV's area filter gives of floats."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from facecrf_ocio.face.area_means import area_means


@pytest.mark.parametrize(
    ("shape", "size_xy"),
    [
        ((1000, 800), (160, 200)),  # by whole numbers
        ((1003, 771), (163, 189)),
        ((97, 64), (64, 3)),
        ((40, 40), (40, 20)),
    ],
)
def test_are_those_of_the_area_filter(shape: tuple[int, int], size_xy: tuple[int, int]) -> None:
    photo = np.random.default_rng(1).integers(0, 256, (*shape, 4), dtype=np.uint8)
    codes = photo[..., :3]  # rows of a part of a photo do not follow one another
    expected = cv2.resize(codes / np.float32(255), size_xy, interpolation=cv2.INTER_AREA)
    found = area_means(codes, size_xy)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, expected, atol=2e-6)


def test_of_white_are_white() -> None:
    white = np.full((701, 333, 3), 255, np.uint8)
    np.testing.assert_allclose(area_means(white, (31, 67)), 1.0, atol=1e-6)
