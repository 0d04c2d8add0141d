"""The error in stops that is to be expected of a curve, from the curves that remain possible."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.response.stops import (
    CODES,
    DARKEST,
    MID_CODES,
    MID_GRAY,
    SHADOW_CODES,
    log_light,
    mean_over,
)
from facecrf_ocio.values import CHANNELS, Bool, Float, InStops, InverseCRF, Verdict

# Expected errors up to which an estimate is called reliable.
RELIABLE_MID = 0.1  # [stop] what a colorist sees side by side
RELIABLE_SHADOWS = 0.25  # [stop] little in the shadows, where sRGB decoding is off by one
# A Gaussian over coefficients holds curves that fall somewhere, and no camera has such a response.
# They are left out, as far as so many others remain that quantiles mean something.
FEWEST = 50
"""Curves, of which quantiles mean something."""
_DRAWS = 100  # of each component of a prior
CHECKED_EVERY = 16
"""Samples of 1,024: a dent narrower than 4 codes counts as none."""
# Of a Gaussian: share within one deviation, and mean distance over deviation.
_WITHIN_ONE = 0.6827
_MEAN_OF_DEVIATION = float(np.sqrt(2.0 / np.pi))  # mean of |x| of a standard normal variable


def verdict_of(expected: InStops) -> Verdict:
    """`reliable` or `weak`."""
    reliable = expected.mid <= RELIABLE_MID and expected.shadows <= RELIABLE_SHADOWS
    return Verdict.RELIABLE if reliable else Verdict.WEAK


def rises(checked: Float) -> Bool:
    """(N,) which curves rise, by every `CHECKED_EVERY`-th sample of each (N, K)."""
    return np.asarray((np.diff(checked, axis=1) > 0.0).all(axis=1))


def rising(draws: Float) -> Float:
    """Those of (N, K) curves that rise, or all made so where these are too few."""
    good = draws[rises(draws[:, ::CHECKED_EVERY])]
    chosen = good if len(good) >= FEWEST else np.maximum.accumulate(draws, axis=1)
    return np.asarray(np.maximum(chosen, 0.0))


def stops_of_draws(draws: Float) -> Float:
    """(N, 256) light in stops (`log_light`) of curves (N, L), each of one channel."""
    return log_light(draws[:, None])[:, 0]


def expected_of_draws(curve: Float, truths: Float) -> InStops:
    """What to expect of an estimate, given curves that may be the truth.

    Parameters
    ----------
    curve
        (K,) the estimate, one for all channels, at uniform encoded values.
    truths
        (N, 256) possible truths, as `stops_of_draws` gives them.

    Returns
    -------
    InStops
        Deviations are half the range that holds 68 % of the draws, errors are medians over the
        draws: a few draws with crushed shadows would decide means.
    """
    errors = np.abs(truths - log_light(curve))
    sigma = _quantile(errors, _WITHIN_ONE)
    mid, shadows = (
        float(np.median(errors[:, first : last + 1].mean(axis=1)))
        for first, last in (MID_CODES, SHADOW_CODES)
    )
    return InStops(np.tile(sigma, (len(CHANNELS), 1)), mid, shadows)


def _quantile(values: Float, share: float) -> Float:
    """(K,) quantile of each column of (N, K), as NumPy has it, in a fifth of its time."""
    ordered = np.sort(np.ascontiguousarray(values.T), axis=1)
    place = share * (len(values) - 1)
    before = min(int(place), max(len(values) - 2, 0))
    low, high = ordered[:, before], ordered[:, min(before + 1, len(values) - 1)]
    return np.asarray(low + (high - low) * (place - before))


def expected_of_sigma(curve: InverseCRF, sigma: Float) -> InStops:
    """What to expect where only deviations of linear light are known, (3, K) along the curve.

    To first order, log2 of light deviates by sigma / (light ln 2); codes are taken as independent
    of mid-gray, where the factor is taken out.
    """
    codes = CODES / CODES[-1]
    light = np.array([np.interp(codes, curve.encoded, row) for row in curve.linear])
    deviation = np.array([np.interp(codes, curve.encoded, row) for row in np.nan_to_num(sigma)])
    relative = deviation / np.maximum(light, np.finfo(np.float64).tiny) / np.log(2.0)
    # A deviation of light as large as light itself: nothing is known but that it is dark.
    relative = np.minimum(relative, -DARKEST)
    return expected_of_deviation(np.hypot(relative, relative[:, [MID_GRAY]]))


def expected_of_deviation(deviation: Float) -> InStops:
    """What to expect of deviations in stops, (3, 256), with the factor taken out at mid-gray."""
    stops = np.minimum(deviation, -DARKEST)
    stops[:, MID_GRAY] = 0.0
    mid, shadows = (
        _MEAN_OF_DEVIATION * mean_over(stops, span) for span in (MID_CODES, SHADOW_CODES)
    )
    return InStops(stops, mid, shadows)


def prior_in_stops(model: ResponseModel, scale: float = 1.0) -> InStops:
    """The prior's spread about its mean, times a scale: all that is known of a curve without more.

    The published estimators' own errors are told by it too, times what they were measured to be.
    """
    spread = _prior_spread(model)
    return InStops(scale * spread.sigma, scale * spread.mid, scale * spread.shadows)


@lru_cache(maxsize=8)
def _prior_spread(model: ResponseModel) -> InStops:
    mixture, generator = model.mixture, np.random.default_rng(0)
    drawn = [
        generator.multivariate_normal(mean, covariance, _DRAWS)
        for mean, covariance in zip(mixture.means, mixture.covariances, strict=True)
    ]
    draws = rising(model.samples(np.concatenate(drawn)))
    return expected_of_draws(model.mean, stops_of_draws(draws))


def share_nearer(curve: Float, other: Float, truths: Float) -> float:
    """Share of possible truths (N, 256) to which a curve (K,) is nearer than another, in stops."""
    span = slice(MID_CODES[0], MID_CODES[1] + 1)
    ours, theirs = (
        np.abs(truths[:, span] - log_light(one)[span]).mean(axis=1) for one in (curve, other)
    )
    return float((ours < theirs).mean())
