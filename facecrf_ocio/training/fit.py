"""Fit the prior and the cues' networks of `joint`, end to end.

The networks are trained through the fusion: the loss is that of the posterior which the product of
the messages and the prior leaves, with cues left out at random. So a precision is what a cue adds
to the others, not what it could claim alone.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from facecrf_ocio.benchmark.chart_cameras import FITTED, with_chart_cameras
from facecrf_ocio.joint.familiarity import fit_familiarity
from facecrf_ocio.joint.messages import COMBINED, FARTHEST, LOG_PRECISION
from facecrf_ocio.joint.prior import FAMILIES, FamilyPrior
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.response.mixture import fit_mixture
from facecrf_ocio.training.parts import Examples
from facecrf_ocio.training.plan import EPOCHS, MEMBERS
from facecrf_ocio.training.posterior import PosteriorLoss
from facecrf_ocio.training.weights import describe, save_joint
from facecrf_ocio.values import Float, Index

COEFFICIENTS = 12  # eleven of them meet the 20 solved responses to 0.034 stops over codes 16 to 64
HIDDEN = (56, 48)  # units of one cue; chosen by judgment
HIDDEN_COMBINED = (192, 96)  # units; 96 and 64 made no difference (0.106 stops)
_BATCH = 256  # photos; chosen by judgment
_SHARES = np.array([0.5, 0.25, 0.25])  # of the families in the mean and the spread
# What counts as one: an error of 3 %, a tenth of a stop in the tones and 0.3 in the shadows.
_ERROR, _TONES, _SHADOWS = 0.03, 0.1, 0.3
_LIKELIHOOD = 0.1  # weight of the log posterior beside the errors; chosen by judgment
_MOST_LIKELIHOOD = 60.0  # of one photo, so that no outlier outweighs its batch; chosen by judgment
# Deviations added to each statistic: 0.1 instead of 0.03 took RMSE x 100 from 2.42 to 2.36.
_JITTER = 0.1
_NO_MESSAGE = 1e-3  # precision of a cue that is not there: nothing beside the prior's 1, and not 0


@dataclass(frozen=True, slots=True)
class Training:
    """How the networks are trained.

    Attributes
    ----------
    epochs, rate, decay
        Passes over the examples, largest learning rate, weight decay (AdamW, one cycle).
    dropout, cue_dropout
        Share of hidden units, and of cues, left out at random.
    told
        Share of examples whose family is told to the prior, and as many again of which it is told
        only whether the response is of film or modern.
    members
        Networks per cue, differing in their seed.
    """

    epochs: int = EPOCHS
    rate: float = 2e-3
    decay: float = 1e-2
    dropout: float = 0.1
    cue_dropout: float = 0.2
    told: float = 0.25
    members: int = MEMBERS


def fit_prior(inverse: Float, family: Index) -> tuple[FamilyPrior, Float]:
    """Twelve components and a mixture for each family, from drawn responses (N, 1024).

    Returns
    -------
    prior, analysis
        And the matrix (1024, 12) that gives the coefficients of a curve's root less the mean.
    """
    roots = np.sqrt(np.maximum(inverse, 0.0))
    of_family = np.bincount(family, minlength=len(FAMILIES))
    weights = _SHARES[family] / of_family[family]
    mean = weights @ roots
    spread = (roots - mean) * np.sqrt(weights)[:, None]
    values, vectors = np.linalg.eigh(spread.T @ spread)
    vectors = vectors[:, ::-1][:, :COEFFICIENTS].T
    scale = np.sqrt(values[::-1][:COEFFICIENTS, None])
    analysis = (vectors / scale).T
    points = (roots - mean) @ analysis
    mixtures = [
        fit_mixture(points[family == f][:4000], FITTED[f], floor=3e-3, tolerance=1e-6)
        for f in range(len(FAMILIES))
    ]
    prior = FamilyPrior(
        np.linspace(0.0, 1.0, mean.size),
        mean,
        vectors * scale,
        np.concatenate([np.full(size, 1.0 / size) for size in FITTED]) / len(FAMILIES),
        np.concatenate([m.means for m in mixtures]),
        np.concatenate([m.covariances for m in mixtures]),
        np.repeat(np.arange(len(FAMILIES)), FITTED),
    )
    return prior, analysis


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


def fit_networks(
    examples: Examples,
    prior: FamilyPrior,
    analysis: Float,
    training: Training,
    seed: int,
) -> dict[str, Float]:
    """Train one network for each cue, and one that sees all of them, together.

    Returns
    -------
    dict
        Arrays by the names under which `joint.messages.load_networks` finds them, without the
        member's number.
    """
    torch.manual_seed(seed)
    scaling = {cue: _scaling(examples.by_cue[cue]) for cue in CUES}
    given = {cue: _inputs(examples.by_cue[cue], *scaling[cue]) for cue in CUES}
    roots = np.sqrt(np.maximum(examples.inverse, 0.0))
    truth = torch.tensor((roots - prior.mean) @ analysis, dtype=torch.float32)
    family = torch.tensor(examples.family_of_kind)
    posterior = PosteriorLoss(prior)
    networks = nn.ModuleDict(
        {cue: _Network(given[cue][0].shape[1], HIDDEN, training.dropout) for cue in CUES}
    )
    combined_size = sum(statistics.shape[1] + 1 for statistics, _ in given.values())
    networks[COMBINED] = _Network(combined_size, HIDDEN_COMBINED, training.dropout)
    size = min(_BATCH, len(examples))
    batches = len(examples) // size
    optimizer = torch.optim.AdamW(networks.parameters(), training.rate, weight_decay=training.decay)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimizer, training.rate, total_steps=training.epochs * batches + 1
    )
    for _ in range(training.epochs):
        for chosen in torch.randperm(len(examples))[: batches * size].reshape(batches, size):
            mean, precision = _fuse(networks, given, chosen, training.cue_dropout)
            luck = torch.rand(len(chosen))
            told, hinted = luck < training.told, luck > 1.0 - training.told
            weights = posterior.weights(family[chosen], told, hinted)
            loss = posterior.judge(mean, precision, weights, truth[chosen])
            total = (
                _LIKELIHOOD * torch.clamp(loss.likelihood, max=_MOST_LIKELIHOOD)
                + loss.error / _ERROR
                + loss.tones / _TONES
                + loss.shadows / _SHADOWS
            ).mean()
            optimizer.zero_grad()
            total.backward()  # type: ignore[no-untyped-call]
            nn.utils.clip_grad_norm_(networks.parameters(), 5.0)
            optimizer.step()
            schedule.step()
    return _arrays(networks, scaling)


def fit_joint(
    path: Path,
    examples: Examples,
    training: Training,
    held_out: str | None,
    without: Collection[str],
    simulated: Mapping[str, Any],
) -> None:
    """Fit prior and networks, and write them with what made them.

    Parameters
    ----------
    path
        To write.
    examples, training
        What is fitted to, and how.
    held_out, without
        Name of the weights that the bench needs, and the makers that they must not see.
    simulated
        What the file shall tell of how the examples were made.
    """
    torch.set_num_threads(1)
    prior, analysis = fit_prior(np.asarray(examples.inverse, np.float64), examples.family_of_kind)
    members = [
        fit_networks(examples, prior, analysis, training, seed) for seed in range(training.members)
    ]
    made = {
        "examples": len(examples),
        "heads": len(set(examples.head.tolist())),
        "held_out": held_out or "",
        **asdict(training),
        **simulated,
    }
    # Not before: networks that are fitted beside it trust it too much, since it was made of curves
    # that they see, and err more through those of other makers.
    prior = with_chart_cameras(prior, without)
    save_joint(path, prior, members, fit_familiarity(_standardized(examples)), describe(made))


def _standardized(examples: Examples) -> Float:
    """(N, S) what the network of all cues sees."""
    shown = []
    for cue in CUES:
        values = examples.by_cue[cue]
        statistics, present = _inputs(values, *_scaling(values))
        shown += [statistics.numpy(), present[:, None].numpy()]
    return np.asarray(np.concatenate(shown, axis=1), np.float64)


def _fuse(
    networks: nn.ModuleDict,
    given: Mapping[str, tuple[Tensor, Tensor]],
    chosen: Tensor,
    cue_dropout: float,
) -> tuple[Tensor, Tensor]:
    """Mean and precision of all messages but those left out at random."""
    precision = torch.full((len(chosen), COEFFICIENTS), _NO_MESSAGE)
    pull = torch.zeros_like(precision)
    shown = []
    for cue, (statistics, present) in given.items():
        kept = (present[chosen] * (torch.rand(len(chosen)) >= cue_dropout))[:, None]
        seen = statistics[chosen]
        seen = (seen + _JITTER * torch.randn_like(seen)) * kept
        shown += [seen, kept]
        mean, own = networks[cue](seen)
        precision = precision + own * kept
        pull = pull + own * kept * mean
    mean, own = networks[COMBINED](torch.cat(shown, 1))
    own = own * (torch.rand(len(chosen)) >= cue_dropout)[:, None]
    return (pull + own * mean) / (precision + own), precision + own


def _scaling(values: Float) -> tuple[Float, Float]:
    known = np.asarray(values[~np.isnan(values).any(axis=1)], np.float64)
    return known.mean(axis=0), known.std(axis=0) + 1e-6


def _inputs(values: Float, center: Float, scale: Float) -> tuple[Tensor, Tensor]:
    present = np.asarray(~np.isnan(values).any(axis=1))
    standard = np.where(present[:, None], (values - center) / scale, 0.0)
    clipped = np.clip(standard, -FARTHEST, FARTHEST)
    return torch.tensor(clipped, dtype=torch.float32), torch.tensor(present, dtype=torch.float32)


def _arrays(
    networks: nn.ModuleDict, scaling: Mapping[str, tuple[Float, Float]]
) -> dict[str, Float]:
    size: int = networks[COMBINED].layers[0].in_features  # type: ignore[union-attr,index,assignment]
    arrays = {}
    for cue, (center, scale) in {**scaling, COMBINED: (np.zeros(size), np.ones(size))}.items():
        arrays[f"{cue}/center"], arrays[f"{cue}/scale"] = center, scale
        layers: Any = networks[cue].layers
        for number, layer in enumerate(layers):
            arrays[f"{cue}/weight{number}"] = layer.weight.detach().numpy()
            arrays[f"{cue}/bias{number}"] = layer.bias.detach().numpy()
    return arrays
