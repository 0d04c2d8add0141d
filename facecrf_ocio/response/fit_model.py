"""Fit the response model: `python -m facecrf_ocio.response.fit_model dorf.mat model.npz`."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from facecrf_ocio.response.dorf import read_dorf_inverse
from facecrf_ocio.response.mixture import fit_mixture
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.values import Float

BASIS_SIZE = 5  # eigenvectors, N of eq. 9
MIXTURE_SIZE = 5  # Gaussians of eq. 20


def fit_model(
    curves: Float, basis_size: int = BASIS_SIZE, mixture_size: int = MIXTURE_SIZE
) -> ResponseModel:
    """Fit mean, eigenvectors and mixture to inverse curves (sec. 4, eq. 9, 19-20).

    Parameters
    ----------
    curves
        (C, K) inverse responses on a uniform grid of encoded values.
    """
    mean = curves.mean(axis=0)
    _, _, vectors = np.linalg.svd(curves - mean, full_matrices=False)
    basis = vectors[:basis_size] * np.sign(vectors[:basis_size].sum(axis=1, keepdims=True))
    coefficients = (curves - mean) @ basis.T
    grid = np.linspace(0.0, 1.0, curves.shape[1])
    return ResponseModel(grid, mean, basis, fit_mixture(coefficients, mixture_size))


def main(arguments: list[str]) -> int:
    """Read the DoRF file named first and write the model to the path named second."""
    if len(arguments) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    fit_model(read_dorf_inverse(arguments[0])).save(Path(arguments[1]))
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
