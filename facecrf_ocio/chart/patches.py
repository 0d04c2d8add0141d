"""What each patch of the chart shows: its code values, how sure they are, and how they slope."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.chart.find_chart import to_pixels
from facecrf_ocio.chart.reflectances import COLUMNS, ROWS
from facecrf_ocio.response.robust import robust_deviation
from facecrf_ocio.values import Bool, Float

_INNER = 0.25  # of the distance between patches: half of the square that is looked at
_FEWEST = 16  # [px] of a patch
_FAR = 3.0  # standard deviations beyond which a pixel is dust or a glint
_CLIPPED = (2.0 / 255.0, 250.0 / 255.0)  # [encoded] below and above, codes are cut off
_MOST_CLIPPED = 0.02  # share of a patch's pixels
_ALIKE = 9.0  # [px] that share their noise: JPEG's chroma, demosaicing and noise reduction
_LEAST = 0.3 / 255.0  # [encoded] of a mean: rounding of a patch without noise


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """The 24 patches.

    Attributes
    ----------
    mean, deviation
        (24, 3) code values in [0, 1], and the standard deviations of these means.
    slope, slope_deviation
        (24, 3, 2) change of the code value from one column, and one row, to the next, within the
        patch.
    usable
        (24, 3) neither clipped nor drowned.
    """

    mean: Float
    deviation: Float
    slope: Float
    slope_deviation: Float
    usable: Bool


def glance(encoded: npt.NDArray[np.float32], homography: Float) -> Float | None:
    """(24, 3) median of 25 pixels of every patch; None if some patch lies outside."""
    step = np.linspace(-_INNER, _INNER, 5)
    across, down = (part.ravel() for part in np.meshgrid(step, step))
    rows, columns = np.divmod(np.arange(ROWS * COLUMNS), COLUMNS)
    places = np.stack([columns[:, None] + across, rows[:, None] + down], axis=2)
    pixels = np.floor(to_pixels(homography, places.reshape(-1, 2)))
    if not ((pixels >= 0) & (pixels < encoded.shape[1::-1])).all():
        return None
    x, y = pixels.astype(np.intp).T
    codes = np.asarray(encoded[y, x], np.float64).reshape(ROWS * COLUMNS, -1, 3)
    return np.asarray(np.median(codes, axis=1))


def measure_patches(encoded: npt.NDArray[np.float32], homography: Float) -> Patches | None:
    """Look at the middle of every patch of a picture (H, W, 3), where a homography (3, 3) has it.

    None if some patch lies outside or has too few pixels.
    """
    back = np.linalg.inv(homography)
    found = []
    for row in range(ROWS):
        for column in range(COLUMNS):
            inside = _pixels(encoded, homography, back, np.array([column, row], float))
            if inside is None:
                return None
            found.append(_plane(*inside))
    return Patches(*(np.array(part) for part in zip(*found, strict=True)))


def _pixels(
    encoded: npt.NDArray[np.float32], homography: Float, back: Float, center: Float
) -> tuple[Float, Float] | None:
    """(N, 3) code values and (N, 2) places around the center, on the grid, of one patch."""
    square = center + _INNER * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    corners = to_pixels(homography, square) - 0.5
    low, high = np.floor(corners.min(axis=0)), np.ceil(corners.max(axis=0)) + 1
    height, width = encoded.shape[:2]
    if not np.isfinite(corners).all() or (low < 0).any() or (high > (width, height)).any():
        return None
    (left, top), (right, bottom) = low.astype(int), high.astype(int)
    mask = np.zeros((bottom - top, right - left), np.uint8)
    cv2.fillConvexPoly(mask, np.rint(corners - low).astype(np.int32), 1)
    y, x = np.nonzero(mask)
    if len(x) < _FEWEST:
        return None
    places = to_pixels(back, np.column_stack([x + left, y + top]) + 0.5) - center
    return np.asarray(encoded[top:bottom, left:right][y, x], np.float64), places


def _plane(codes: Float, places: Float) -> tuple[Float, Float, Float, Float, Bool]:
    """A plane through codes (N, 3) at places (N, 2) without glints and dust: a row of `Patches`."""
    design = np.column_stack([np.ones(len(places)), places])
    rows = []
    for channel in range(3):
        kept = np.ones(len(codes), np.bool_)
        for _ in range(2):
            plane, *_ = np.linalg.lstsq(design[kept], codes[kept, channel], rcond=None)
            away = codes[:, channel] - design @ plane
            spread = robust_deviation(away[kept]) + 0.5 / 255.0
            kept = np.abs(away) < _FAR * spread
        noise = float(away[kept].std())
        alike = noise**2 * _ALIKE * np.diagonal(np.linalg.inv(design[kept].T @ design[kept]))
        rows.append((plane, np.sqrt(alike + _LEAST**2)))
    planes, deviations = (np.array(part) for part in zip(*rows, strict=True))
    clipped = ((codes < _CLIPPED[0]) | (codes > _CLIPPED[1])).mean(axis=0)
    usable = clipped <= _MOST_CLIPPED
    return planes[:, 0], deviations[:, 0], planes[:, 1:], deviations[:, 1:], usable
