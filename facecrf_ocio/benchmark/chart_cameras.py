"""Responses of real cameras, measured by charts, and what they make of a prior of responses.

The curves are of one collection of photos straight from cameras (`training/measure_charts.py`).
They are smooth and alike, as makers' own curves are, where those solved from stacks have waves and
published ones differ by who published them: so they get a component of their own.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.responses import Responses, read_responses
from facecrf_ocio.cameras.maker_names import maker_of
from facecrf_ocio.joint.prior import FAMILIES, FamilyPrior

CHART_CAMERAS = Path(__file__).parents[2] / "examples" / "results" / "chart_cameras.npz"
"""In a checkout, as the weights that hold responses out are."""

FITTED = (8, 6, 6)
"""Components of each family that are fitted to drawn responses; this one stands behind them."""

_SHARE = 0.5  # of the cameras' family, as none is known to be likelier; chosen by judgment
# Of what coefficients have in common: so few cameras tell no correlation of twelve for sure.
_ALONE = 0.3
_LEAST = 0.05  # [deviation of the prior] that is added in each coefficient, for the charts' errors
_CAMERA = FAMILIES.index("camera")


@cache
def chart_cameras() -> Responses:
    """The responses that were measured."""
    return read_responses(CHART_CAMERAS)


def fitted_prior(prior: FamilyPrior) -> FamilyPrior:
    """A prior without the component of chart cameras, as it was fitted to drawn responses."""
    fitted = slice(0, sum(FITTED))
    family = prior.family[fitted]
    number = np.array([(family == one).sum() for one in family])
    return replace(
        prior,
        weights=1.0 / number / len(FAMILIES),
        means=prior.means[fitted],
        covariances=prior.covariances[fitted],
        family=family,
    )


def with_chart_cameras(prior: FamilyPrior, without: Collection[str] = ()) -> FamilyPrior:
    """A prior whose cameras' family has one component more, or that one anew.

    Parameters
    ----------
    prior
        As fitted, or what this function made of it.
    without
        Makers that are held out.
    """
    measured, held_out = chart_cameras(), {maker_of(one) for one in without}
    makers = [maker_of(measured.family(row)) for row in range(len(measured.names))]
    kept = [
        row
        for row, maker in enumerate(makers)
        if maker not in held_out and measured.kind(row) == "camera_jpeg"
    ]
    prior = fitted_prior(prior)
    grid = np.linspace(0.0, 1.0, measured.inverse.shape[2])
    roots = np.array([np.interp(prior.grid, grid, np.sqrt(measured.inverse[r][1])) for r in kept])
    points = np.linalg.lstsq(prior.basis.T, (roots - prior.mean).T, rcond=None)[0].T
    number = Counter(makers[row] for row in kept)
    # Models of one maker are alike: nine of them count as three.
    trust = np.array([number[makers[row]] ** -0.5 for row in kept])
    trust /= trust.sum()
    mean = trust @ points
    away = points - mean
    spread = (away * trust[:, None]).T @ away / (1.0 - (trust**2).sum())
    spread = (1.0 - _ALONE) * spread + _ALONE * np.diag(np.diag(spread))
    spread += _LEAST**2 * np.eye(len(mean))
    others = np.where(prior.family == _CAMERA, 1.0 - _SHARE, 1.0) * prior.weights
    return replace(
        prior,
        weights=np.append(others, _SHARE / len(FAMILIES)),
        means=np.vstack([prior.means, mean]),
        covariances=np.concatenate([prior.covariances, spread[None]]),
        family=np.append(prior.family, _CAMERA),
    )
