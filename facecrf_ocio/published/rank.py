"""RankCRF on a single image: rank minimization on color blends (Lee et al., PAMI 2013).

The curve of a channel is the paper's polynomial `g(D) = D + D (D - 1) sum c_i D^(n-i-1)`, which
runs from 0 to 1 whatever its coefficients, with no prior but monotonicity. The paper starts from
the identity; so does this, raising the degree from 2 on, so that each fit starts the next.

The paper's monotonicity term adds 1000 for every code at which a curve falls. That is more than all
condition numbers together can save, so the term only ever forbids; it is a constraint here, linear
in the coefficients, because at its wall a descent gets stuck.
"""

from __future__ import annotations

import numpy as np
import scipy

from facecrf_ocio.published.answer import Answer, FittedCurve
from facecrf_ocio.published.edge_patches import find_edge_patches, lacking_patches, stack_blends
from facecrf_ocio.published.edge_selection import select_patches
from facecrf_ocio.published.energy.rank_blend import BlendRank
from facecrf_ocio.published.energy.term import Term
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import PublishedSettings
from facecrf_ocio.values import CHANNELS, Float, Photo

# Polynomials of degree 7 come within 0.001 of half of the DoRF curves and 0.014 of 95 % of them.
DEGREE = 7
RISING_INTERVALS = 64  # in each of which the polynomial must rise; it has at most six turns
MAX_ITERATIONS = 100  # of SLSQP, at most
TOLERANCE = 1e-7  # [energy] of SLSQP's end


def rank_answer(photo: Photo, model: ResponseModel, settings: PublishedSettings) -> Answer:
    """Curves that bring the blends at the photo's edges nearest to rank 1; the estimator `rank`.

    Parameters
    ----------
    photo
        As read; its pixels must not have been scaled.
    model
        Only its grid is used: RankCRF has no empirical prior.
    settings
        Whether the channels share one curve.
    """
    patches = find_edge_patches(photo.encoded)
    lacking = lacking_patches(photo, len(patches))
    if lacking is not None:
        return lacking
    blends = stack_blends(select_patches(patches))
    term = BlendRank(blends, model.grid.size)
    return FittedCurve(
        fit_polynomials(term, model.grid, shared=settings.shared_curve),
        blends.blends.T,
        f"{blends.regions.shape[1]} edge patches with {blends.patch.size} blended pixels",
    )


def fit_polynomials(term: Term, grid: Float, *, shared: bool, degree: int = DEGREE) -> Float:
    """Rising polynomial curves (3, K) on the grid that minimize a term.

    Parameters
    ----------
    term
        What to minimize.
    grid
        (K,) encoded values.
    shared
        One polynomial for all three channels.
    degree
        Highest power of D.
    """
    # Scaled so that one unit of a coefficient moves the curve by about 1 at each code.
    basis = polynomial_basis(grid, degree) * np.sqrt(grid.size)
    coefficients: Float = np.zeros((1 if shared else len(CHANNELS), 0))
    for count in range(1, degree):
        start = np.pad(coefficients, ((0, 0), (0, 1)))
        coefficients = _descend(term, grid, basis[:count], start)
    return np.array(np.broadcast_to(grid + coefficients @ basis, (len(CHANNELS), grid.size)))


def polynomial_basis(grid: Float, degree: int) -> Float:
    """Orthonormal polynomials (degree - 1, K) that vanish at 0 and 1, in order of their degree.

    They span the same curves as the paper's powers, on which a solver would crawl.
    """
    powers = grid * (grid - 1.0) * grid ** np.arange(degree - 1)[:, None]
    return np.asarray(np.linalg.qr(powers.T)[0].T)


def _descend(term: Term, grid: Float, basis: Float, start: Float) -> Float:
    """Coefficients of the nearest minimum among rising curves, of the shape of `start`."""
    # Codes lie closer together toward 0 and 1, where polynomials turn fastest.
    turns = np.linspace(0.0, np.pi, RISING_INTERVALS + 1)
    codes = np.unique(((grid.size - 1) * (1.0 - np.cos(turns)) / 2.0).round().astype(np.intp))
    slopes = (np.diff(basis[:, codes], axis=1) / np.diff(grid[codes])).T
    rows = np.kron(np.eye(len(start)), slopes)

    def evaluate(unknowns: Float) -> tuple[float, Float]:
        curves = grid + unknowns.reshape(start.shape) @ basis
        samples = np.array(np.broadcast_to(curves, (len(CHANNELS), grid.size)))
        value, by_samples = term.value_and_gradient(samples)
        by_curves = by_samples if len(start) > 1 else by_samples.sum(axis=0, keepdims=True)
        return value, (by_curves @ basis.T).ravel()

    result = scipy.optimize.minimize(
        evaluate,
        start.ravel(),
        jac=True,
        method="SLSQP",
        constraints=scipy.optimize.LinearConstraint(rows, -1.0, np.inf),
        options={"maxiter": MAX_ITERATIONS, "ftol": TOLERANCE},
    )
    return np.asarray(result.x.reshape(start.shape))
