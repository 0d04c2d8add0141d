"""Color differences as stored are found again behind the smoothing of a JPEG's decoder."""

from __future__ import annotations

from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from facecrf_ocio.photo.raster.smoothed_colors import as_stored


def smoothed(stored: np.ndarray) -> np.ndarray:
    """As libjpeg does it (jdsample.c, h2v1_fancy_upsample)."""
    wide = np.pad(stored.astype(int), ((0, 0), (1, 1)), mode="edge")
    left = (3 * wide[:, 1:-1] + wide[:, :-2] + 1) // 4
    right = (3 * wide[:, 1:-1] + wide[:, 2:] + 2) // 4
    return np.stack([left, right], axis=2).reshape(len(stored), -1).astype(np.uint8)


@pytest.mark.parametrize("spread", [1, 10, 80])
@pytest.mark.parametrize("count", [3, 4, 37, 300])
@pytest.mark.parametrize("cut", [0, 1])
def test_every_code_is_found(spread: float, count: int, cut: int) -> None:
    noise = np.random.default_rng(count).normal(128, spread, (60, count))
    stored = np.clip(noise, 0, 255).astype(np.uint8)
    found = as_stored(smoothed(stored)[:, : 2 * count - cut])
    assert (found == stored).all()


def test_the_decoder_smooths_as_told_here() -> None:
    codes = np.random.default_rng(0).integers(0, 256, (48, 96, 3)).astype(np.uint8)
    out = BytesIO()
    Image.fromarray(codes).save(out, "JPEG", quality=95, subsampling="4:2:2")
    with Image.open(out) as picture:
        picture.draft("YCbCr", picture.size)
        decoded = np.array(picture)[..., 1]
    assert (smoothed(as_stored(decoded)) == decoded).all()


@pytest.mark.parametrize("width", [1, 2, 3, 4])
def test_what_is_too_narrow_to_be_smoothed_is_halved(width: int) -> None:
    codes = np.repeat(np.arange(1, 3, dtype=np.uint8), 2)[None, :width].repeat(5, axis=0)
    assert (as_stored(codes) == codes[:, ::2]).all()
