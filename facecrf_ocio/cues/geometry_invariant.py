"""The rival GICRF: geometry invariants at locally planar irradiance points.

T.-T. Ng, S.-F. Chang, M.-P. Tsui, "Using Geometry Invariants for Camera Response Function
Estimation", CVPR 2007. Where irradiance R is locally a plane, its second derivatives vanish and
those of the photo I = f(R) come from the response alone, whatever the plane's direction and slope:

    I_xx / I_x^2 = I_yy / I_y^2 = I_xy / (I_x I_y) = f'' / f'^2 = -g'' / g' =: G(I)

`Q = 1 / (1 - I G)` is the exponent of f where f is a gamma curve. The equalities, written in the
direction u along the isophote and w across it, say I_uu = I_uw = 0: isophotes are straight and
evenly spaced. `G = I_ww / I_w^2` gives `log g'` by integration, and its constants are fixed by
g(0) = 0 and g(1) = 1: with planes at every code nothing stays open.

Kept from the paper: one channel at a time; derivatives from local polynomials; the equality
constraint as a test with its error relative to G; the distribution of the invariant given I,
reduced to its mode at each I. What differs, and why:

- The paper tells planes from other surfaces with straight isophotes (blurred edges) by a Bayesian
  classifier trained on labeled photos that are not available. In its place stand tests that need
  no training: the polynomial must fit the window, the window must span enough codes, and the mode
  at each code ignores the minority.
- Windows of five sizes in place of one: second derivatives of slow ramps drown in 8-bit steps in
  small windows, and steep ramps are no polynomial in large ones.
- The paper's generalized gamma curve f(R) = R^(a0 + a1 R + ...) cannot follow the S-shaped
  curves of film: with five parameters, fitted to planes without noise, its error is still 2 to 4 %.
  The log slopes of `energy.log_slope` take its place; they increase always, and the response
  model continues the curve where the photo shows no plane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.cues.evidence import Answer, FittedCurve, Lacking
from facecrf_ocio.energy.log_slope import (
    CENTERS,
    INTERVALS,
    LogSlopePrior,
    curve_of,
    log_slope_prior,
)
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import CHANNELS, Float, Photo

HALF_WIDTHS = (2, 3, 5, 10, 15)
MAX_WINDOWS = 60_000
BAND = 64
DEGREE = 4

CODE = 1.0 / 255.0
MIN_CODE, MAX_CODE = 4.0 * CODE, 1.0 - 4.0 * CODE
MIN_SPAN, MAX_SPAN = 8.0 * CODE, 0.25
SPAN_TO_NOISE = 30.0
MAX_DEVIATION = 1.0
PLANAR_ERROR = 0.05

MIN_POINTS = 20
MIN_LEVELS = INTERVALS // 4
MODEL_DEVIATION = 0.05
MODE_TO_SPREAD = 0.5
FEW_WINDOWS = 5.0
MAX_SURPRISE = 4.0
SUMMARY_SIZE = 256


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


@dataclass(frozen=True, slots=True, eq=False)
class Levels:
    """The invariant at each edge between two intervals of code values that shows planes.

    Attributes
    ----------
    edge
        (L,) whole numbers from 1 to INTERVALS - 1.
    invariant, deviation
        (L,) its mode and standard deviation.
    windows
        (L,) number of independent windows behind it.
    """

    edge: Float
    invariant: Float
    deviation: Float
    windows: Float


def geometry_invariant_cue(photo: Photo, model: ResponseModel, settings: Settings) -> Answer:
    """Find planar irradiance, read the invariant at each code, and integrate it to a curve."""
    step = CODE if photo.bit_depth is None else 1.0 / (2**photo.bit_depth - 1)
    rounding = 0.0 if photo.bit_depth is None else step / np.sqrt(12.0)
    points = [planar_points(np.ascontiguousarray(photo.encoded[:, :, c]), rounding) for c in range(len(CHANNELS))]
    if settings.shared_curve:
        points = [_join(points)] * len(CHANNELS)
    levels = [invariant_levels(p) for p in points]
    fewest = min(len(found.edge) for found in levels)
    if fewest < MIN_LEVELS:
        return Lacking(
            f"smooth ramps of light were found at {fewest} of {INTERVALS - 1} brightness levels "
            f"({MIN_LEVELS} are needed)",
            "use a larger or less noisy photo with soft shading, or --fallback mean",
        )
    prior = log_slope_prior(model)
    quantiles = np.linspace(0.0, 1.0, SUMMARY_SIZE)
    return FittedCurve(
        np.array([curve_from_invariants(found, prior, model.grid) for found in levels]),
        np.array([np.quantile(p.encoded, quantiles) for p in points]).T,
        f"{min(p.encoded.size for p in points)} locally planar points per channel "
        f"at {fewest} brightness levels",
    )


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
        _planar_in_windows(plane, half, _step(plane, half), rounding)
        for half in HALF_WIDTHS
        if min(plane.shape) > 2 * half
    ]
    empty = PlanarPoints(*np.zeros((4, 0)))
    return _join([empty, *found])


def invariant_levels(points: PlanarPoints) -> Levels:
    """Mode of the invariant at each edge between intervals, from the points around it."""
    order = np.argsort(points.encoded, kind="stable")
    position = points.encoded[order] * INTERVALS
    found = []
    for edge in range(1, INTERVALS):
        first, last = np.searchsorted(position, (edge - 0.5, edge + 0.5))
        if last - first >= MIN_POINTS:
            near = order[first:last]
            variance = points.deviation[near] ** 2 + MODEL_DEVIATION**2
            mode, deviation = _mode_at_zero(
                position[first:last] - edge,
                points.invariant[near],
                1.0 / variance,
                points.share[near],
            )
            # Spread beyond the noise comes from curved light, which also shifts the mode.
            spread = 1.4826 * np.median(np.abs(points.invariant[near] - mode))
            excess = np.sqrt(max(spread**2 - np.median(variance), 0.0))
            deviation = float(np.hypot(deviation, MODE_TO_SPREAD * excess))
            found.append((edge, mode, deviation, float(points.share[near].sum())))
    return Levels(*np.array(found, dtype=np.float64).reshape(-1, 4).T)


def curve_from_invariants(levels: Levels, prior: LogSlopePrior, grid: Float) -> Float:
    """Integrate `d log g' = -G dI` from interval to interval; samples (K,) on the grid (K,).

    A level seen by few windows, which may all lie on one surface that is no plane, is dropped
    where it contradicts the other levels.
    """
    above = levels.edge.astype(np.intp)
    spacing = np.log(CENTERS[above] / CENTERS[above - 1])
    rows = np.zeros((above.size, INTERVALS))
    rows[np.arange(above.size), above] = 1.0
    rows[np.arange(above.size), above - 1] = -1.0
    values = -levels.invariant * spacing
    deviation = np.hypot(levels.deviation, MODEL_DEVIATION) * spacing
    keep = np.arange(above.size)
    while True:
        surprise = np.abs(prior.surprise(rows[keep], values[keep], deviation[keep]))
        surprise[levels.windows[keep] >= FEW_WINDOWS] = 0.0
        if surprise.max() <= MAX_SURPRISE:
            break
        keep = np.delete(keep, np.argmax(surprise))
    return curve_of(prior.condition(rows[keep], values[keep], deviation[keep]), grid)


def _step(plane: Float, half: int) -> int:
    """Distance of windows: a third of their half width, more where the photo is large."""
    return max(-(-half // 3), int(np.ceil(np.sqrt(plane.size / MAX_WINDOWS))))


def _planar_in_windows(plane: Float, half: int, step: int, rounding: float) -> PlanarPoints:
    width = 2 * half + 1
    starts = np.arange(0, plane.shape[0] - width + 1, step)
    rows = starts[:, None] + np.arange(width)
    return _join(
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
    noise = np.maximum(noise, rounding)
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
    deviation = encoded * gain * noise / square
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
    share = min(1.0, (step / width) ** 2)
    return PlanarPoints(
        encoded[keep],
        (encoded * i_ww / square)[keep],
        deviation[keep],
        np.full(int(keep.sum()), share),
    )


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


def _mode_at_zero(
    offset: Float, value: Float, weight: Float, share: Float
) -> tuple[float, float]:
    """Mode of `value` where `offset` is 0, by a robust line, and its standard deviation.

    Tukey's biweight from the weighted median on: a minority of other surfaces has no influence.
    """
    order = np.argsort(value, kind="stable")
    cumulative = np.cumsum(weight[order])
    mode = float(value[order][np.searchsorted(cumulative, cumulative[-1] / 2.0)])
    slope, scale, trusted, middle, spread = 0.0, 1.0, weight, 0.0, 1.0
    for _ in range(20):
        residual = (value - mode - slope * offset) * np.sqrt(weight)
        scale = max(1.4826 * float(np.median(np.abs(residual))), 1e-9)
        trusted = weight * np.clip(1.0 - (residual / (4.685 * scale)) ** 2, 0.0, None) ** 2
        mass = trusted.sum()
        middle = float(trusted @ offset / mass)
        center = float(trusted @ value / mass)
        spread = float(trusted @ (offset - middle) ** 2) + 1e-12
        slope = float(trusted @ ((offset - middle) * (value - center))) / spread
        mode = center - slope * middle
    independent = float(trusted @ share)
    lever = 1.0 + middle**2 * float(trusted.sum()) / spread
    return mode, scale * float(np.sqrt(lever / independent))


def _join(parts: list[PlanarPoints]) -> PlanarPoints:
    return PlanarPoints(
        np.concatenate([p.encoded for p in parts]),
        np.concatenate([p.invariant for p in parts]),
        np.concatenate([p.deviation for p in parts]),
        np.concatenate([p.share for p in parts]),
    )
