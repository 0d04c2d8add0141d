"""A JPEG's color before it is rounded to 8 bits of red, green and blue."""

from __future__ import annotations

import io
import warnings

import numpy as np
import numpy.typing as npt

from facecrf_ocio.photo.orientation import upright

# ITU-T T.871 (JFIF): from luma and two color differences, in codes, to red, green and blue.
_TO_RGB = np.array([[1.0, 0.0, 1.402], [1.0, -0.344136, -0.714136], [1.0, 1.772, 0.0]], np.float32)
_MIDDLE = np.array([0, 128, 128], np.float32)  # [code] of gray
_ROWS = 256  # converted at a time, so that what is between takes little memory
_HALVED = [(2, 2), (1, 1), (1, 1)]  # sampling of 4:2:0, which phones write


def unrounded(jpeg: bytes, orientation: int) -> npt.NDArray[np.float32] | None:
    """(H, W, 3) code values in [0, 1], upright; None where the JPEG does not hold YCbCr.

    Rounding of RGB is half a code, which in the shadows is 3 % of the light. Halved color
    differences (4:2:0) stand for four pixels each, as in libultrahdr; smoothed ones move a fifth
    of the pixels of a small, colorful photo by more than 1 % of their light.
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

    def decoded(scale: int) -> npt.NDArray[np.uint8] | None:
        with Image.open(io.BytesIO(jpeg)) as picture:
            layers = getattr(picture, "layer", ())
            halved = [tuple(layer[1:3]) for layer in layers] == _HALVED
            picture.draft("YCbCr", (picture.width // scale, picture.height // scale))
            usable = picture.mode == "YCbCr" and (scale == 1 or halved)
            return np.array(picture) if usable else None

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # the photo was read before
        try:
            codes = decoded(1)
            # Of half the size luma is made smaller, and color differences come as they are stored.
            stored = None if codes is None or min(codes.shape[:2]) < 2 else decoded(2)
        except (OSError, ValueError, Image.DecompressionBombError):
            return None
    if codes is not None and stored is not None:
        repeated = stored[..., 1:].repeat(2, axis=0).repeat(2, axis=1)
        codes[..., 1:] = repeated[: codes.shape[0], : codes.shape[1]]
    return codes
