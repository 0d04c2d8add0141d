"""The curve in whose linear light the noise of a photo is symmetric, with an affine variance.

Irradiance of one value R is observed as R + n, n Gaussian with variance `A R + B`: A from photons,
B from reading out. Encoded by a curve of slope g', to first order in the noise,

    variance of the code   V(I) = (A g(I) + B) / g'(I)^2,
    skewness of the code   s(I) = -3 sqrt(V(I)) g''(I) / g'(I).

**What variance alone leaves open.** With t(I) the integral of 1 / sqrt(V) from 0 to I, scaled to
t(1) = 1, the first line integrates to `g = (1 - k) t^2 + k t`, k in [0, 1] for every ratio of read
noise to photon noise (k = 0: photons alone, k = 1: reading alone): one degree of freedom stays
open even with exact data, from t to t^2, an RMSE of 0.18. The skewness closes it, weakly: its
error of sqrt(6 / n) against 3 sqrt(V) times the curvature needs about a million pixels at a noise
of 1 % of the code range to fix the curve within 0.01.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from facecrf_ocio.published.energy.log_slope import (
    INTERVALS,
    LogSlopePrior,
    curve_of,
    interpolation_rows,
)
from facecrf_ocio.values import Bool, Float

# A priori ratio of read noise to photon noise at full scale, and its spread in natural logs: base
# ISO of common sensors lies near 0.001, their highest near 0.05.
READ_TO_SHOT = 0.02
READ_TO_SHOT_SPREAD = 2.5  # [natural log]

# Errors of log variance and skewness beyond those of counting.
VARIANCE_DEVIATION = 0.003
SKEWNESS_DEVIATION = 0.001  # [1]

# Before the exact moments are taken, which need a curve near the right one.
FIRST_ORDER_ITERATIONS = 5
ITERATIONS = 25  # fixed, so that the result does not hang on a tolerance
# [natural log] of any unknown in one iteration: Gauss-Newton overshoots far from the goal.
MAX_STEP = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class RegionNoise:
    """Noise of one channel in uniform regions of several brightness levels.

    Attributes
    ----------
    encoded
        (L,) mean code of each level.
    variance
        (L,) of the code, without that of rounding to integer codes.
    skewness
        (L,) third central moment over `variance^1.5`.
    pixels
        (L,) number of pixels behind each level.
    dilution
        (L,) variance with rounding over variance without, at least 1.
    """

    encoded: Float
    variance: Float
    skewness: Float
    pixels: Float
    dilution: Float


@dataclass(frozen=True, slots=True, eq=False)
class NoiseFit:
    """The most likely curve and noise.

    Attributes
    ----------
    log_slopes
        (INTERVALS,) see `energy.log_slope`.
    shot, read
        (C,) A and B of each channel, in units of light at code 1.
    """

    log_slopes: Float
    shot: Float
    read: Float


@dataclass(frozen=True, slots=True, eq=False)
class _Linearized:
    """Residuals of levels, their derivatives by the unknowns, and their standard deviations."""

    residuals: Float
    rows: Float
    deviation: Float
    is_skewness: Bool


def fit_noise(channels: Sequence[RegionNoise], prior: LogSlopePrior) -> NoiseFit:
    """Most likely log slopes and noise parameters, by Gauss-Newton steps.

    The formulas above are of first order. Their difference to the exact moments of Gaussian noise
    sent through the current curve is taken from the data in each later step, so that the result
    is not of first order. Where the levels contradict the model by more than their errors, as
    those of faint texture do, the errors of variance or of skewness are stretched until they do
    not (Birge's ratio), and the prior counts for more.

    Parameters
    ----------
    channels
        One channel, or several that share a curve and each have their own noise.
    prior
        Distribution of the log slopes.
    """
    unknowns = np.concatenate([prior.mean, _first_noise(channels, prior.mean)])
    center = np.concatenate([prior.mean, np.tile([0.0, np.log(READ_TO_SHOT)], len(channels))])
    precision = _prior_precision(prior, len(channels))
    stretch = np.ones(2)
    for iteration in range(ITERATIONS):
        exact = iteration >= FIRST_ORDER_ITERATIONS
        data = _linearize_all(channels, unknowns, exact=exact)
        deviation = data.deviation * stretch[data.is_skewness.astype(np.intp)]
        weighted = data.rows / deviation[:, None] ** 2
        normal = precision + weighted.T @ data.rows
        gradient = precision @ (unknowns - center) + weighted.T @ data.residuals
        step = np.linalg.solve(normal, gradient)
        unknowns = unknowns - step * min(1.0, MAX_STEP / float(np.abs(step).max()))
        if exact:
            # Each datum's share of the degrees of freedom that the unknowns take up.
            taken = np.einsum("nu,un->n", data.rows, np.linalg.solve(normal, weighted.T))
            for kind in (0, 1):
                chosen = data.is_skewness == kind
                chi_square = ((data.residuals / data.deviation)[chosen] ** 2).sum()
                stretch[kind] = max(1.0, np.sqrt(chi_square / (1.0 - taken[chosen]).sum()))
    shot, read = np.exp(unknowns[INTERVALS:].reshape(-1, 2).T)
    full = float(np.exp(unknowns[:INTERVALS]).mean())
    return NoiseFit(unknowns[:INTERVALS], shot / full, read / full**2)


def _linearize_all(channels: Sequence[RegionNoise], unknowns: Float, *, exact: bool) -> _Linearized:
    """All channels below one another.

    `unknowns` are the log slopes, which are common, then log A and log B of each channel.
    """
    parts = []
    for index, levels in enumerate(channels):
        own = INTERVALS + 2 * index
        part = _linearize(
            levels, np.concatenate([unknowns[:INTERVALS], unknowns[own : own + 2]]), exact=exact
        )
        rows = np.zeros((len(part.rows), unknowns.size))
        rows[:, :INTERVALS] = part.rows[:, :INTERVALS]
        rows[:, own : own + 2] = part.rows[:, INTERVALS:]
        parts.append(replace(part, rows=rows))
    return _Linearized(
        np.concatenate([part.residuals for part in parts]),
        np.concatenate([part.rows for part in parts]),
        np.concatenate([part.deviation for part in parts]),
        np.concatenate([part.is_skewness for part in parts]),
    )


def _linearize(levels: RegionNoise, unknowns: Float, *, exact: bool) -> _Linearized:
    """Model minus data, log variance first and skewness after it, and their derivatives.

    `unknowns` are the log slopes, log A and log B of one channel.
    """
    log_slopes, shot, read = unknowns[:-2], np.exp(unknowns[-2]), np.exp(unknowns[-1])
    reader = interpolation_rows(levels.encoded)
    below = _light_below(levels.encoded) * np.exp(log_slopes)
    light = below.sum(axis=1)
    total = shot * light + read
    log_variance = np.log(total) - 2.0 * reader @ log_slopes
    noise = np.sqrt(levels.variance)
    curvature = -3.0 * noise[:, None] * _curvature_rows(levels.encoded)
    skewness = curvature @ log_slopes
    rows = np.vstack(
        [
            np.column_stack(
                [shot * below / total[:, None] - 2.0 * reader, shot * light / total, read / total]
            ),
            np.pad(curvature, ((0, 0), (0, 2))),
        ]
    )
    predicted = [log_variance, skewness]
    if exact:
        predicted = [*exact_moments(levels.encoded, log_slopes, float(shot), float(read))]
    observed = [np.log(levels.variance), levels.skewness]
    return _Linearized(
        np.concatenate(predicted) - np.concatenate(observed),
        rows,
        np.concatenate(
            [
                np.hypot(np.sqrt(2.0 / levels.pixels) * levels.dilution, VARIANCE_DEVIATION),
                np.hypot(np.sqrt(6.0 / levels.pixels) * levels.dilution**1.5, SKEWNESS_DEVIATION),
            ]
        ),
        np.repeat([False, True], levels.encoded.size),
    )


def exact_moments(
    encoded: Float, log_slopes: Float, shot: float, read: float
) -> tuple[Float, Float]:
    """Log variance and skewness of codes whose mean is `encoded`, by Gauss-Hermite quadrature.

    Parameters
    ----------
    encoded
        (N,) mean codes.
    log_slopes
        (INTERVALS,) of the curve; light is in the units of its integral.
    shot, read
        A and B in those units.

    Returns
    -------
    tuple
        (N,) and (N,).
    """
    nodes, weights = np.polynomial.hermite_e.hermegauss(15)
    weights = weights / weights.sum()
    grid = np.linspace(0.0, 1.0, 1025)
    full = float(np.exp(log_slopes).mean())
    curve = curve_of(log_slopes, grid) * full
    slope = np.exp(interpolation_rows(encoded) @ log_slopes)
    light = np.interp(encoded, grid, curve)
    for _ in range(4):
        spread = np.sqrt(shot * light + read)
        codes = np.interp(light[:, None] + spread[:, None] * nodes, curve, grid)
        mean = codes @ weights
        light = np.clip(light + slope * (encoded - mean), 1e-9, full)
    offset = codes - mean[:, None]
    variance = np.maximum(offset**2 @ weights, 1e-15)
    return np.log(variance), (offset**3 @ weights) / variance**1.5


def _light_below(encoded: Float) -> Float:
    """Rows (N, INTERVALS): the width of each interval that lies below each code."""
    width = np.clip(encoded[:, None] * INTERVALS - np.arange(INTERVALS), 0.0, 1.0)
    return np.asarray(width / INTERVALS)


def _curvature_rows(encoded: Float) -> Float:
    """Rows (N, INTERVALS) that give the slope of the log slopes, `g'' / g'`."""
    half = 0.5 / INTERVALS
    rows = interpolation_rows(encoded + half) - interpolation_rows(encoded - half)
    return np.asarray(rows / (2.0 * half))


def _first_noise(channels: Sequence[RegionNoise], log_slopes: Float) -> Float:
    """(2 C,) log A and log B of each channel if the curve had these log slopes."""
    found = []
    for levels in channels:
        slope = np.exp(interpolation_rows(levels.encoded) @ log_slopes)
        light = _light_below(levels.encoded) @ np.exp(log_slopes)
        shot = float((levels.variance * slope**2) @ light / (light @ light))
        found += [np.log(shot), np.log(shot * READ_TO_SHOT)]
    return np.array(found)


def _prior_precision(prior: LogSlopePrior, channels: int) -> Float:
    """(U, U) inverse covariance of log slopes and of `log B - log A`; A itself is free."""
    size = INTERVALS + 2 * channels
    precision = np.zeros((size, size))
    precision[:INTERVALS, :INTERVALS] = np.linalg.inv(prior.covariance)
    weight = READ_TO_SHOT_SPREAD**-2
    for shot in range(INTERVALS, size, 2):
        precision[shot : shot + 2, shot : shot + 2] = weight * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return precision
