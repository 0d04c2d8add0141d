"""The weight of each cue, or photo, beside the others: who contradicts all of them counts less."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from facecrf_ocio.joint.prior import FamilyPrior, Message, diagonal
from facecrf_ocio.values import Float

# Degrees of freedom of the t distribution that stands behind each Gaussian message.
_FREEDOM = 4.0
_ROUNDS = 3  # of sharing anew, each by the shares before; chosen by judgment


def agreeing_shares(
    messages: Mapping[str, Message], prior: FamilyPrior, weights: Float
) -> dict[str, float]:
    """Share of each message, at most 1: what its distance from all the others leaves of it.

    The distance is measured between a message and the posterior without it, in units of both
    spreads; the share is the weight of a multivariate t distribution at that distance. `weights`
    (C,) are those of the prior's components.
    """
    if len(messages) < 2:
        return dict.fromkeys(messages, 1.0)
    said = list(messages.values())
    means = np.array([message.mean for message in said])
    precisions = np.array([message.precision for message in said])
    others = 1.0 - np.eye(len(said))
    shares: Float = np.ones(len(said))
    for _ in range(_ROUNDS):
        joined = (others * shares) @ precisions
        pulls = (others * shares) @ (precisions * means)
        left = prior.posteriors(pulls / joined, joined, weights)
        distances = squared_distances(means, precisions, *left)
        shares = shares_at(distances, means.shape[1])
    return dict(zip(messages, shares.tolist(), strict=True))


def shares_at(distances: Float, coefficients: int) -> Float:
    """Weight of a multivariate t distribution at squared distances (...), at most 1."""
    return np.asarray(np.minimum(1.0, (_FREEDOM + coefficients) / (_FREEDOM + distances)))


def squared_distances(means: Float, precisions: Float, centers: Float, covariances: Float) -> Float:
    """(C,) squared Mahalanobis distance of each message from what the others leave.

    Parameters
    ----------
    means, precisions
        (C, M) of the messages.
    centers, covariances
        (C, M), (C, M, M) of the posterior without each.
    """
    offsets = means - centers
    spreads = covariances + diagonal(1.0 / precisions)
    return np.asarray((offsets * np.linalg.solve(spreads, offsets[..., None])[..., 0]).sum(axis=1))
