"""Truths for portraits whose response nobody knows: as likely as the prior has it for cameras.

Networks that have seen renders alone read real photos with a bias that all cues share, and are sure
of it. A version of a portrait through a known curve h has the inverse response g(h^-1), and g is
nearly known, because cameras are alike. So g is drawn anew from the cameras' prior each time: what
a cue says of real photos is learned from h, and how sure it may be from the spread of g.
"""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor, nn

from facecrf_ocio.joint.prior import FAMILIES, FamilyPrior
from facecrf_ocio.training.cue_networks import Given, fuse, left_in
from facecrf_ocio.training.posterior import Loss, PosteriorLoss
from facecrf_ocio.values import Float

_TOLD = 0.5  # share whose family is told, as many files name a camera; chosen by judgment
_CAMERA = FAMILIES.index("camera")
_RISE = (
    1e-9  # of full scale per sample, so that a known curve that is flat somewhere has an inverse
)


class LikelyTruths:
    """Versions of portraits, and the truths that they may have.

    Parameters
    ----------
    likely
        The prior that truths are drawn from; its mean and basis are those of the coefficients.
    analysis
        (K, M) that gives the coefficients of a curve's root less the mean.
    curves
        (N, L) the known curve of each version.
    given
        What the networks are given of each.
    """

    def __init__(self, likely: FamilyPrior, analysis: Float, curves: Float, given: Given) -> None:
        self.given = given
        known = (through(likely, analysis, curve) for curve in curves)
        offsets, turned = zip(*known, strict=True)
        self.offsets = torch.tensor(np.array(offsets), dtype=torch.float32)
        self.turned = torch.tensor(np.array(turned), dtype=torch.float32)
        of_cameras = likely.family == _CAMERA
        self.weights = torch.tensor(likely.weights[of_cameras], dtype=torch.float32)
        self.means = torch.tensor(likely.means[of_cameras], dtype=torch.float32)
        roots = np.linalg.cholesky(likely.covariances[of_cameras])
        self.roots = torch.tensor(roots, dtype=torch.float32)

    def judge(
        self, networks: nn.ModuleDict, posterior: PosteriorLoss, count: int, cue_dropout: float
    ) -> Loss:
        """What the posterior is worth for some versions, each with a truth drawn for it."""
        chosen = torch.randint(len(self.offsets), (count,))
        mean, precision = fuse(networks, self.given, chosen, left_in(count, cue_dropout))
        told = torch.rand(count) < _TOLD
        weights = posterior.weights(torch.full((count,), _CAMERA), told, torch.zeros_like(told))
        return posterior.judge(mean, precision, weights, self.truths(chosen))

    def truths(self, versions: Tensor) -> Tensor:
        """(N, M) coefficients drawn for some versions, by their indices (N,)."""
        component = torch.multinomial(self.weights, len(versions), replacement=True)
        steps = torch.randn(len(versions), self.means.shape[1])
        of_camera = self.means[component] + torch.einsum("nij,nj->ni", self.roots[component], steps)
        turned = torch.einsum("nm,nmk->nk", of_camera, self.turned[versions])
        return self.offsets[versions] + turned


def through(prior: FamilyPrior, analysis: Float, known: Float) -> tuple[Float, Float]:
    """How coefficients c of an inverse response g become those of g(h^-1), o + c B.

    Parameters
    ----------
    prior
        Whose coefficients they are.
    analysis
        (K, M) that gives them.
    known
        (L,) encoded values h at L uniform encoded values, never decreasing.

    Returns
    -------
    offset, turned
        o (M,) and B (M, M).
    """
    uniform = np.linspace(0.0, 1.0, known.size)
    rising = known.astype(np.float64) + _RISE * np.arange(known.size)
    before = np.interp(prior.grid, rising, uniform)
    mean = np.interp(before, prior.grid, prior.mean)
    basis = np.array([np.interp(before, prior.grid, row) for row in prior.basis])
    return (mean - prior.mean) @ analysis, basis @ analysis
