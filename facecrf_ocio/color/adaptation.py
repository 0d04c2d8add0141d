"""CIE XYZ: from chromaticities, from RGB, and from one white to another by Bradford's matrix."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

XY = tuple[float, float]
Matrix = npt.NDArray[np.float64]

# From CIE XYZ to cones' responses (ICC.1:2022, annex E).
_CONES = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def xyz(xy: XY) -> Matrix:
    """Return x, y, z = 1 - x - y, which unlike X / Y has no pole at y = 0 (ACES blue is near)."""
    return np.array([xy[0], xy[1], 1.0 - xy[0] - xy[1]])


def white_xyz(xy: XY) -> Matrix:
    """Return X, Y, Z of a white whose Y is 1."""
    return np.asarray(xyz(xy) / xy[1])


def rgb_to_xyz(rgb: Sequence[XY], white: XY) -> Matrix:
    """Matrix (3, 3) from linear RGB to CIE XYZ, Y of white being 1 (SMPTE RP 177, sec. 3.3)."""
    columns = np.stack([xyz(xy) for xy in rgb], axis=1)
    return np.asarray(columns * np.linalg.solve(columns, white_xyz(white)))


def bradford(source: XY, target: XY) -> Matrix:
    """Matrix (3, 3) that adapts CIE XYZ from one white, given as xy, to another."""
    return adapted(white_xyz(source), white_xyz(target)) if source != target else np.eye(3)


def adapted(source: npt.ArrayLike, target: npt.ArrayLike) -> Matrix:
    """Bradford's matrix (3, 3) from one white's X, Y, Z to another's."""
    gains = (_CONES @ np.asarray(target)) / (_CONES @ np.asarray(source))
    return np.asarray(np.linalg.solve(_CONES, gains[:, None] * _CONES))
