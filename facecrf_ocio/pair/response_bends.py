"""The spline that a response is in log light, and how those of known responses bend.

Their bends go together: a straight line in log light, which Debevec and Malik (SIGGRAPH 1997) ask
for, is far from any of them near black (docs/evidence).
"""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.interpolate import BSpline

from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.response.robust import robust_deviations
from facecrf_ocio.values import Float

_SEGMENTS, DEGREE = 16, 3  # of a cubic spline, with a knot every 16 codes; chosen by judgment
SIZE = _SEGMENTS + DEGREE
# Draws of the response model that tell how responses bend, the light below which they do not, and
# the deviation [stop] of each bend by itself, for responses that the model never saw.
_DRAWS, _LEAST_LIGHT, _OWN_BEND = 400, 2.0**-12, 0.02
_FARTHEST = 4.0  # robust deviations: what bends more, next to black, counts as that
_TOE = 4.0 / 255.0  # code below which responses are not looked at


def knots() -> Float:
    """Of the spline, from code 0 to 255 of 255."""
    inner = np.linspace(0.0, 1.0, _SEGMENTS + 1)
    return np.concatenate([np.zeros(DEGREE), inner, np.ones(DEGREE)])


@cache
def known_bends() -> tuple[Float, Float]:
    """Median (B,) [stop] and precision (B, B) of second differences of responses' coefficients."""
    model, random = dorf_model(), np.random.default_rng(0)
    at = model.grid >= _TOE
    basis = BSpline.design_matrix(model.grid[at], knots(), DEGREE).toarray()
    drawn = []
    for place in random.integers(len(model.mixture.means), size=_DRAWS):
        mean, covariance = model.mixture.means[place], model.mixture.covariances[place]
        sample = model.samples(
            mean + np.linalg.cholesky(covariance) @ random.normal(size=mean.size)
        )
        drawn.append(np.log2(np.maximum.accumulate(np.maximum(sample, _LEAST_LIGHT)))[at])
    coefficients = np.linalg.lstsq(basis, np.array(drawn).T, rcond=None)[0]
    bends = np.diff(coefficients, 2, axis=0)
    usual = np.median(bends, axis=1)
    apart = bends - usual[:, None]
    deviation = robust_deviations(apart)
    usually = np.clip(apart, -_FARTHEST * deviation, _FARTHEST * deviation)
    covariance = usually @ usually.T / _DRAWS + _OWN_BEND**2 * np.eye(len(usual))
    return usual, np.linalg.inv(covariance)
