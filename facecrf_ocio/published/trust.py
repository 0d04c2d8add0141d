"""How far a curve may be trusted: bands, coverage by evidence, and a verdict in words."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.response.model import CURVE_SIZE, ResponseModel
from facecrf_ocio.settings import VERDICTS
from facecrf_ocio.values import CHANNELS, Confidence, Estimate, Float, Outcome, Verdict

COVERAGE_BINS = 64

_FACE = (
    "the exponent of the curve rests on the prior: the estimator does not see it",
    "on test faces the estimator was seldom nearer to the truth than the mean curve",
)
_RIVAL = ("on test faces the estimator was two to three times as far off as the mean curve",)
_PLANES = ("noisy test faces showed this estimator too little for a measurement of its error",)
_NOISE = ("on test faces the estimator was as far off as the mean curve",)
_REASONS = {
    "face": _FACE,
    "face-unshaded": _FACE,
    "edge": _RIVAL,
    "geometry-invariant": _PLANES,
    "intensity-similarity": _NOISE,
    "rank": _RIVAL,
}
# Mean error on the rendered development heads over that of the mean curve, where it is larger
# than the prior's spread allows for.
_BAND_SCALE = {"edge": 2.3, "rank": 3.3}


def demand(estimate: Estimate, least: str) -> Estimate:
    """The estimate, or a refusal where its verdict is below the least wanted.

    Parameters
    ----------
    estimate
        With or without a curve.
    least
        One of `settings.VERDICTS`.
    """
    if estimate.found is None or estimate.confidence is None:
        return estimate
    verdict = str(estimate.confidence.verdict)
    if VERDICTS.index(verdict) >= VERDICTS.index(least):
        return estimate
    return Estimate(
        Outcome.NOT_CALIBRATED,
        estimate.estimator,
        f"the estimate is {verdict}, and {least} was asked for "
        f"({'; '.join(estimate.confidence.reasons)})",
        "use a larger, unretouched face, several photos together, or ask for less",
    )


def prior_confidence(model: ResponseModel, reason: str) -> Confidence:
    """Confidence of a curve that rests on no evidence: the prior's own spread."""
    sigma = np.tile(_prior_sigma(model), (len(CHANNELS), 1))
    coverage = np.zeros((len(CHANNELS), CURVE_SIZE))
    return Confidence(sigma, coverage, Verdict.PRIOR_ONLY, (reason,))


def fitted_confidence(estimator: str, encoded: Float, model: ResponseModel) -> Confidence:
    """Confidence of a curve that an estimator fitted to evidence at encoded values (N, 3).

    The band is the prior's spread: on the rendered development heads, photographed through
    curves that the prior had not seen, 90 % of the face estimators' errors were below 1.68 sigma
    (`face`) and 1.56 sigma (`face-unshaded`), where 1.645 is right. Nothing is called reliable,
    because on those heads the mean curve was nearer to the truth in nine cases of ten. Estimators
    that were further off there get a wider band.
    """
    codes = np.linspace(0.0, 1.0, CURVE_SIZE)
    coverage = np.array([_coverage(values, codes) for values in encoded.T])
    scale = _BAND_SCALE.get(estimator, 1.0)
    sigma = np.tile(scale * _prior_sigma(model), (len(CHANNELS), 1))
    low, high = np.quantile(encoded, [0.05, 0.95])
    span = f"the evidence lies between the encoded values {low:.2f} and {high:.2f}"
    return Confidence(sigma, coverage, Verdict.WEAK, (span, *_REASONS[estimator]))


def _prior_sigma(model: ResponseModel) -> Float:
    """Standard deviation of the mixture's curves at each code, (4096,)."""
    mixture = model.mixture
    offset = mixture.means - mixture.means.mean(axis=0)
    covariance = (mixture.covariances + offset[:, :, None] * offset[:, None, :]).mean(axis=0)
    variance = np.einsum("mk,mn,nk->k", model.basis, covariance, model.basis)
    codes = np.linspace(0.0, 1.0, CURVE_SIZE)
    return np.asarray(np.interp(codes, model.grid, np.sqrt(np.maximum(variance, 0.0))))


def _coverage(values: Float, codes: Float) -> Float:
    """Evidence near each code, relative to where it is densest."""
    counts = np.histogram(values, bins=COVERAGE_BINS, range=(0.0, 1.0))[0].astype(np.float64)
    smooth = np.convolve(np.pad(counts, 1), [0.25, 0.5, 0.25], mode="valid")
    centers = (np.arange(COVERAGE_BINS) + 0.5) / COVERAGE_BINS
    return np.asarray(np.interp(codes, centers, smooth / max(smooth.max(), 1e-12)))
