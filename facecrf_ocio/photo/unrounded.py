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


def unrounded(jpeg: bytes, orientation: int) -> npt.NDArray[np.float32] | None:
    """(H, W, 3) code values in [0, 1], upright; None where the JPEG does not hold YCbCr.

    Rounding of RGB is half a code, which in the shadows is 3 % of the light.
    """
    from PIL import Image  # noqa: PLC0415 - only where a rendition is asked for

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # the photo was read before
        try:
            with Image.open(io.BytesIO(jpeg)) as picture:
                picture.draft("YCbCr", picture.size)
                if picture.mode != "YCbCr":
                    return None
                codes = np.asarray(picture)
        except (OSError, ValueError, Image.DecompressionBombError):
            return None
    result = np.empty(codes.shape, np.float32)
    for first in range(0, len(codes), _ROWS):
        part = codes[first : first + _ROWS] - _MIDDLE
        result[first : first + _ROWS] = np.clip(part @ _TO_RGB.T / np.float32(255), 0, 1)
    return np.asarray(upright(result, orientation), np.float32)
