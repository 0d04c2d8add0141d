"""The weight of each cue, or photo, beside the others: who contradicts all of them counts less."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from facecrf_ocio.joint.fuse import multiply
from facecrf_ocio.joint.prior import FamilyPrior, Message
from facecrf_ocio.values import Float

# Degrees of freedom of the t distribution that stands behind each Gaussian message.
_FREEDOM = 4.0
_ROUNDS = 3  # of sharing anew, each by the shares before; chosen by judgment


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
