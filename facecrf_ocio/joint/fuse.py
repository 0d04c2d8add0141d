"""Fusion: many messages into one, none of which may contradict all the others unpunished."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from facecrf_ocio.joint.prior import Message, Posterior


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
