"""The cues' networks in PyTorch: inputs, how their messages join, what is stored of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from facecrf_ocio.joint.messages import COMBINED, FARTHEST, LOG_PRECISION
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.values import Float

COEFFICIENTS = 12  # eleven of them meet the 20 solved responses to 0.034 stops over codes 16 to 64
_HIDDEN = (56, 48)  # units of one cue; chosen by judgment
_HIDDEN_COMBINED = (192, 96)  # units; 96 and 64 made no difference (0.106 stops)
# Deviations added to each statistic: 0.1 instead of 0.03 took RMSE x 100 from 2.42 to 2.36.
_JITTER = 0.1
_NO_MESSAGE = 1e-3  # precision of a cue that is not there: nothing beside the prior's 1, and not 0

Given = Mapping[str, tuple[Tensor, Tensor]]
"""Of each cue, standardized statistics (N, S) and whether an example shows it (N,)."""


class _Network(nn.Module):
    def __init__(self, size: int, hidden: tuple[int, int], dropout: float) -> None:
        super().__init__()
        uncertain = nn.Linear(hidden[1], COEFFICIENTS)
        nn.init.zeros_(uncertain.weight)
        nn.init.constant_(uncertain.bias, -2.0)
        self.layers = nn.ModuleList(
            [
                nn.Linear(size, hidden[0]),
                nn.Linear(hidden[0], hidden[1]),
                nn.Linear(hidden[1], COEFFICIENTS),
                uncertain,
            ]
        )
        self.dropout = nn.Dropout(dropout)

    def forward(self, statistics: Tensor) -> tuple[Tensor, Tensor]:
        hidden = statistics
        for layer in self.layers[:2]:
            hidden = self.dropout(torch.tanh(layer(hidden)))
        logs = torch.clamp(self.layers[3](hidden), *LOG_PRECISION)
        return self.layers[2](hidden), torch.exp(logs)


def new_networks(given: Given, dropout: float) -> nn.ModuleDict:
    """One network for each cue, and one that sees all of them."""
    networks = nn.ModuleDict(
        {cue: _Network(given[cue][0].shape[1], _HIDDEN, dropout) for cue in CUES}
    )
    combined_size = sum(statistics.shape[1] + 1 for statistics, _ in given.values())
    networks[COMBINED] = _Network(combined_size, _HIDDEN_COMBINED, dropout)
    return networks


def left_in(count: int, dropout: float) -> Tensor:
    """(N, cues and their combination) 1 but for what is left out at random."""
    return (torch.rand(count, len(CUES) + 1) >= dropout).float()


def fuse(
    networks: nn.ModuleDict, given: Given, chosen: Tensor, kept: Tensor
) -> tuple[Tensor, Tensor]:
    """Mean and precision (N, M) of all messages of some examples.

    Parameters
    ----------
    networks, given
        Of each cue.
    chosen
        (N,) indices of examples.
    kept
        (N, cues and their combination) as `left_in` gives it.
    """
    precision = torch.full((len(chosen), COEFFICIENTS), _NO_MESSAGE)
    pull = torch.zeros_like(precision)
    shown = []
    for number, (cue, (statistics, present)) in enumerate(given.items()):
        here = (present[chosen] * kept[:, number])[:, None]
        seen = statistics[chosen]
        seen = (seen + _JITTER * torch.randn_like(seen)) * here
        shown += [seen, here]
        mean, own = networks[cue](seen)
        precision = precision + own * here
        pull = pull + own * here * mean
    mean, own = networks[COMBINED](torch.cat(shown, 1))
    own = own * kept[:, -1:]
    return (pull + own * mean) / (precision + own), precision + own


def scaling_of(values: Float) -> tuple[Float, Float]:
    """Mean and standard deviation of statistics (N, S), of examples that show the cue."""
    known = np.asarray(values[~np.isnan(values).any(axis=1)], np.float64)
    return known.mean(axis=0), known.std(axis=0) + 1e-6


def inputs_of(values: Float, center: Float, scale: Float) -> tuple[Tensor, Tensor]:
    """Standardized statistics (N, S), zero where the cue is missing, and whether it is there."""
    present = np.asarray(~np.isnan(values).any(axis=1))
    standard = np.where(present[:, None], (values - center) / scale, 0.0)
    clipped = np.clip(standard, -FARTHEST, FARTHEST)
    return torch.tensor(clipped, dtype=torch.float32), torch.tensor(present, dtype=torch.float32)


def arrays_of(
    networks: nn.ModuleDict, scaling: Mapping[str, tuple[Float, Float]]
) -> dict[str, Float]:
    """By the names that `joint.messages.networks_of` looks for, without the member's number."""
    size: int = networks[COMBINED].layers[0].in_features  # type: ignore[union-attr,index,assignment]
    arrays = {}
    for cue, (center, scale) in {**scaling, COMBINED: (np.zeros(size), np.ones(size))}.items():
        arrays[f"{cue}/center"], arrays[f"{cue}/scale"] = center, scale
        layers: Any = networks[cue].layers
        for number, layer in enumerate(layers):
            arrays[f"{cue}/weight{number}"] = layer.weight.detach().numpy()
            arrays[f"{cue}/bias{number}"] = layer.bias.detach().numpy()
    return arrays
