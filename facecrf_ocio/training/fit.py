"""Fit the prior and the cues' networks of `joint`, end to end.

The networks are trained through the fusion: the loss is that of the posterior which the product of
the messages and the prior leaves, with cues left out at random. So a precision is what a cue adds
to the others, not what it could claim alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from facecrf_ocio.joint.messages import COMBINED, FARTHEST, LOG_PRECISION
from facecrf_ocio.joint.prior import FAMILIES, FamilyPrior
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.response.mixture import fit_mixture
from facecrf_ocio.training.simulate import Example
from facecrf_ocio.values import Float

COEFFICIENTS = 11
COMPONENTS = 10
HIDDEN = 48
_BATCH = 256
_ERROR_SCALE = 0.03
_JITTER = 0.1
_NO_MESSAGE = 1e-3


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
        Share of examples whose family is told to the prior.
    members
        Networks per cue, differing in their seed.
    """

    epochs: int = 40
    rate: float = 2e-3
    decay: float = 1e-2
    dropout: float = 0.1
    cue_dropout: float = 0.25
    told: float = 0.35
    members: int = 3


def fit_prior(inverse: Float, family: Float) -> tuple[FamilyPrior, Float]:
    """Eleven components and a mixture for each family, from drawn responses (N, 1024).

    Returns
    -------
    prior, analysis
        And the matrix (1024, 11) that gives the coefficients of a curve less the mean.
    """
    weights = np.where(family == 0, 1.0 / (family == 0).sum(), 1.0 / (family == 1).sum()) / 2.0
    mean = weights @ inverse
    _, scale, vectors = np.linalg.svd(
        (inverse - mean) * np.sqrt(weights)[:, None], full_matrices=False
    )
    vectors, scale = vectors[:COEFFICIENTS], scale[:COEFFICIENTS, None]
    analysis = (vectors / scale).T
    points = (inverse - mean) @ analysis
    mixtures = [
        fit_mixture(points[family == f][:4000], COMPONENTS, floor=3e-3, tolerance=1e-6)
        for f in range(len(FAMILIES))
    ]
    prior = FamilyPrior(
        np.linspace(0.0, 1.0, mean.size),
        mean,
        vectors * scale,
        np.full(COMPONENTS * len(FAMILIES), 1.0 / (COMPONENTS * len(FAMILIES))),
        np.concatenate([m.means for m in mixtures]),
        np.concatenate([m.covariances for m in mixtures]),
        np.repeat(np.arange(len(FAMILIES)), COMPONENTS),
    )
    return prior, analysis


class _Network(nn.Module):
    def __init__(self, size: int, dropout: float) -> None:
        super().__init__()
        uncertain = nn.Linear(HIDDEN, COEFFICIENTS)
        nn.init.zeros_(uncertain.weight)
        nn.init.constant_(uncertain.bias, -2.0)
        self.layers = nn.ModuleList(
            [
                nn.Linear(size, HIDDEN),
                nn.Linear(HIDDEN, HIDDEN),
                nn.Linear(HIDDEN, COEFFICIENTS),
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


class _Mixture:
    """The prior in PyTorch, and the posterior that a Gaussian message leaves of it."""

    def __init__(self, prior: FamilyPrior) -> None:
        self.means = torch.tensor(prior.means, dtype=torch.float32)
        self.covariances = torch.tensor(prior.covariances, dtype=torch.float32)
        self.basis = torch.tensor(prior.basis[:, ::4], dtype=torch.float32)
        self.family = torch.tensor(prior.family)
        self.log_weights = torch.tensor(np.log(prior.weights), dtype=torch.float32)
        self.roots = torch.linalg.cholesky(self.covariances)

    def weights(self, family: Tensor, told: Tensor) -> Tensor:
        logs = self.log_weights[None].expand(len(family), -1).clone()
        logs[told[:, None] & (self.family[None] != family[:, None])] = -30.0
        return logs

    def judge(
        self, mean: Tensor, precision: Tensor, log_weights: Tensor, truth: Tensor
    ) -> tuple[Tensor, Tensor]:
        """Negative log posterior of the truth, and the root mean square error of the mean curve."""
        variance = 1.0 / precision
        offset = self.means[None] - mean[:, None]
        solved, half_log_det = _Solve.apply(self.covariances, variance, offset)  # type: ignore[no-untyped-call]
        evidence = log_weights - 0.5 * (offset * solved).sum(-1) - half_log_det
        # What the covariance takes from a component's mean is what the message's variance adds to
        # the message's mean.
        moved = (torch.softmax(evidence, -1)[..., None] * solved).sum(1)
        error = (((mean + variance * moved - truth) @ self.basis) ** 2).mean(1)
        with torch.no_grad():
            away = (truth[:, None] - self.means[None]).transpose(0, 1).transpose(1, 2)
            from_prior = torch.linalg.solve_triangular(self.roots, away, upper=False)
            mahalanobis = (from_prior**2).sum(1).transpose(0, 1)
            prior = torch.logsumexp(log_weights - 0.5 * mahalanobis - _half_log_det(self.roots), -1)
        likelihood = (0.5 * torch.log(precision) - 0.5 * precision * (truth - mean) ** 2).sum(-1)
        loss = torch.logsumexp(evidence, -1) - prior - likelihood
        return loss, torch.sqrt(error + 1e-6)


class _Solve(torch.autograd.Function):
    """`(S_k + diag(v_n))^-1 x_nk` and half the log determinant, for all n and k.

    PyTorch's own derivative of a batched Cholesky factor takes five times as long as the factor;
    from the inverse it is one product.
    """

    @staticmethod
    def forward(
        ctx: Any, covariances: Tensor, variance: Tensor, x: Tensor
    ) -> tuple[Tensor, Tensor]:  # type: ignore[override]
        root = torch.linalg.cholesky(covariances[None] + torch.diag_embed(variance)[:, None])
        inverse = torch.cholesky_inverse(root)
        solved = (inverse @ x[..., None])[..., 0]
        ctx.save_for_backward(inverse, solved)
        return solved, _half_log_det(root)

    @staticmethod
    def backward(ctx: Any, of_solved: Tensor, of_log_det: Tensor) -> tuple[None, Tensor, Tensor]:  # type: ignore[override]
        inverse, solved = ctx.saved_tensors
        of_x = (inverse @ of_solved[..., None])[..., 0]
        diagonal = torch.diagonal(inverse, dim1=-2, dim2=-1)
        of_variance = 0.5 * of_log_det[..., None] * diagonal - of_x * solved
        return None, of_variance.sum(1), of_x


def fit_networks(
    examples: Sequence[Example],
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
    scaling = {cue: _scaling(examples, cue) for cue in CUES}
    given = {cue: _inputs(examples, cue, *scaling[cue]) for cue in CUES}
    truth = torch.tensor(
        (np.array([e.inverse for e in examples]) - prior.mean) @ analysis, dtype=torch.float32
    )
    family = torch.tensor([e.family for e in examples])
    mixture = _Mixture(prior)
    networks = nn.ModuleDict(
        {cue: _Network(given[cue][0].shape[1], training.dropout) for cue in CUES}
    )
    combined_size = sum(statistics.shape[1] + 1 for statistics, _ in given.values())
    networks[COMBINED] = _Network(combined_size, training.dropout)
    batches = len(examples) // _BATCH
    optimizer = torch.optim.AdamW(networks.parameters(), training.rate, weight_decay=training.decay)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimizer, training.rate, total_steps=training.epochs * batches + 1
    )
    for _ in range(training.epochs):
        for chosen in torch.randperm(len(examples))[: batches * _BATCH].reshape(batches, _BATCH):
            mean, precision = _fuse(networks, given, chosen, training.cue_dropout)
            told = torch.rand(len(chosen)) < training.told
            weights = mixture.weights(family[chosen], told)
            loss, error = mixture.judge(mean, precision, weights, truth[chosen])
            total = 0.1 * torch.clamp(loss, max=60.0).mean() + (error / _ERROR_SCALE).mean()
            optimizer.zero_grad()
            total.backward()  # type: ignore[no-untyped-call]
            nn.utils.clip_grad_norm_(networks.parameters(), 5.0)
            optimizer.step()
            schedule.step()
    return _arrays(networks, scaling)


def save_joint(
    path: Path, prior: FamilyPrior, members: Sequence[Mapping[str, Float]], band_scale: float
) -> None:
    """Write prior and networks as one .npz, the networks in half precision."""
    arrays: dict[str, Any] = {
        f"prior_{name}": np.asarray(getattr(prior, name), dtype=np.float32)
        for name in ("mean", "basis", "weights", "means", "covariances", "family")
    }
    for number, member in enumerate(members):
        for name, value in member.items():
            cue, part = name.split("/")
            exact = part in ("center", "scale")
            arrays[f"{cue}_{number}_{part}"] = value.astype(np.float32 if exact else np.float16)
    np.savez_compressed(
        path, ensemble=np.array(len(members)), band_scale=np.array(band_scale), **arrays
    )


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


def _scaling(examples: Sequence[Example], cue: str) -> tuple[Float, Float]:
    values = np.array([e.by_cue[cue] for e in examples if cue in e.by_cue])
    return values.mean(axis=0), values.std(axis=0) + 1e-6


def _inputs(
    examples: Sequence[Example], cue: str, center: Float, scale: Float
) -> tuple[Tensor, Tensor]:
    nothing = np.zeros_like(center)
    values = np.array(
        [(e.by_cue[cue] - center) / scale if cue in e.by_cue else nothing for e in examples]
    )
    present = np.array([cue in e.by_cue for e in examples])
    clipped = np.clip(values, -FARTHEST, FARTHEST)
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


def _half_log_det(root: Tensor) -> Tensor:
    """Half the log determinant of a covariance with this Cholesky root."""
    return torch.log(torch.diagonal(root, dim1=-2, dim2=-1)).sum(-1)
