"""Points around which irradiance seems to be a plane, for the geometry invariants of GICRF.

Derivatives come from a polynomial of fourth degree in x and y, fitted to square windows of several
sizes. See `geometry_invariant` for what they are used for, and for the source.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from facecrf_ocio.values import Float

# [px] small for steep ramps, large for slow ones, which drown in 8-bit steps.
HALF_WIDTHS = (2, 3, 5, 10, 15)
# Windows of one size in one channel, and rows of them held in memory at once.
MAX_WINDOWS = 60_000
BAND = 64  # rows of windows
DEGREE = 4  # of the polynomial in x and in y; less in the smallest window

CODE = 1.0 / 255.0  # [encoded] one 8-bit code
# [encoded] nearer to black or white, pixels are clipped.
MIN_CODE, MAX_CODE = 2.0 * CODE, 1.0 - 2.0 * CODE
# Below, a window sees the steps of the curve's table; above, no polynomial follows the curve.
MIN_SPAN, MAX_SPAN = 4.0 * CODE, 0.25
# A window with an edge in it spans about 10 times its residual.
SPAN_TO_NOISE = 30.0
# Largest standard deviation of the invariant, and its largest part along the isophote.
MAX_DEVIATION = 1.0
PLANAR_ERROR = 0.05  # of the invariant


@dataclass(frozen=True, slots=True, eq=False)
class PlanarPoints:
    """Points of one channel around which irradiance seems to be a plane.

    Attributes
    ----------
    encoded
        (N,) code values.
    invariant
        (N,) `I G = 1 - 1 / Q`: 0 for a linear response, `1 - 1 / gamma` for a power.
    deviation
        (N,) standard deviation of `invariant` from the noise in its window.
    share
        (N,) part of its window that no neighboring window has seen, (0, 1].
    """

    encoded: Float
    invariant: Float
    deviation: Float
    share: Float


def planar_points(plane: Float, rounding: float) -> PlanarPoints:
    """Points of one channel (H, W) whose derivatives satisfy the equality constraint.

    Parameters
    ----------
    plane
        (H, W) encoded values.
    rounding
        Standard deviation of the rounding to integer codes, encoded.
    """
    found = [
        _share_repetitions(_planar_in_windows(plane, half, _step(plane, half), rounding))
        for half in HALF_WIDTHS
        if min(plane.shape) > 2 * half
    ]
    empty = PlanarPoints(*np.zeros((4, 0)))
    return joined([empty, *found])


def joined(parts: Sequence[PlanarPoints]) -> PlanarPoints:
    """All points of several lists in one."""
    return PlanarPoints(
        np.concatenate([p.encoded for p in parts]),
        np.concatenate([p.invariant for p in parts]),
        np.concatenate([p.deviation for p in parts]),
        np.concatenate([p.share for p in parts]),
    )


def _step(plane: Float, half: int) -> int:
    """Distance of windows: a third of their half width, more where the photo is large."""
    return max(-(-half // 3), int(np.ceil(np.sqrt(plane.size / MAX_WINDOWS))))


def _planar_in_windows(plane: Float, half: int, step: int, rounding: float) -> PlanarPoints:
    width = 2 * half + 1
    starts = np.arange(0, plane.shape[0] - width + 1, step)
    rows = starts[:, None] + np.arange(width)
    return joined(
        [
            _planar_in_band(plane[rows[first : first + BAND]], half, step, rounding)
            for first in range(0, len(rows), BAND)
        ]
    )


def _planar_in_band(windows: Float, half: int, step: int, rounding: float) -> PlanarPoints:
    """Fit a polynomial to every window of a band, and keep those that may show a plane.

    Parameters
    ----------
    windows
        (B, 2 half + 1, W) the rows around each row of window centers.
    half, step
        [px] Half width and distance of windows.
    rounding
        As in `planar_points`.
    """
    width = 2 * half + 1
    basis, at_center = _polynomials(half)
    rows = windows.astype(np.float64)
    columns = np.arange(0, windows.shape[2] - width + 1, step)[:, None] + np.arange(width)
    fitted = (basis.T @ rows)[:, :, columns] @ basis
    squares = np.einsum("bhw,bhw->bw", rows, rows)[:, columns].sum(axis=-1)
    residual = squares - np.einsum("bicj,bicj->bc", fitted, fitted)
    noise = np.sqrt(np.maximum(residual, 0.0) / (width**2 - basis.shape[1] ** 2))
    noise = np.maximum(noise, max(rounding, 1e-9))
    # Orders of the derivatives by y and by x.
    orders = ((0, 0), (0, 1), (1, 0), (0, 2), (1, 1), (2, 0))
    readers = np.array([np.kron(at_center[by_y], at_center[by_x]) for by_y, by_x in orders])
    readers = readers.reshape(len(orders), *at_center.shape[1:] * 2)
    encoded, i_x, i_y, i_xx, i_xy, i_yy = np.einsum("bicj,nij->nbc", fitted, readers, optimize=True)
    square = np.maximum(i_x**2 + i_y**2, 1e-30)
    i_ww = (i_x**2 * i_xx + 2.0 * i_x * i_y * i_xy + i_y**2 * i_yy) / square
    i_uu = (i_y**2 * i_xx - 2.0 * i_x * i_y * i_xy + i_x**2 * i_yy) / square
    i_uw = (i_x * i_y * (i_yy - i_xx) + (i_x**2 - i_y**2) * i_xy) / square
    gain = float(np.linalg.norm(at_center[2]) * np.linalg.norm(at_center[0]))
    # Pixels that share a code share their rounding error: it does not average out among them.
    alike = np.maximum(1.0, rounding * 12.0**0.5 / np.sqrt(square))
    alike = 1.0 + (alike - 1.0) * (rounding / noise) ** 2
    deviation = encoded * gain * alike * noise / square
    error = encoded * np.sqrt(i_uu**2 + 2.0 * i_uw**2) / square
    span = np.sqrt(square) * width
    keep = (
        (encoded > MIN_CODE)
        & (encoded < MAX_CODE)
        & (span > np.maximum(MIN_SPAN, SPAN_TO_NOISE * noise))
        & (span < MAX_SPAN)
        & (deviation < MAX_DEVIATION)
        & (error < PLANAR_ERROR + 3.0 * deviation)
    )
    return PlanarPoints(
        encoded[keep],
        (encoded * i_ww / square)[keep],
        deviation[keep],
        np.full(int(keep.sum()), min(1.0, (step / width) ** 2)),
    )


def _share_repetitions(points: PlanarPoints) -> PlanarPoints:
    """Windows that repeat each other exactly, as on a ramp along rows of pixels, share one vote."""
    _, group, count = np.unique(
        np.round(points.invariant, 9), return_inverse=True, return_counts=True
    )
    return replace(points, share=points.share / count[group])


def _polynomials(half: int) -> tuple[Float, Float]:
    """Orthonormal polynomials on a window, and rows that give value and derivatives at its center.

    Returns
    -------
    tuple
        Basis (width, D), and (3, D): value, first and second derivative per pixel.
    """
    degree = min(DEGREE, 2 * half - 1)
    offsets = np.arange(-half, half + 1) / half
    basis, triangle = np.linalg.qr(np.vander(offsets, degree + 1, increasing=True))
    powers = np.linalg.inv(triangle)
    return basis, np.stack([powers[0], powers[1] / half, 2.0 * powers[2] / half**2])
