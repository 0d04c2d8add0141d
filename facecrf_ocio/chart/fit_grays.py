"""From a few grays of known reflectance to a curve a channel, against the prior of responses.

In the root of light the prior is linear in its coefficients (`joint.prior`), and so is a gray of
light r: root(code) = t sqrt(r), t being the root of the unknown exposure. A lens lays glare on top
of every patch, r being what the patch reflects and g of white: sqrt(r + g) is taken as linear in g
about what is usual. All unknowns (the coefficients that the channels share, each channel's
departures, each channel's t, the one g) are then found in one step for each component of the prior,
with exact bands.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.joint.prior import FamilyPrior, Posterior
from facecrf_ocio.values import CHANNELS, Float

# Standard deviation of a channel's coefficients about those that the channels share, in units of
# the prior's. Rows of one film in DoRF are 0.1 to 0.6 apart, those solved from stacks 0.7 and more.
APART = 0.35
_EXPOSURE = 10.0  # [root of light] standard deviation of t: not known
_TOLERANCE = 0.015  # of a patch's light: charts fade, get dirty, and are made within about 1 %
# [white] Glare on top of every patch: its mean, and its standard deviation from photo to photo.
GLARE, _GLARE_SPREAD = 0.006, 0.004


@dataclass(frozen=True, slots=True, eq=False)
class Grays:
    """Patches of one channel that are used.

    Attributes
    ----------
    codes, deviation
        (N,) in [0, 1], and their standard deviations.
    light
        (N,) light in units of white, usual glare included.
    """

    codes: Float
    deviation: Float
    light: Float


@dataclass(frozen=True, slots=True, eq=False)
class GrayFit:
    """What the grays leave of the prior.

    Attributes
    ----------
    channels
        The coefficients of each channel.
    residual
        [stop] root mean square over all grays of what the curves miss.
    strain
        The same in standard deviations: above 1 where the grays disagree with every response.
    """

    channels: tuple[Posterior, ...]
    residual: float
    strain: float


def fit_grays(
    grays: tuple[Grays, ...], prior: FamilyPrior, weights: Float, roots: Float
) -> GrayFit:
    """Fit one curve a channel.

    Parameters
    ----------
    grays
        Of each channel.
    prior
        Of responses, with the weights of its components.
    roots
        (3, K) about what the roots of light are on the prior's grid, for the noise's size.
    """
    rows, right, spread = [], [], []
    for channel, one in enumerate(grays):
        row, value, deviation = _equations(channel, one, prior, roots[channel])
        rows.append(row / deviation[:, None])
        right.append(value / deviation)
        spread.append(deviation)
    system, target = np.concatenate(rows), np.concatenate(right)
    joined = _posterior(system, target, prior, weights)
    missed = target - system @ joined.mean
    level = np.concatenate(
        [np.interp(one.codes, prior.grid, roots[c]) for c, one in enumerate(grays)]
    )
    stops = 2.0 * missed * np.concatenate(spread) / level / np.log(2.0)
    return GrayFit(
        tuple(_of_channel(joined, c, prior.means.shape[1]) for c in range(len(CHANNELS))),
        float(np.sqrt((stops**2).mean())),
        float(np.sqrt((missed**2).mean())),
    )


def _equations(
    channel: int, grays: Grays, prior: FamilyPrior, roots: Float
) -> tuple[Float, Float, Float]:
    """Rows over (shared, departures of R, G, B, t of R, G, B, g), right sides, deviations."""
    size = prior.means.shape[1]
    basis = np.array([np.interp(grays.codes, prior.grid, b) for b in prior.basis]).T
    rows = np.zeros((len(grays.codes), (1 + len(CHANNELS)) * size + len(CHANNELS) + 1))
    rows[:, :size] = basis
    rows[:, (1 + channel) * size : (2 + channel) * size] = basis
    rows[:, (1 + len(CHANNELS)) * size + channel] = -np.sqrt(grays.light)
    level = np.maximum(np.interp(grays.codes, prior.grid, roots), 1e-3)
    exposure = float(np.median(level / np.sqrt(grays.light)))
    rows[:, -1] = -0.5 * exposure / np.sqrt(grays.light)
    slope = np.interp(grays.codes, prior.grid, np.gradient(roots, prior.grid))
    deviation = np.hypot(slope * grays.deviation, 0.5 * _TOLERANCE * level)
    return rows, -np.interp(grays.codes, prior.grid, prior.mean), deviation


def _posterior(system: Float, target: Float, prior: FamilyPrior, weights: Float) -> Posterior:
    """A Gaussian a component of the prior, as for any linear measurement.

    `system` (N, U) and `target` (N,) are in units of their noise.
    """
    size, count = prior.means.shape[1], len(CHANNELS)
    own = np.concatenate(
        [np.full(count * size, APART**2), np.full(count, _EXPOSURE**2), [_GLARE_SPREAD**2]]
    )
    means, covariances, logs = [], [], []
    for mean, covariance in zip(prior.means, prior.covariances, strict=True):
        before = np.zeros((system.shape[1],) * 2)
        before[:size, :size] = covariance
        before[range(size, len(before)), range(size, len(before))] = own
        start = np.concatenate([mean, np.zeros(count * size), np.full(count, 1.0), [0.0]])
        spread = system @ before @ system.T + np.eye(len(target))
        gain = np.linalg.solve(spread, system @ before).T
        miss = target - system @ start
        means.append(start + gain @ miss)
        covariances.append(before - gain @ system @ before)
        logs.append(-0.5 * (miss @ np.linalg.solve(spread, miss) + np.linalg.slogdet(spread)[1]))
    with np.errstate(divide="ignore"):
        share = np.log(weights) + np.array(logs)
    share = np.exp(share - share.max())
    return Posterior(share / share.sum(), np.array(means), np.array(covariances))


def _of_channel(joined: Posterior, channel: int, size: int) -> Posterior:
    """The shared coefficients plus the channel's own departures."""
    pick = np.zeros((size, joined.means.shape[1]))
    pick[range(size), range(size)] = 1.0
    pick[range(size), range((1 + channel) * size, (2 + channel) * size)] = 1.0
    return Posterior(joined.weights, joined.means @ pick.T, pick @ joined.covariances @ pick.T)
