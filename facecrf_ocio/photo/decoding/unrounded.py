"""A JPEG's color before it is rounded to 8 bits of red, green and blue."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import numpy.typing as npt

from facecrf_ocio.photo.decoding.orientation import upright
from facecrf_ocio.photo.raster.smoothed_colors import as_stored
from facecrf_ocio.photo.tags.unwarned import unwarned

# ITU-T T.871 (JFIF): from luma and two color differences, in codes, to red, green and blue.
_TO_RGB = np.array([[1.0, 0.0, 1.402], [1.0, -0.344136, -0.714136], [1.0, 1.772, 0.0]], np.float32)
_MIDDLE = np.array([0, 128, 128], np.float32)  # [code] of gray
_ROWS = 256  # converted at a time, so that what is between takes little memory
_HALVED = [(2, 2), (1, 1), (1, 1)]  # sampling of 4:2:0, which phones write
_HALVED_WIDTH = [(2, 1), (1, 1), (1, 1)]  # that of 4:2:2, which some cameras write


def unrounded(jpeg: bytes, orientation: int) -> npt.NDArray[np.float32] | None:
    """(H, W, 3) code values in [0, 1], upright; None where the JPEG does not hold YCbCr.

    Rounding of RGB is half a code, which in the shadows is 3 % of the light. Halved color
    differences stand for four pixels each (4:2:0) or two (4:2:2), as in libultrahdr; smoothed ones
    move a fifth of the pixels of a small, colorful photo by more than 1 % of their light.
    """
    codes = _ycbcr(jpeg)
    if codes is None:
        return None
    result = np.empty(codes.shape, np.float32)
    for first in range(0, len(codes), _ROWS):
        part = codes[first : first + _ROWS] - _MIDDLE
        result[first : first + _ROWS] = np.clip(part @ _TO_RGB.T / np.float32(255), 0, 1)
    return np.asarray(upright(result, orientation), np.float32)


def _ycbcr(jpeg: bytes) -> npt.NDArray[np.uint8] | None:
    """(H, W, 3) luma and color differences, in codes."""
    from PIL import Image  # noqa: PLC0415 - only where a rendition is asked for

    with unwarned():
        try:
            codes, sampling = _decoded(jpeg, 1)
            if codes is None or min(codes.shape[:2]) < 2:
                return codes
            if sampling == _HALVED_WIDTH:
                return _with_color(codes, _widths_undone(codes), 1)
            # Of half the size luma is made smaller, and color differences come as they are stored.
            stored = _decoded(jpeg, 2)[0] if sampling == _HALVED else None
        except (OSError, ValueError, Image.DecompressionBombError):
            return None
    return codes if stored is None else _with_color(codes, stored[..., 1:], 2)


def _decoded(jpeg: bytes, scale: int) -> tuple[npt.NDArray[np.uint8] | None, list[Any]]:
    """(H, W, 3) codes of a picture of full or half the size, and how its layers are sampled."""
    from PIL import Image  # noqa: PLC0415 - only where a rendition is asked for

    with Image.open(io.BytesIO(jpeg)) as picture:
        sampling = [tuple(layer[1:3]) for layer in getattr(picture, "layer", ())]
        picture.draft("YCbCr", (picture.width // scale, picture.height // scale))
        return (np.array(picture) if picture.mode == "YCbCr" else None), sampling


def _widths_undone(codes: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """(H, ceil(W / 2), 2) color differences as stored."""
    return np.stack([as_stored(codes[..., 1]), as_stored(codes[..., 2])], axis=2)


def _with_color(
    codes: npt.NDArray[np.uint8], stored: npt.NDArray[np.uint8], tall: int
) -> npt.NDArray[np.uint8]:
    """Codes whose color differences stand for two pixels of a row each, in one row or two."""
    repeated = stored.repeat(tall, axis=0).repeat(2, axis=1)
    codes[..., 1:] = repeated[: codes.shape[0], : codes.shape[1]]
    return codes
