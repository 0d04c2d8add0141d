"""Fusion: many messages into one, none of which may contradict all the others unpunished."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from facecrf_ocio.joint.prior import FamilyPrior, Message, Posterior
from facecrf_ocio.values import Float

# Degrees of freedom of the t distribution that stands behind each Gaussian message.
_FREEDOM = 4.0
_ROUNDS = 3  # of sharing anew, each by the shares before; chosen by judgment


def multiply(messages: Sequence[Message], shares: Sequence[float]) -> Message | None:
    """Product of Gaussian likelihoods, each to the power of its share; None of none."""
    if not messages:
        return None
    precision = np.sum([s * m.precision for s, m in zip(shares, messages, strict=True)], axis=0)
    pull = np.sum([s * m.precision * m.mean for s, m in zip(shares, messages, strict=True)], axis=0)
    return Message(pull / precision, precision)


def average(
    posteriors: Sequence[Posterior], trust: Sequence[float], correlation: float
) -> Posterior:
    """Weighted mean of estimates whose errors are alike in part, as one Gaussian.

    Parameters
    ----------
    posteriors
        One or more.
    trust
        Weight of each, in any unit.
    correlation
        Of the errors of any two: at 1 another photo tells nothing new, at 0 all of it is new.
    """
    shares = np.asarray(trust, dtype=np.float64) / np.sum(trust)
    mean = shares @ np.array([p.mean for p in posteriors])
    covariance = np.einsum("k,kmn->mn", shares, np.array([p.covariance for p in posteriors]))
    left = correlation + (1.0 - correlation) * float(shares @ shares)
    return Posterior(np.ones(1), mean[None], left * covariance[None])


def widened(posterior: Posterior, factor: float) -> Posterior:
    """The same mean, with a deviation that is `factor` times as large in every direction."""
    if factor == 1.0:
        return posterior
    mean = posterior.mean
    return Posterior(
        posterior.weights,
        mean + factor * (posterior.means - mean),
        factor**2 * posterior.covariances,
    )


def agreeing_shares(
    messages: Mapping[str, Message], prior: FamilyPrior, weights: Float
) -> dict[str, float]:
    """Share of each message, at most 1: what its distance from all the others leaves of it.

    The distance is measured between a message and the posterior without it, in units of both
    spreads; the share is the weight of a multivariate t distribution at that distance.
    """
    shares = dict.fromkeys(messages, 1.0)
    if len(messages) < 2:
        return shares
    for _ in range(_ROUNDS):
        shares = {name: _share(name, messages, shares, prior, weights) for name in messages}
    return shares


def _share(
    name: str,
    messages: Mapping[str, Message],
    shares: Mapping[str, float],
    prior: FamilyPrior,
    weights: Float,
) -> float:
    others = [other for other in messages if other != name]
    joined = multiply([messages[o] for o in others], [shares[o] for o in others])
    distance = squared_distance(messages[name], joined, prior, weights)
    size = prior.means.shape[1]
    return float(min(1.0, (_FREEDOM + size) / (_FREEDOM + distance)))


def squared_distance(
    message: Message, others: Message | None, prior: FamilyPrior, weights: Float
) -> float:
    """Squared Mahalanobis distance of a message from the posterior that others leave."""
    posterior = prior.posterior(others, weights)
    spread = posterior.covariance + np.diag(1.0 / message.precision)
    offset = message.mean - posterior.mean
    return float(offset @ np.linalg.solve(spread, offset))
