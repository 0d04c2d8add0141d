"""Fit one channel's response to pairs of code values and linear light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import lsq_linear

from facecrf_ocio.pair.flat_pixels import Samples
from facecrf_ocio.response.robust import biweight, robust_deviation
from facecrf_ocio.values import Float

SEGMENTS = 32  # of the spline: one is eight 8-bit codes
_DEGREE = 3  # cubic: its slope has no kinks
_ROUNDS = 12  # of reweighting by residuals
_CODE = 1.0 / 255.0  # [encoded] one 8-bit code
_STIFFNESS = 3.0  # weight of a change of the slopes' ratio to the typical curve, beside one sample
_NORMALIZATION = 1e4  # weight of the row that says g(1) = 1, so that it holds as an equation
_SMALLEST_STEP = 1e-7  # [linear] from knot to knot, so that the curve increases


@dataclass(frozen=True, slots=True, eq=False)
class ChannelFit:
    """Response of one channel.

    Attributes
    ----------
    linear
        (K,) linear light at uniform encoded values from 0 to 1, increasing from 0 to 1.
    mixing
        (3,) the channel's row of gains and color matrix: `mixing @ light` goes into the curve.
    residual
        (N,) of each sample, `g(encoded) - mixing @ light`, linear, 1 at the highest code.
    residual_codes
        Robust standard deviation of the residual in 8-bit code values.
    """

    linear: Float
    mixing: Float
    residual: Float
    residual_codes: float


def fit_channel(samples: Samples, channel: int, typical: Float, size: int) -> ChannelFit:
    """Find an increasing `g` with `g(0) = 0`, `g(1) = 1` and a row `m` so that `g(I) = m . L`.

    A cubic B-spline whose coefficients increase is increasing. With increments and row as unknowns
    this is a linear least-squares problem with bounds; it is solved again and again with Tukey's
    biweights of the residuals in code values, as that is where their noise is even. Where there
    are no samples, the curve keeps its ratio of slopes to the typical curve.

    Parameters
    ----------
    samples
        At least some hundred.
    channel
        Which of the three channels they are of.
    typical
        (K',) a typical inverse response at uniform encoded values, such as the mean of many.
    size
        K, number of values of the result.
    """
    knots = np.concatenate([np.zeros(_DEGREE), np.linspace(0, 1, SEGMENTS + 1), np.ones(_DEGREE)])
    count = SEGMENTS + _DEGREE
    basis = BSpline.design_matrix(np.clip(samples.encoded, 0, 1), knots, _DEGREE).toarray()
    cumulated = np.cumsum(basis[:, ::-1], axis=1)[:, ::-1][:, 1:]
    # The scale is held by the light of all samples while solving. Held by g(1) = 1, far from all
    # of them, everything but the last increment would shrink to nothing.
    contrast = _halves(samples.linear, samples.encoded)
    expected = _typical_increments(typical, knots, count)
    expected /= _halves(cumulated, samples.encoded) @ expected
    coefficients = np.concatenate([[0.0], np.cumsum(expected)])
    prior = _prior_rows(expected, contrast, _gain(samples, coefficients, knots, channel), channel)
    light = samples.linear
    row: Float = np.zeros(3)
    weights: Float = np.ones(len(light))
    scale = 4 * _CODE
    for _ in range(_ROUNDS):
        slope = np.maximum(_spline(knots, coefficients).derivative()(samples.encoded), 0.02)
        rows = np.hstack([cumulated, -light]) * (np.sqrt(weights) / (slope * scale))[:, None]
        increments, row = _solve(np.vstack([rows, prior]), count - 1)
        coefficients = np.concatenate([[0.0], np.cumsum(increments)])
        residual = (cumulated @ increments - light @ row) / slope
        scale = max(_deviation(residual), 0.1 * _CODE)
        weights = biweight(residual, scale)
    total = coefficients[-1]
    grid = np.linspace(0.0, 1.0, size)
    linear = np.asarray(_spline(knots, coefficients / total)(grid))
    return ChannelFit(
        linear,
        row / total,
        (cumulated @ np.diff(coefficients) - light @ row) / total,
        _deviation(residual) / _CODE,
    )


def _spline(knots: Float, coefficients: Float) -> BSpline:
    return BSpline(knots, coefficients, _DEGREE)


def _typical_increments(typical: Float, knots: Float, count: int) -> Float:
    """Increments of the spline coefficients of the typical curve (Schoenberg's approximation)."""
    places = np.array([knots[i + 1 : i + 1 + _DEGREE].mean() for i in range(count)])
    values = np.interp(places, np.linspace(0, 1, typical.size), typical)
    increments = np.maximum(np.diff(values), 1e-4)
    return np.asarray(increments / increments.sum())


def _halves(values: Float, encoded: Float) -> Float:
    """Mean of values (N, ...) of the brighter half of samples (N,) less that of the darker half."""
    order = np.argsort(encoded)
    half = len(order) // 2
    return np.asarray(values[order[half:]].mean(axis=0) - values[order[:half]].mean(axis=0))


def _gain(samples: Samples, coefficients: Float, knots: Float, channel: int) -> float:
    """About how much light the row multiplies by."""
    expected = _spline(knots, coefficients)(samples.encoded)
    return float(np.median(expected / np.maximum(samples.linear[:, channel], 1e-6)))


def _prior_rows(expected: Float, contrast: Float, gain: float, channel: int) -> Float:
    """Weak knowledge: even ratio to the typical slopes (I,), small crosstalk; last: contrast is 1.

    Rows (N, I + 3), of I increments of the curve and three gains.
    """
    size = expected.size
    ratios = np.hstack([np.diag(1 / expected), np.zeros((size, 3))])
    smooth = _STIFFNESS * np.diff(ratios, axis=0)
    crosstalk = np.zeros((3, size + 3))
    crosstalk[range(3), range(size, size + 3)] = 1 / (2 * gain)
    crosstalk[channel] = 0
    return np.vstack([smooth, crosstalk, [*np.zeros(size), *contrast]])


def _solve(rows: Float, increments: int) -> tuple[Float, Float]:
    """Least squares of rows (N, U) @ x = 0, the last row's = 1, the first `increments` positive."""
    system = rows.copy()
    system[-1] *= _NORMALIZATION
    right = np.zeros(len(rows))
    right[-1] = _NORMALIZATION
    # The triangular factor has the same least squares and as few rows as unknowns.
    triangle: Float = np.asarray(np.linalg.qr(np.column_stack([system, right]), mode="r"))
    unknowns = system.shape[1]
    low = np.full(unknowns, -np.inf)
    low[:increments] = _SMALLEST_STEP
    solution = lsq_linear(triangle[:, :-1], triangle[:, -1], (low, np.inf), method="bvls").x
    return solution[:increments], solution[increments:]


def _deviation(residual: Float) -> float:
    return robust_deviation(residual - np.median(residual))
