"""Where the chart lies: corners that are given, or found by OpenCV's module `mcc`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.chart.reflectances import COLUMNS, ROWS
from facecrf_ocio.values import Float

_LEAST_SIDE = 32  # [px] a chart takes more, and its detector crashes on one row
_SIDE = 1000  # [px] long side at which the detector looks: patches of 10 to 150 px are found there
_HALF = 0.435  # of the distance between patches: half of a patch's width
# Outer corners of the patches, from the chart's upper left around.
_OUTER = (
    (-_HALF, -_HALF),
    (COLUMNS - 1 + _HALF, -_HALF),
    (COLUMNS - 1 + _HALF, ROWS - 1 + _HALF),
    (-_HALF, ROWS - 1 + _HALF),
)


def can_find() -> bool:
    """Whether the OpenCV that is installed has the detector."""
    return hasattr(cv2, "mcc")


def by_corners(corners_xy: npt.ArrayLike) -> Float:
    """(3, 3) homography from the chart's grid to pixels.

    Patches' centers lie at whole numbers, columns 0 to 5 along x and rows 0 to 3 along y.

    Parameters
    ----------
    corners_xy
        (4, 2) [px] outer corners of the four patches in the corners, one after the other around.
    """
    return _homography(_OUTER, corners_xy)


def turned(homography: Float) -> list[Float]:
    """The four homographies (3, 3) by which the grid may lie in those corners."""
    corners = _apply(homography, np.array(_OUTER))
    return [by_corners(np.roll(corners, step, axis=0)) for step in range(4)]


def find_chart(encoded: npt.NDArray[np.float32]) -> Float | None:
    """As `by_corners`, of the surest chart of 24 patches in a picture (H, W, 3), or None."""
    mcc: Any = getattr(cv2, "mcc", None)
    scale = min(1.0, _SIDE / max(encoded.shape[:2]))
    height, width = (round(scale * edge) for edge in encoded.shape[:2])
    if mcc is None or min(height, width) < _LEAST_SIDE:
        return None
    small = cv2.resize(encoded, (width, height), interpolation=cv2.INTER_AREA)
    detector = mcc.CCheckerDetector_create()
    detector.setColorChartType(mcc.MCC24)
    # The detector is asked for its chart only where it has one: it crashes otherwise.
    if not detector.process(np.ascontiguousarray(np.rint(small[..., ::-1] * 255), np.uint8), 1):
        return None
    patches = np.array(detector.getBestColorChecker().getColorCharts()).reshape(-1, 4, 2)
    corners = [(0, 0), (COLUMNS - 1, 0), (COLUMNS - 1, ROWS - 1), (0, ROWS - 1)]
    centers = [patches[row * COLUMNS + column].mean(axis=0) for column, row in corners]
    return _homography(corners, (np.array(centers) + 0.5) / scale)


def to_pixels(homography: Float, columns_rows: Float) -> Float:
    """(N, 2) pixels of places (N, 2) on the grid; centers of pixels lie at 0.5, 1.5, ..."""
    return _apply(homography, columns_rows)


def _homography(source: Sequence[tuple[float, float]], target: npt.ArrayLike) -> Float:
    return np.asarray(
        cv2.getPerspectiveTransform(np.array(source, np.float32), np.asarray(target, np.float32)),
        np.float64,
    )


def _apply(homography: Float, points: Float) -> Float:
    whole = np.column_stack([points, np.ones(len(points))]) @ homography.T
    return np.asarray(whole[:, :2] / whole[:, 2:])
