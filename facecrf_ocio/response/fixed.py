"""Curves that need no photo: the answers every estimate must beat."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.estimators import ESTIMATORS, FIXED_CURVES
from facecrf_ocio.response.expected_stops import prior_in_stops
from facecrf_ocio.response.model import CURVE_SIZE, ResponseModel
from facecrf_ocio.values import CHANNELS, Confidence, Float, Verdict

FixedCurve = Callable[[Float, ResponseModel], Float]


def fixed_curve(name: str, encoded: Float, model: ResponseModel) -> Float:
    """Linear light (K,) at encoded values (K,) of a curve that does not look at the photo.

    Parameters
    ----------
    name
        One of `estimators.FIXED_CURVES`.
    encoded
        (K,) encoded values in [0, 1].
    model
        The response model whose mean is asked for.

    Raises
    ------
    SettingsError
        If the name is another.
    """
    if name not in FIXED_CURVES:
        raise SettingsError(f"no fixed curve {name!r}; known: {', '.join(FIXED_CURVES)}")
    curve: FixedCurve = ESTIMATORS[name].load()
    return curve(encoded, model)


def mean_curve(encoded: Float, model: ResponseModel) -> Float:
    """The response model's mean at encoded values of any shape, g0 of eq. 9 (Li et al. 2017)."""
    return np.interp(encoded, model.grid, model.mean)


def srgb_curve(encoded: Float, model: ResponseModel) -> Float:  # noqa: ARG001
    """IEC 61966-2-1."""
    return decode_srgb(encoded)


def gamma22_curve(encoded: Float, model: ResponseModel) -> Float:  # noqa: ARG001
    """A power of 2.2."""
    return np.asarray(encoded**2.2)


def identity_curve(encoded: Float, model: ResponseModel) -> Float:  # noqa: ARG001
    """Encoded values taken for light."""
    return np.asarray(encoded, dtype=np.float64)


def prior_confidence(model: ResponseModel, reason: str) -> Confidence:
    """Confidence of a curve that rests on nothing in the photo: the prior's own spread."""
    sigma = np.tile(curve_deviation(model), (len(CHANNELS), 1))
    coverage = np.zeros((len(CHANNELS), CURVE_SIZE))
    return Confidence(sigma, coverage, Verdict.PRIOR_ONLY, (reason,), prior_in_stops(model))


def curve_deviation(model: ResponseModel) -> Float:
    """Standard deviation of the mixture's curves at each code, (4096,)."""
    mixture = model.mixture
    offset = mixture.means - mixture.means.mean(axis=0)
    covariance = (mixture.covariances + offset[:, :, None] * offset[:, None, :]).mean(axis=0)
    variance = np.einsum("mk,mn,nk->k", model.basis, covariance, model.basis)
    codes = np.linspace(0.0, 1.0, CURVE_SIZE)
    return np.asarray(np.interp(codes, model.grid, np.sqrt(np.maximum(variance, 0.0))))
