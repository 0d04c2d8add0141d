"""RankCRF on a single image: rank minimization on color blends (Lee et al., PAMI 2013).

The curve of a channel is the paper's polynomial `g(D) = D + D (D - 1) sum c_i D^(n-i-1)`, which
runs from 0 to 1 whatever its coefficients, with no prior but monotonicity. The paper starts from
the identity; so does this, raising the degree from 2 on, so that each fit starts the next.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import minimize

from facecrf_ocio.cues.edge_patches import find_edge_patches, gather_blends, lacking_patches
from facecrf_ocio.cues.edge_selection import select_patches
from facecrf_ocio.cues.evidence import Answer, FittedCurve
from facecrf_ocio.energy.monotonicity import Monotonicity
from facecrf_ocio.energy.rank_blend import BlendRank
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import Settings
from facecrf_ocio.solve import Weighted
from facecrf_ocio.values import CHANNELS, Float, Photo

# Polynomials of degree 7 come within 0.001 of half of the DoRF curves and 0.014 of 95 % of them.
DEGREE = 7
MAX_ITERATIONS = 300


def rank_cue(photo: Photo, model: ResponseModel, settings: Settings) -> Answer:
    """Curves that bring the blends at the photo's edges nearest to rank 1; the estimator `rank`.

    Parameters
    ----------
    photo
        As read; its pixels must not have been scaled.
    model
        Only its grid is used: RankCRF has no empirical prior.
    settings
        `monotonicity_weight` is the paper's lambda, 1000 by default here as there.
    """
    patches = find_edge_patches(photo.encoded)
    lacking = lacking_patches(photo, len(patches))
    if lacking is not None:
        return lacking
    blends = gather_blends(select_patches(patches))
    terms = (
        Weighted("rank", 1.0, BlendRank(blends, model.grid.size)),
        Weighted("monotonicity", settings.monotonicity_weight, Monotonicity()),
    )
    return FittedCurve(
        fit_polynomials(terms, model.grid, shared=settings.shared_curve),
        blends.blends.T,
        f"{blends.regions.shape[1]} edge patches with {blends.patch.size} blended pixels",
    )


def fit_polynomials(
    terms: Sequence[Weighted], grid: Float, *, shared: bool, degree: int = DEGREE
) -> Float:
    """Polynomial curves (3, K) on the grid that minimize the terms.

    Parameters
    ----------
    terms
        The objective.
    grid
        (K,) encoded values.
    shared
        One polynomial for all three channels.
    degree
        Highest power of D.
    """
    basis = polynomial_basis(grid, degree)
    coefficients = np.zeros((1 if shared else len(CHANNELS), 0))
    for count in range(1, degree):
        start = np.pad(coefficients, ((0, 0), (0, 1)))
        coefficients = _descend(terms, grid, basis[:count], start)
    return np.array(np.broadcast_to(grid + coefficients @ basis, (len(CHANNELS), grid.size)))


def polynomial_basis(grid: Float, degree: int) -> Float:
    """Orthonormal polynomials (degree - 1, K) that vanish at 0 and 1, in order of their degree.

    They span the same curves as the paper's powers, on which a solver would crawl.
    """
    powers = grid * (grid - 1.0) * grid ** np.arange(degree - 1)[:, None]
    return np.asarray(np.linalg.qr(powers.T)[0].T)


def _descend(terms: Sequence[Weighted], grid: Float, basis: Float, start: Float) -> Float:
    # Unit steps of a coefficient move the curve by about 1 at each code.
    scaled = basis * np.sqrt(grid.size)

    def evaluate(unknowns: Float) -> tuple[float, Float]:
        offset = unknowns.reshape(start.shape) @ scaled
        samples = np.array(np.broadcast_to(grid + offset, (len(CHANNELS), grid.size)))
        value, by_samples = 0.0, np.zeros_like(samples)
        for weighted in terms:
            term_value, term_gradient = weighted.term.value_and_gradient(samples)
            value += weighted.weight * term_value
            by_samples += weighted.weight * term_gradient
        by_unknowns = by_samples @ scaled.T
        if len(start) == 1:
            by_unknowns = by_unknowns.sum(axis=0, keepdims=True)
        return value, by_unknowns.ravel()

    result = minimize(
        evaluate,
        (start / np.sqrt(grid.size)).ravel(),
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": MAX_ITERATIONS, "maxcor": 20},
    )
    return np.asarray(result.x.reshape(start.shape) * np.sqrt(grid.size))
