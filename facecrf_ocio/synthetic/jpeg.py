"""Code values as a JPEG file gives them back."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import SettingsError

Codes = npt.NDArray[np.uint8]
SAMPLING = {
    "4:2:0": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420,
    "4:2:2": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_422,
    "4:4:4": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444,
}
"""How color can be sampled; 4:2:0 is what libjpeg does where nothing is said."""


def jpeg_of(codes: Codes, quality: int, sampling: str = "4:2:0") -> bytes:
    """Return the file of (H, W, 3) code values, at a quality of 1 to 100.

    Raises
    ------
    SettingsError
        If JPEG cannot hold such an image.
    """
    options = (
        *(cv2.IMWRITE_JPEG_QUALITY, quality),
        *(cv2.IMWRITE_JPEG_SAMPLING_FACTOR, SAMPLING[sampling]),
    )
    written, content = cv2.imencode(".jpg", np.ascontiguousarray(codes[..., ::-1]), options)
    if not written:
        raise SettingsError(f"an image of shape {codes.shape} cannot be stored as a JPEG")
    return content.tobytes()


def codes_of(content: bytes) -> Codes:
    """Return the (H, W, 3) code values of a JPEG file."""
    codes = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR)
    return np.ascontiguousarray(np.asarray(codes, np.uint8)[..., ::-1])


def through_jpeg(codes: Codes, quality: int, sampling: str = "4:2:0") -> Codes:
    """Return (H, W, 3) code values as they come back from a file."""
    return codes_of(jpeg_of(codes, quality, sampling))
