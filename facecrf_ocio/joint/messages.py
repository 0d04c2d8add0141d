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
from importlib.resources import files
from pathlib import Path

import numpy as np

from facecrf_ocio.joint.prior import Message
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.values import Float

COMBINED = "combined"  # the network that sees all cues
FARTHEST = 5.0  # standard deviations; training never saw statistics beyond
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
        """Statistics in standard deviations of those in training."""
        return np.clip((statistics - self.center) / self.scale, -FARTHEST, FARTHEST)

    def message(self, statistics: Float) -> Message:
        """What the cue says of one photo."""
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
    """

    members: Mapping[str, tuple[CueNetwork, ...]]

    def messages(self, statistics: Mapping[str, Float]) -> dict[str, Message]:
        """What each cue says; the members of the ensemble are averaged by their precisions."""
        if not statistics:
            return {}
        found = {}
        for cue, vector in {**statistics, COMBINED: self._combined(statistics)}.items():
            said = [network.message(vector) for network in self.members[cue]]
            precision = np.mean([m.precision for m in said], axis=0)
            pull = np.mean([m.precision * m.mean for m in said], axis=0)
            found[cue] = Message(pull / precision, precision)
        return found

    def _combined(self, statistics: Mapping[str, Float]) -> Float:
        """All statistics standardized, each cue's followed by 1; zeros for a cue not shown."""
        parts = []
        for cue in CUES:
            network = self.members[cue][0]
            if cue in statistics:
                parts += [network.standardized(statistics[cue]), np.ones(1)]
            else:
                parts.append(np.zeros(network.center.size + 1))
        return np.concatenate(parts)


def load_networks(path: Path) -> Networks:
    """Read the networks from the file that `train` writes."""
    with np.load(path) as stored:
        count = int(stored["ensemble"])
        return Networks(
            {
                cue: tuple(
                    CueNetwork(
                        stored[f"{cue}_{member}_center"].astype(np.float64),
                        stored[f"{cue}_{member}_scale"].astype(np.float64),
                        tuple(
                            (
                                stored[f"{cue}_{member}_weight{layer}"].astype(np.float64),
                                stored[f"{cue}_{member}_bias{layer}"].astype(np.float64),
                            )
                            for layer in range(4)
                        ),
                    )
                    for member in range(count)
                )
                for cue in (*CUES, COMBINED)
            }
        )


@cache
def shipped_networks() -> Networks:
    """The networks that ship."""
    return load_networks(Path(str(files("facecrf_ocio.joint") / "joint_model.npz")))
