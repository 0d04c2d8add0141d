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
  curves of film: with five parameters, fitted to planes without noise, its error reaches 4 %. The
  log slopes of `energy.log_slope` take its place; they increase always, and the response
  model continues the curve where the photo shows no plane.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.published.answer import Answer, FittedCurve
from facecrf_ocio.published.energy.log_slope import (
    CENTERS,
    INTERVALS,
    LogSlopePrior,
    curve_of,
    log_slope_prior,
)
from facecrf_ocio.published.planar_points import PlanarPoints, joined, planar_points
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.response.robust import biweight, robust_deviation
from facecrf_ocio.settings import PublishedSettings
from facecrf_ocio.values import CHANNELS, Float, Lacking, Photo

# Points that a level needs, and the independent windows they must amount to.
MIN_POINTS = 20
MIN_WINDOWS = 0.1  # a tenth of one, because windows that overlap share their pixels
MIN_LEVELS = INTERVALS // 4  # a quarter of the code range, or the prior would draw the curve
# Error of the invariant beyond that of noise: curves bend within a window and within a level.
MODEL_DEVIATION = 0.05
# Where irradiance bends too, the mode lies anywhere within about half the spread.
MODE_TO_SPREAD = 0.5
# A level that rests on fewer independent windows must not contradict the others by more than this.
FEW_WINDOWS = 5.0
MAX_SURPRISE = 4.0  # [standard deviations]
SUMMARY_SIZE = 256  # quantiles by which an answer tells where its evidence lies


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


def geometry_invariant_answer(
    photo: Photo, model: ResponseModel, settings: PublishedSettings
) -> Answer:
    """Find planar irradiance, read the invariant at each code, and integrate it to a curve."""
    rounding = 0.0 if photo.bit_depth is None else 12.0**-0.5 / (2**photo.bit_depth - 1)
    planes = np.ascontiguousarray(photo.encoded.transpose(2, 0, 1))
    points = [planar_points(plane, rounding) for plane in planes]
    if settings.shared_curve:
        points = [joined(points)] * len(CHANNELS)
    levels = [invariant_levels(p) for p in points]
    fewest = min(len(found.edge) for found in levels)
    if fewest < MIN_LEVELS:
        return Lacking(
            f"smooth ramps of light were found at {fewest} of {INTERVALS - 1} brightness levels "
            f"({MIN_LEVELS} are needed)",
            "use a larger or less noisy photo with soft shading",
        )
    prior = log_slope_prior(model)
    quantiles = np.linspace(0.0, 1.0, SUMMARY_SIZE)
    return FittedCurve(
        np.array([curve_from_invariants(found, prior, model.grid) for found in levels]),
        np.array([np.quantile(p.encoded, quantiles) for p in points]).T,
        f"{min(p.encoded.size for p in points)} locally planar points per channel "
        f"at {fewest} brightness levels",
    )


def invariant_levels(points: PlanarPoints) -> Levels:
    """Mode of the invariant at each edge between intervals, from the points around it."""
    order = np.argsort(points.encoded, kind="stable")
    position = points.encoded[order] * INTERVALS
    found = []
    for edge in range(1, INTERVALS):
        first, last = np.searchsorted(position, (edge - 0.5, edge + 0.5))
        near = order[first:last]
        windows = float(points.share[near].sum())
        if near.size >= MIN_POINTS and windows >= MIN_WINDOWS:
            variance = points.deviation[near] ** 2 + MODEL_DEVIATION**2
            mode, deviation, scale = _mode_at_zero(
                position[first:last] - edge,
                points.invariant[near],
                1.0 / variance,
                points.share[near],
            )
            # Spread beyond the noise comes from curved light, which also shifts the mode.
            excess = np.sqrt(max(scale**2 - 1.0, 0.0) * np.median(variance))
            deviation = float(np.hypot(deviation, MODE_TO_SPREAD * excess))
            found.append((edge, mode, deviation, windows))
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


def _mode_at_zero(
    offset: Float, value: Float, weight: Float, share: Float
) -> tuple[float, float, float]:
    """Mode of `value` where `offset` is 0, by a robust line.

    Tukey's biweight from the weighted median on: a minority of other surfaces has no influence.

    Returns
    -------
    tuple
        The mode, its standard deviation, and the spread around the line in units of
        `weight^-0.5`.
    """
    order = np.argsort(value, kind="stable")
    cumulative = np.cumsum(weight[order])
    mode = float(value[order][np.searchsorted(cumulative, cumulative[-1] / 2.0)])
    slope, scale, trusted, middle, spread = 0.0, 1.0, weight, 0.0, 1.0
    for _ in range(20):
        residual = (value - mode - slope * offset) * np.sqrt(weight)
        scale = max(robust_deviation(residual), 1e-9)
        trusted = weight * biweight(residual, scale)
        mass = trusted.sum()
        middle = float(trusted @ offset / mass)
        center = float(trusted @ value / mass)
        spread = float(trusted @ (offset - middle) ** 2) + 1e-12
        slope = float(trusted @ ((offset - middle) * (value - center))) / spread
        mode = center - slope * middle
    independent = float(trusted @ share)
    lever = 1.0 + middle**2 * float(trusted.sum()) / spread
    return mode, scale * float(np.sqrt(lever / independent)), scale
