"""How far a curve may be trusted: bands, coverage by evidence, and a verdict in words."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.response.model import CURVE_SIZE, ResponseModel
from facecrf_ocio.values import Confidence, Float, Verdict


def prior_confidence(model: ResponseModel, reason: str) -> Confidence:
    """Confidence of a curve that rests on no evidence: the prior's own spread."""
    sigma = np.tile(_prior_sigma(model), (3, 1))
    return Confidence(sigma, np.zeros((3, CURVE_SIZE)), Verdict.PRIOR_ONLY, (reason,))


def fitted_confidence(encoded: Float, model: ResponseModel) -> Confidence:
    """Confidence of a curve that was fitted to evidence at encoded values (N, 3)."""
    codes = np.linspace(0.0, 1.0, CURVE_SIZE)
    coverage = np.array([_coverage(values, codes) for values in encoded.T])
    return Confidence(np.tile(_prior_sigma(model), (3, 1)), coverage, Verdict.WEAK, ("",))


def _prior_sigma(model: ResponseModel) -> Float:
    """Standard deviation of the mixture's curves at each code."""
    mixture = model.mixture
    center = mixture.means.mean(axis=0)
    offset = mixture.means - center
    covariance = (mixture.covariances + offset[:, :, None] * offset[:, None, :]).mean(axis=0)
    variance = np.einsum("mk,mn,nk->k", model.basis, covariance, model.basis)
    codes = np.linspace(0.0, 1.0, CURVE_SIZE)
    return np.interp(codes, model.grid, np.sqrt(np.maximum(variance, 0.0)))


def _coverage(values: Float, codes: Float) -> Float:
    """Evidence near each code, relative to where it is densest; a window of 5 % of the range."""
    density = np.histogram(values, bins=64, range=(0.0, 1.0))[0].astype(np.float64)
    smooth = np.convolve(np.pad(density, 1), [0.25, 0.5, 0.25], mode="valid")
    centers = (np.arange(64) + 0.5) / 64.0
    return np.asarray(np.interp(codes, centers, smooth / max(smooth.max(), 1e-12)))
