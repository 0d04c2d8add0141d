"""What frames of one scene tell of the curve: points whose light all frames share.

Between two frames the light of every point changes by one factor, the exposure's. A curve under
which that holds for dark and bright points alike is the camera's, up to an exponent (Grossberg and
Nayar, PAMI 2003), which the faces tell. Where the curve itself changes over the clip, points of
fixed light show that, its exponent too.
"""

from __future__ import annotations

import numpy as np

from facecrf_ocio.clip.point_values import (
    Values,
    compared,
    robust_weights,
    unexplained,
    values_of,
)
from facecrf_ocio.clip.tracked_points import TrackedPoints
from facecrf_ocio.joint.prior import FamilyPrior, Posterior
from facecrf_ocio.values import Float

_ROUNDS = 8  # of Gauss-Newton, each with weights anew
# Values err alike (a codec's blocks, noise beneath a bent curve, shading of what moves): so many
# count as one for the curve. From one end of the clip to the other less is alike.
_ALIKE, ALIKE_IN_TIME = 30.0, 3.0
# Variance of each coefficient that is added to what faces leave: they tell how bright a curve is,
# and not its finest bends, which points tell better. In units of the prior's.
_FINE = 1.0
_DRIFT = 0.3  # standard deviation of a drift, in units of the prior's


def add_points(
    faces: Posterior,
    points: TrackedPoints,
    stops: Float,
    prior: FamilyPrior,
    scale: float,
) -> Posterior:
    """What faces leave of the prior, and then points whose exposures are told.

    Parameters
    ----------
    faces
        Coefficients by the faces.
    points
        The same points in J frames.
    stops
        (J,) log2 of the exposures.
    prior
        Of the curves.
    scale
        Factor on the deviations of posteriors that makes them honest.
    """
    size = faces.mean.size
    values = values_of(points, np.zeros(len(stops)), stops)
    start = np.concatenate([faces.mean, np.zeros(size)])
    covariance = scale**2 * faces.covariance + _FINE * np.eye(size)
    found, left = _solve(values, start, _precision(covariance), prior, _ALIKE)
    return Posterior(np.ones(1), found[None, :size], left[None, :size, :size] / scale**2)


def solve_drift(faces: Posterior, values: Values, prior: FamilyPrior) -> tuple[Float, Float]:
    """(2 M,) coefficients of the curve and of its change per unit of time; their covariance."""
    start = np.concatenate([faces.mean, np.zeros(faces.mean.size)])
    return _solve(values, start, _precision(faces.covariance), prior, ALIKE_IN_TIME)


def _precision(covariance: Float) -> Float:
    """Of the curve's coefficients, and of those of its drift."""
    size = len(covariance)
    precision = np.eye(2 * size) / _DRIFT**2
    precision[:size, :size] = np.linalg.inv(covariance)
    return precision


def _solve(
    values: Values, start: Float, precision: Float, prior: FamilyPrior, alike: float
) -> tuple[Float, Float]:
    """Coefficients of the curve and of its drift, and their covariance."""
    found: Float = start
    weights: Float = np.ones(values.codes.size)
    system: Float = precision
    for _ in range(_ROUNDS):
        relative, left, rows, noise = compared(values, found, weights, prior, alike)
        weights = robust_weights(left, noise)
        columns = unexplained(np.column_stack([rows, relative]), weights, values, alike)
        joint = columns.T @ (columns * weights[:, None]) / alike
        system = precision + joint[:-1, :-1]
        found = found + np.linalg.solve(system, precision @ (start - found) - joint[:-1, -1])
    return found, np.linalg.inv(system)
