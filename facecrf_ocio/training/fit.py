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
from facecrf_ocio.joint.prior import FAMILIES, FamilyPrior
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.response.mixture import fit_mixture
from facecrf_ocio.training.agreement import Agreement
from facecrf_ocio.training.cue_networks import (
    COEFFICIENTS,
    arrays_of,
    fuse,
    inputs_of,
    left_in,
    new_networks,
    scaling_of,
)
from facecrf_ocio.training.likely_truths import LikelyTruths
from facecrf_ocio.training.parts import Examples
from facecrf_ocio.training.plan import AGREEMENT, EPOCHS, LIKELY_TRUTHS, MEMBERS
from facecrf_ocio.training.portraits import Versions
from facecrf_ocio.training.posterior import Loss, PosteriorLoss
from facecrf_ocio.training.weights import describe, save_joint
from facecrf_ocio.values import Float, Index

_BATCH = 256  # photos; chosen by judgment
_PAIRS = 64  # of versions of portraits, beside each batch; chosen by judgment
_VERSIONS = 64  # of portraits, whose truths are drawn, beside each batch; chosen by judgment
_SHARES = np.array([0.5, 0.25, 0.25])  # of the families in the mean and the spread
# What counts as one: an error of 3 %, a tenth of a stop in the tones and 0.3 in the shadows.
_ERROR, _TONES, _SHADOWS = 0.03, 0.1, 0.3
_LIKELIHOOD = 0.1  # weight of the log posterior beside the errors; chosen by judgment
_MOST_LIKELIHOOD = 60.0  # of one photo, so that no outlier outweighs its batch; chosen by judgment


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
    agreement
        Weight of how far estimates of two versions of a portrait are apart, where there are any.
    likely_truths
        Weight of what estimates of portraits are worth for truths as likely as cameras' are.
    """

    epochs: int = EPOCHS
    rate: float = 2e-3
    decay: float = 1e-2
    dropout: float = 0.1
    cue_dropout: float = 0.2
    told: float = 0.25
    members: int = MEMBERS
    agreement: float = AGREEMENT
    likely_truths: float = LIKELY_TRUTHS


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


def fit_networks(
    examples: Examples,
    prior: FamilyPrior,
    likely: FamilyPrior,
    analysis: Float,
    training: Training,
    seed: int,
    portraits: Versions | None = None,
) -> dict[str, Float]:
    """Train one network for each cue, and one that sees all of them, together.

    The prior is that of the fusion; truths of portraits are drawn from the likely one.

    Returns
    -------
    dict
        Arrays by the names under which `joint.messages.networks_of` finds them, without the
        member's number.
    """
    torch.manual_seed(seed)
    scaling = {cue: scaling_of(examples.by_cue[cue]) for cue in CUES}
    given = {cue: inputs_of(examples.by_cue[cue], *scaling[cue]) for cue in CUES}
    roots = np.sqrt(np.maximum(examples.inverse, 0.0))
    truth = torch.tensor((roots - prior.mean) @ analysis, dtype=torch.float32)
    family = torch.tensor(examples.family_of_kind)
    posterior = PosteriorLoss(prior)
    agreement = truths = None
    if portraits is not None:
        agreement = Agreement(prior, portraits, scaling)
        curves = portraits.curves.reshape(-1, portraits.curves.shape[2])
        truths = LikelyTruths(likely, analysis, curves, agreement.given)
    networks = new_networks(given, training.dropout)
    size = min(_BATCH, len(examples))
    batches = len(examples) // size
    optimizer = torch.optim.AdamW(networks.parameters(), training.rate, weight_decay=training.decay)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimizer, training.rate, total_steps=training.epochs * batches + 1
    )
    for _ in range(training.epochs):
        for chosen in torch.randperm(len(examples))[: batches * size].reshape(batches, size):
            mean, precision = fuse(networks, given, chosen, left_in(size, training.cue_dropout))
            luck = torch.rand(len(chosen))
            told, hinted = luck < training.told, luck > 1.0 - training.told
            weights = posterior.weights(family[chosen], told, hinted)
            total = _cost(posterior.judge(mean, precision, weights, truth[chosen]))
            if agreement is not None and truths is not None:
                apart = agreement.apart(networks, posterior, _PAIRS, training.cue_dropout)
                disagreement = (apart.error / _ERROR + apart.tones / _TONES).mean()
                real = truths.judge(networks, posterior, _VERSIONS, training.cue_dropout)
                total = total + training.agreement * disagreement
                total = total + training.likely_truths * _cost(real)
            optimizer.zero_grad()
            total.backward()  # type: ignore[no-untyped-call]
            nn.utils.clip_grad_norm_(networks.parameters(), 5.0)
            optimizer.step()
            schedule.step()
    return arrays_of(networks, scaling)


def _cost(loss: Loss) -> Tensor:
    """The mean over photos of what is minimized."""
    of_each = (
        _LIKELIHOOD * torch.clamp(loss.likelihood, max=_MOST_LIKELIHOOD)
        + loss.error / _ERROR
        + loss.tones / _TONES
        + loss.shadows / _SHADOWS
    )
    return of_each.mean()


def fit_joint(
    path: Path,
    examples: Examples,
    training: Training,
    held_out: str | None,
    without: Collection[str],
    simulated: Mapping[str, Any],
    portraits: Versions | None = None,
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
    portraits
        Whose versions shall agree, and whose truths are as likely as cameras' are, if any.
    """
    torch.set_num_threads(1)
    prior, analysis = fit_prior(np.asarray(examples.inverse, np.float64), examples.family_of_kind)
    # Not in the fusion before: networks that are fitted beside it trust it too much, since it was
    # made of curves that they see, and err more through those of other makers.
    likely = with_chart_cameras(prior, without)
    members = [
        fit_networks(examples, prior, likely, analysis, training, seed, portraits)
        for seed in range(training.members)
    ]
    made = {
        "examples": len(examples),
        "heads": len(set(examples.head.tolist())),
        "held_out": held_out or "",
        "portraits": 0 if portraits is None else len(portraits),
        **asdict(training),
        **simulated,
    }
    save_joint(path, likely, members, fit_familiarity(_standardized(examples)), describe(made))


def _standardized(examples: Examples) -> Float:
    """(N, S) what the network of all cues sees."""
    shown = []
    for cue in CUES:
        values = examples.by_cue[cue]
        statistics, present = inputs_of(values, *scaling_of(values))
        shown += [statistics.numpy(), present[:, None].numpy()]
    return np.asarray(np.concatenate(shown, axis=1), np.float64)
