"""The response model: curves as a mean plus a few eigenvectors, and how likely each is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from facecrf_ocio.files.smooth_arrays import SMOOTH, smooth_array, smooth_bytes
from facecrf_ocio.files.stored_arrays import load_arrays
from facecrf_ocio.response.mixture import Mixture
from facecrf_ocio.values import Float, InverseCRF, frozen

# Samples of a curve: linear between them, it follows gamma 2.2 within 2e-8 of white.
CURVE_SIZE = 4096
MIN_INCREMENT = 1e-7  # [linear] from sample to sample, or a LUT could not be inverted


@dataclass(frozen=True, slots=True, eq=False)
class ResponseModel:
    """Linear model of inverse camera responses, `g = g0 + H c` (eq. 9), and its prior (eq. 20).

    Attributes
    ----------
    grid
        (K,) uniform encoded values from 0 to 1.
    mean
        (K,) mean inverse response.
    basis
        (M, K) orthonormal eigenvectors, largest variance first, each with a positive sum.
    mixture
        Distribution of the coefficients of one channel.
    """

    grid: Float
    mean: Float
    basis: Float
    mixture: Mixture

    def __post_init__(self) -> None:
        for name in ("grid", "mean", "basis"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    def samples(self, coefficients: Float) -> Float:
        """Curves on the grid, (..., M) -> (..., K); neither clamped nor made monotone."""
        return np.asarray(self.mean + coefficients @ self.basis)

    def coefficients(self, samples: Float) -> Float:
        """Least-squares coefficients of curves on the grid, (..., K) -> (..., M).

        Eq. 19 with the H^T that its print lacks; H has orthonormal columns.
        """
        return np.asarray((samples - self.mean) @ self.basis.T)

    def inverse_crf(self, samples: Float) -> InverseCRF:
        """The valid curve nearest to samples (3, K) on the grid, at 4096 encoded values."""
        return inverse_crf(self.grid, samples)

    def save(self, path: Path) -> None:
        """Write the model as .npz, in single precision: 1e-7 of full scale, and half the bytes."""
        stored: dict[str, Any] = {
            f"mean{SMOOTH}": smooth_bytes(self.mean),
            f"basis{SMOOTH}": smooth_bytes(self.basis),
            "mixture_means": self.mixture.means.astype(np.float32),
            "mixture_covariances": self.mixture.covariances.astype(np.float32),
        }
        np.savez(path, **stored)


def inverse_crf(grid: Float, samples: Float) -> InverseCRF:
    """The valid curve nearest to samples (3, K) on a grid (K,), at 4096 encoded values."""
    encoded = np.linspace(0.0, 1.0, CURVE_SIZE)
    return InverseCRF(encoded, strictly_increasing([np.interp(encoded, grid, s) for s in samples]))


def strictly_increasing(samples: Float | list[Float]) -> Float:
    """Raise each curve's smaller increments to a minimum, then scale it to run from 0 to 1.

    Parameters
    ----------
    samples
        (C, K).
    """
    increments = np.maximum(np.diff(np.asarray(samples), axis=1), MIN_INCREMENT)
    curve = np.cumsum(increments / increments.sum(axis=1, keepdims=True), axis=1)
    curve[:, -1] = 1.0
    return np.pad(curve, ((0, 0), (1, 0)))


def load_model(path: Path) -> ResponseModel:
    """Read a model written by `ResponseModel.save`."""
    stored = load_arrays(path)
    mean, basis = (smooth_array(stored, name).astype(np.float64) for name in ("mean", "basis"))
    return ResponseModel(
        np.linspace(0.0, 1.0, mean.size),
        mean,
        _orthonormal(basis),
        Mixture(*(stored[f"mixture_{n}"].astype(np.float64) for n in ("means", "covariances"))),
    )


def _orthonormal(rows: Float) -> Float:
    """Rows that single precision left orthonormal to 1e-8, orthonormal to the last digit."""
    columns, mixing = np.linalg.qr(rows.T)
    return np.asarray((columns * np.sign(np.diag(mixing))).T)


@cache
def dorf_model() -> ResponseModel:
    """The model that ships: fitted to the 201 DoRF curves by `facecrf_ocio.response.fit_model`."""
    return load_model(Path(__file__).parent / "dorf_model.npz")
