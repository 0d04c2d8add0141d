"""A few code values of a photo, at fixed points: enough to recognize and solve a bracket."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.photo.raster.pixels import Pixels, code_values

ROWS, COLUMNS = 24, 32  # of the grid of points
_PATCH = 5  # [px] side of the square whose mean is taken: less noise, and still nearly one color

Samples = npt.NDArray[np.uint8]


def take_samples(pixels: Pixels) -> bytes:
    """Mean code values around the centers of a grid of cells.

    Parameters
    ----------
    pixels
        (H, W, 3) in [0, 1], or of 8 bits.

    Returns
    -------
    bytes
        24 x 32 x 3 values of 8 bits, row by row.
    """
    height, width = pixels.shape[:2]
    rows = _centers(height, ROWS)
    columns = _centers(width, COLUMNS)
    around = np.arange(_PATCH) - _PATCH // 2
    near_rows = np.clip(rows[:, None] + around, 0, height - 1).ravel()
    near_columns = np.clip(columns[:, None] + around, 0, width - 1).ravel()
    patches = code_values(pixels[np.ix_(near_rows, near_columns)], 8)
    means = cv2.resize(patches, (COLUMNS, ROWS), interpolation=cv2.INTER_AREA)
    return bytes(np.rint(means * 255.0).astype(np.uint8).tobytes())


def read_samples(stored: bytes) -> Samples:
    """(768, 3) code values that `take_samples` stored."""
    return np.frombuffer(stored, np.uint8).reshape(ROWS * COLUMNS, 3)


def _centers(size: int, count: int) -> npt.NDArray[np.intp]:
    return ((np.arange(count) + 0.5) * size / count).astype(np.intp)
