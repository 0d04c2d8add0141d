"""From a cue's statistics to what it says of the response: small networks, run with numpy.

Each network answers with a mean and a precision for every coefficient. They were trained together,
with cues left out at random, so that the precisions hold for any set of cues a photo shows: what
two cues share is not counted twice. One more network sees the statistics of all cues at once, for
what only their relation tells, such as noise beside the brightness of the skin.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from facecrf_ocio.files.stored_arrays import load_arrays
from facecrf_ocio.joint.familiarity import Familiarity, familiarity_of
from facecrf_ocio.joint.prior import Message
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.joint.whole_steps import exact_array
from facecrf_ocio.values import Float

COMBINED = "combined"  # the network that sees all cues
FARTHEST = 5.0  # standard deviations; training never saw statistics beyond
# Deviations of e^4 to e^-3 of the prior's units: nothing said, and almost sure.
LOG_PRECISION = (-8.0, 6.0)


@dataclass(frozen=True, slots=True, eq=False)
class CueNetwork:
    """One cue's network: two hidden layers, and a linear head each for mean and log precision.

    Attributes
    ----------
    center, scale
        (S,) mean and standard deviation of the statistics in training.
    layers
        Weights (out, in) and biases (out,) of the first and the second layer, the head of the
        means, and the head of the log precisions.
    """

    center: Float
    scale: Float
    layers: tuple[tuple[Float, Float], ...]

    def standardized(self, statistics: Float) -> Float:
        """Statistics (S,) in standard deviations of those in training."""
        return np.clip((statistics - self.center) / self.scale, -FARTHEST, FARTHEST)

    def message(self, statistics: Float) -> Message:
        """What the cue says of one photo, by its statistics (S,)."""
        hidden = self.standardized(statistics)
        for weight, bias in self.layers[:2]:
            hidden = np.tanh(weight @ hidden + bias)
        (to_mean, mean_bias), (to_log, log_bias) = self.layers[2:]
        logs = np.clip(to_log @ hidden + log_bias, *LOG_PRECISION)
        return Message(to_mean @ hidden + mean_bias, np.exp(logs))


@dataclass(frozen=True, slots=True, eq=False)
class Networks:
    """An ensemble of networks for every cue, and for all cues combined.

    Attributes
    ----------
    members
        For each cue, and for `COMBINED`, its networks.
    familiarity
        Of the statistics in training.
    """

    members: Mapping[str, tuple[CueNetwork, ...]]
    familiarity: Familiarity | None = None

    def stretch(self, statistics: Mapping[str, Float]) -> float:
        """By how much a posterior is wider because training saw no such photo; at least 1."""
        if self.familiarity is None or not statistics:
            return 1.0
        return self.familiarity.stretch(self.combined(statistics))

    def messages(self, statistics: Mapping[str, Float]) -> dict[str, Message]:
        """What each cue says; the members of the ensemble are averaged by their precisions."""
        if not statistics:
            return {}
        found = {}
        for cue, vector in {**statistics, COMBINED: self.combined(statistics)}.items():
            said = [network.message(vector) for network in self.members[cue]]
            precision = np.mean([m.precision for m in said], axis=0)
            pull = np.mean([m.precision * m.mean for m in said], axis=0)
            found[cue] = Message(pull / precision, precision)
        return found

    def combined(self, statistics: Mapping[str, Float]) -> Float:
        """(N,) all statistics standardized, each cue's followed by 1; zeros for a cue not shown."""
        parts = []
        for cue in CUES:
            network = self.members[cue][0]
            if cue in statistics:
                parts += [network.standardized(statistics[cue]), np.ones(1)]
            else:
                parts.append(np.zeros(network.center.size + 1))
        return np.concatenate(parts)


def networks_of(arrays: Mapping[str, Float]) -> Networks:
    """The networks in the arrays of a file of weights."""
    members = range(int(arrays["ensemble"]))
    return Networks(
        {cue: tuple(_network(arrays, cue, m) for m in members) for cue in (*CUES, COMBINED)},
        familiarity_of(arrays),
    )


def _network(arrays: Mapping[str, Float], cue: str, member: int) -> CueNetwork:
    """All networks of a cue were shown the same statistics, so their scaling is stored once."""

    def stored(part: str) -> Float:
        return exact_array(arrays, f"{cue}_{part}")

    layers = tuple((stored(f"{member}_weight{n}"), stored(f"{member}_bias{n}")) for n in range(4))
    return CueNetwork(stored("center"), stored("scale"), layers)


@cache
def shipped_networks() -> Networks:
    """The networks that ship."""
    return networks_of(load_arrays(Path(__file__).parent / "joint_model.npz"))
