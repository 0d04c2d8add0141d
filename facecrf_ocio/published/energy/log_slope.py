"""Curves by the logarithm of their slope: always increasing, with the response model as prior.

The rivals that see the curve through its slope alone (geometry invariants, noise) are linear or
nearly so in `log g'(I)`, while five eigenvectors of `g` reproduce slopes poorly where `g` is dark:
the model's nearest curve to gamma 2.2 falls there. Here a curve is its mean slope in `INTERVALS`
equal intervals of code values, and the response model (eq. 9, 20) gives their joint distribution.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.values import Float

INTERVALS = 64  # of equal width in code values: one is four 8-bit codes
CENTERS = (np.arange(INTERVALS) + 0.5) / INTERVALS  # of the intervals, encoded

DRAWS = 4000  # curves from which the covariance of 64 log slopes is measured
MIN_SLOPE = 0.005  # [linear per encoded] of a drawn curve, whose logarithm is to be finite
# What five eigenvectors leave out: independent of the model, smooth over a tenth of the codes.
MISFIT_DEVIATION = 0.1
MISFIT_LENGTH = 0.1  # [encoded]


@dataclass(frozen=True, slots=True, eq=False)
class LogSlopePrior:
    """Gaussian distribution of the log slopes of inverse curves.

    Attributes
    ----------
    mean
        (INTERVALS,) of `log g'`, linear per encoded.
    covariance
        (INTERVALS, INTERVALS).
    """

    mean: Float
    covariance: Float

    def condition(self, rows: Float, values: Float, deviation: Float) -> Float:
        """Most likely log slopes (INTERVALS,) given `rows @ log_slopes = values` with errors.

        Parameters
        ----------
        rows
            (N, INTERVALS).
        values, deviation
            (N,) with independent Gaussian errors.
        """
        shared = self.covariance @ rows.T
        expected = rows @ shared + np.diag(deviation**2)
        return np.asarray(self.mean + shared @ np.linalg.solve(expected, values - rows @ self.mean))

    def surprise(self, rows: Float, values: Float, deviation: Float) -> Float:
        """How far each value lies from what all others predict, in standard deviations (N,).

        Parameters are those of `condition`; leave-one-out by the inverse of the covariance.
        """
        precision = np.linalg.inv(rows @ self.covariance @ rows.T + np.diag(deviation**2))
        surprise = precision @ (values - rows @ self.mean)
        return np.asarray(surprise / np.sqrt(np.diagonal(precision)))


def log_slope_prior(model: ResponseModel) -> LogSlopePrior:
    """Mean and covariance of the log slopes of curves drawn from the response model.

    Draws that fall are dropped, since they are no responses; the seed is fixed.
    """
    draws = _draw_coefficients(model)
    edges = np.linspace(0.0, 1.0, INTERVALS + 1)
    curves = np.array([np.interp(edges, model.grid, c) for c in (model.mean, *model.basis)])
    slopes = np.diff(curves[0] + draws @ curves[1:], axis=1) * INTERVALS
    log_slopes = np.log(np.maximum(slopes[(slopes > -0.05).all(axis=1)], MIN_SLOPE))
    apart = (CENTERS[:, None] - CENTERS) / MISFIT_LENGTH
    misfit = MISFIT_DEVIATION**2 * np.exp(-0.5 * apart**2) + 1e-6 * np.eye(INTERVALS)
    return LogSlopePrior(log_slopes.mean(axis=0), np.cov(log_slopes.T) + misfit)


def curve_of(log_slopes: Float, grid: Float) -> Float:
    """Samples (K,) from 0 to 1 on a grid (K,) of the curve with these log slopes."""
    middle = (grid[1:] + grid[:-1]) / 2.0
    slopes = np.exp(np.interp(middle, CENTERS, log_slopes))
    curve = np.concatenate([[0.0], np.cumsum(slopes * np.diff(grid))])
    return np.asarray(curve / curve[-1])


def interpolation_rows(encoded: Float) -> Float:
    """Rows (N, INTERVALS) that read the log slopes at encoded values (N,)."""
    return np.array([np.interp(encoded, CENTERS, one) for one in np.eye(INTERVALS)]).T


def _draw_coefficients(model: ResponseModel) -> Float:
    mixture = model.mixture
    generator = np.random.default_rng(0)
    component = generator.integers(len(mixture.means), size=DRAWS)
    standard = generator.standard_normal((DRAWS, mixture.means.shape[1]))
    spread = np.linalg.cholesky(mixture.covariances)[component]
    return np.asarray(mixture.means[component] + np.einsum("nij,nj->ni", spread, standard))
