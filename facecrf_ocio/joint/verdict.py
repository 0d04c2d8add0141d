"""What the posterior says of its own error, and the verdict that follows from it.

The verdict speaks of accuracy alone: a curve near sRGB's can be reliable. Whether it differs from
sRGB is a statement of its own, `Confidence.differs_from_srgb`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.joint.prior import FamilyPrior, Posterior
from facecrf_ocio.response.expected_stops import (
    CHECKED_EVERY,
    FEWEST,
    expected_of_draws,
    rises,
    rising,
    share_nearer,
    stops_of_draws,
)
from facecrf_ocio.response.stops import places_of_codes, stops_of_light
from facecrf_ocio.values import Confidence, Float, Index, InStops, InverseCRF, Verdict

CHANNELS_APART = 0.16
"""Standard deviation of one channel's coefficients about those of all three, in units of the
prior's: at codes 32 to 224 it is within a factor of 1.4 what 16 films of DoRF (root mean square of
1.9 % of white over all codes) and 11 cameras solved from stacks (2.5 %) have in linear light."""
_DRAWS = 512  # quantiles of so many vary by 2 %
_PARTS = 32  # of them, for OpenBLAS: it shares a product of 2^18 multiplications and more


def doubted(confidence: Confidence, doubts: tuple[str, ...]) -> Confidence:
    """The same with further doubts: never `reliable` with any."""
    if not doubts:
        return confidence
    weak = confidence.verdict is Verdict.RELIABLE
    return replace(
        confidence,
        verdict=Verdict.WEAK if weak else confidence.verdict,
        doubts=(*confidence.doubts, *doubts),
    )


def judge(
    posterior: Posterior,
    found: InverseCRF,
    prior: FamilyPrior,
    band_scale: float,
    stops_scale: Float | tuple[float, float] = (1.0, 1.0),
) -> tuple[InStops, float]:
    """The expected error, and the share of possible curves that `found` is nearer to than sRGB.

    Parameters
    ----------
    posterior
        Over the prior's coefficients.
    found
        The curve of its mean.
    prior
        What coefficients mean.
    band_scale, stops_scale
        As `JointModel` explains, the latter (2,) for this photo's families.
    """
    truths = _rising_draws(posterior, prior, band_scale)
    estimate = found.linear[0]
    srgb = decode_srgb(found.encoded)
    told = expected_of_draws(estimate, truths)
    mid, shadows = stops_scale
    told = replace(told, mid=mid * told.mid, shadows=shadows * told.shadows)
    return told, share_nearer(estimate, srgb, truths)


def _rising_draws(posterior: Posterior, prior: FamilyPrior, band_scale: float) -> Float:
    """(N, 256) light in stops of those of 512 curves that rise; the same for the same posterior."""
    generator = np.random.default_rng(0)
    root = np.linalg.cholesky(posterior.covariance)
    steps = generator.standard_normal((_DRAWS, posterior.mean.size)) @ root.T
    drawn = posterior.mean + band_scale * steps
    # By a sixteenth of their samples, before all that are needed are there.
    good = drawn[rises(_samples(prior, drawn, slice(None, None, CHECKED_EVERY)))]
    if len(good) < FEWEST:
        return stops_of_draws(rising(_samples(prior, drawn, slice(None))))
    below, share = places_of_codes(prior.grid.size)
    beside = _samples(prior, good, np.concatenate([below, below + 1]))
    low, high = beside[:, : below.size], beside[:, below.size :]
    return stops_of_light(((1.0 - share) * low + share * high)[:, None])[:, 0]


def _samples(prior: FamilyPrior, drawn: Float, where: slice | Index) -> Float:
    """(N, K) curves of coefficients (N, M), at some samples, as `FamilyPrior.samples` gives them.

    In parts that BLAS multiplies in one thread: others would wait for more to do, and spin.
    """
    basis = prior.basis[:, where]  # once: an index copies it
    roots = np.concatenate([part @ basis for part in np.array_split(drawn, _PARTS)])
    roots += prior.mean[where]
    np.maximum(roots, 0.0, out=roots)
    return np.asarray(np.square(roots, out=roots))


def deviations(posterior: Posterior, prior: FamilyPrior, band_scale: float) -> Float:
    """(K,) standard deviation of any channel's light about the curve of `posterior`'s mean.

    The errors to expect in stops leave out how channels differ: on the stress bench they are what
    photos of both kinds have on the average, and with it no photo of 155 was `reliable`, where nine
    were, all of them rightly.
    """
    size = posterior.mean.size
    apart = Posterior(np.ones(1), posterior.mean[None], CHANNELS_APART**2 * np.eye(size)[None])
    return np.asarray(np.hypot(band_scale * prior.deviations(posterior), prior.deviations(apart)))
