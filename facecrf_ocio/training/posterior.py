"""The posterior that messages leave of the prior, in PyTorch, and what it costs to be wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from torch import Tensor

from facecrf_ocio.joint.prior import FamilyPrior

_NOT_IT = -30.0  # log weight of a family that is told not to be the photo's
SMALLEST = 4e-3  # root of light, below which stops are not told apart
_MIDDLE = 128  # [code value] where the free factor of light is taken out, as the bench does
_TONES, _SHADOWS = (64, 236), (16, 65)  # codes
_STEP = 4  # codes


@dataclass(frozen=True, slots=True)
class Loss:
    """Of each photo, (N,).

    Attributes
    ----------
    likelihood
        Negative log posterior of the truth.
    error
        Root mean square error of the mean curve in linear light, white at 1.
    tones, shadows
        [stops] Mean distance over codes 64 to 235 and 16 to 64, equal light at code 128.
    """

    likelihood: Tensor
    error: Tensor
    tones: Tensor
    shadows: Tensor


class PosteriorLoss:
    """The prior, and how far the posterior of a Gaussian message is from the truth."""

    def __init__(self, prior: FamilyPrior) -> None:
        self.means = torch.tensor(prior.means, dtype=torch.float32)
        self.covariances = torch.tensor(prior.covariances, dtype=torch.float32)
        self.family = torch.tensor(prior.family)
        self.log_weights = torch.tensor(np.log(prior.weights), dtype=torch.float32)
        self.roots = torch.linalg.cholesky(self.covariances)
        codes = np.arange(0, 256, _STEP) / 255.0
        at = [np.interp(codes, prior.grid, row) for row in (prior.mean, *prior.basis)]
        self.mean = torch.tensor(np.array(at[0]), dtype=torch.float32)
        self.basis = torch.tensor(np.array(at[1:]), dtype=torch.float32)
        self.codes = torch.arange(0, 256, _STEP)

    def weights(self, family: Tensor, told: Tensor, hinted: Tensor) -> Tensor:
        """Log weights (N, K) of the components as `FamilyPrior.weights_for` has them.

        Some photos' family is told; of some it is only told whether it is film's or a modern one;
        of the others nothing, and each is as likely as the others (`joint.metadata.UNTOLD`).
        """
        logs = self.log_weights[None].expand(len(family), -1).clone()
        other = self.family[None] != family[:, None]
        other_kind = (self.family[None] == 0) != (family[:, None] == 0)
        logs[(told[:, None] & other) | (hinted[:, None] & other_kind)] = _NOT_IT
        return logs

    def mean_of(
        self, mean: Tensor, precision: Tensor, log_weights: Tensor
    ) -> tuple[Tensor, Tensor]:
        """The posterior's mean (N, M), and the log evidence (N, K) of each component."""
        variance = 1.0 / precision
        offset = self.means[None] - mean[:, None]
        solved, half_log_det = _Solve.apply(self.covariances, variance, offset)  # type: ignore[no-untyped-call]
        evidence = log_weights - 0.5 * (offset * solved).sum(-1) - half_log_det
        # What the covariance takes from a component's mean is what the message's variance adds to
        # the message's mean.
        moved = (torch.softmax(evidence, -1)[..., None] * solved).sum(1)
        return mean + variance * moved, evidence

    def judge(self, mean: Tensor, precision: Tensor, log_weights: Tensor, truth: Tensor) -> Loss:
        """What the posterior of messages (N, M) is worth for the true coefficients (N, M)."""
        found, evidence = self.mean_of(mean, precision, log_weights)
        tones, shadows, error = self.distances(found, truth)
        with torch.no_grad():
            away = (truth[:, None] - self.means[None]).transpose(0, 1).transpose(1, 2)
            from_prior = torch.linalg.solve_triangular(self.roots, away, upper=False)
            mahalanobis = (from_prior**2).sum(1).transpose(0, 1)
            prior = torch.logsumexp(log_weights - 0.5 * mahalanobis - _half_log_det(self.roots), -1)
        likelihood = (0.5 * torch.log(precision) - 0.5 * precision * (truth - mean) ** 2).sum(-1)
        loss = torch.logsumexp(evidence, -1) - prior - likelihood
        return Loss(loss, error, tones, shadows)

    def distances(self, mean: Tensor, truth: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """In stops over the tones and over the shadows, and the error in linear light."""
        estimate, true = (self.mean + c @ self.basis for c in (mean, truth))
        error = torch.sqrt(((estimate**2 - true**2) ** 2).mean(1) + 1e-6)
        logs = 2.0 * torch.log2(
            torch.clamp(estimate, min=SMALLEST) / torch.clamp(true, min=SMALLEST)
        )
        logs = logs - logs[:, _MIDDLE // _STEP, None]
        tones, shadows = (
            torch.sqrt(logs[:, (self.codes >= low) & (self.codes < high)] ** 2 + 1e-6).mean(1)
            for low, high in (_TONES, _SHADOWS)
        )
        return tones, shadows, error


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


def _half_log_det(root: Tensor) -> Tensor:
    """Half the log determinant of a covariance with this Cholesky root."""
    return torch.log(torch.diagonal(root, dim1=-2, dim2=-1)).sum(-1)
