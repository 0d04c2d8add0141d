"""How far estimates of two versions of one portrait are apart, the known curves taken out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from facecrf_ocio.joint.prior import FAMILIES, FamilyPrior
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.response.stops import MID_CODES, MID_GRAY
from facecrf_ocio.training.cue_networks import fuse, inputs_of, left_in
from facecrf_ocio.training.portraits import Versions
from facecrf_ocio.training.posterior import SMALLEST, PosteriorLoss
from facecrf_ocio.values import Float

# Shares of pairs whose family is told, and among those of phones: heads of a trial were off by
# 0.079 stops with none told, and by 0.077 with these.
_TOLD, _PHONES = 0.5, 0.33
_CAMERA = FAMILIES.index("camera")  # the phones' family is the next
_STEP = 8  # of 1,024 encoded values, those compared


@dataclass(frozen=True, slots=True)
class Apart:
    """Of each pair, (N,).

    Attributes
    ----------
    tones
        [stops] Mean distance where both versions have codes 64 to 235, equal light in the middle.
    error
        Root mean square distance in linear light, white at 1.
    """

    tones: Tensor
    error: Tensor


class Agreement:
    """Versions of portraits, and how far estimates of two of them are apart.

    Parameters
    ----------
    prior
        Whose coefficients estimates are.
    portraits
        Versions of N portraits, K of each.
    scaling
        Of the statistics of each cue.
    """

    def __init__(
        self,
        prior: FamilyPrior,
        portraits: Versions,
        scaling: Mapping[str, tuple[Float, Float]],
    ) -> None:
        self.portraits, self.versions, size = portraits.curves.shape
        self.curves = torch.tensor(portraits.curves.reshape(-1, size)[:, ::_STEP])
        flat = {cue: np.concatenate(list(portraits.by_cue[cue])) for cue in CUES}
        self.given = {cue: inputs_of(flat[cue], *scaling[cue]) for cue in CUES}
        grid = np.linspace(0.0, 1.0, size)
        self.mean = torch.tensor(np.interp(grid, prior.grid, prior.mean), dtype=torch.float32)
        basis = np.array([np.interp(grid, prior.grid, row) for row in prior.basis])
        self.basis = torch.tensor(basis, dtype=torch.float32)

    def apart(
        self, networks: nn.ModuleDict, posterior: PosteriorLoss, count: int, cue_dropout: float
    ) -> Apart:
        """Of some pairs drawn at random, the same cues left out of both versions.

        Half are told to be a camera's or a phone's, as files tell it, whatever took them: a known
        curve changes the photo and not its EXIF.
        """
        pairs = self.some_pairs(count)
        kept = left_in(count, cue_dropout).repeat_interleave(2, 0)
        mean, precision = fuse(networks, self.given, pairs.flatten(), kept)
        told = torch.rand(count) < _TOLD
        family = _CAMERA + (torch.rand(count) < _PHONES).long()
        weights = posterior.weights(family, told, torch.zeros_like(told))
        found, _ = posterior.mean_of(mean, precision, weights.repeat_interleave(2, 0))
        return self.distances(found, pairs)

    def some_pairs(self, count: int) -> Tensor:
        """(N, 2) indices of versions, two of one portrait each."""
        portrait = torch.randint(self.portraits, (count, 1))
        first = torch.randint(self.versions, (count, 1))
        other = (first + torch.randint(1, self.versions, (count, 1))) % self.versions
        pairs: Tensor = portrait * self.versions + torch.cat([first, other], 1)
        return pairs

    def distances(self, coefficients: Tensor, pairs: Tensor) -> Apart:
        """Compare estimates (2 N, M), the two of each pair (N, 2) one after the other."""
        encoded = self.curves[pairs.flatten()]
        nearest = torch.round(encoded * (len(self.mean) - 1)).long()
        roots = self.mean[nearest] + torch.einsum(
            "nm,mns->ns", coefficients, self.basis[:, nearest]
        )
        one, other = roots[0::2], roots[1::2]
        error = torch.sqrt(((one**2 - other**2) ** 2).mean(1) + 1e-6)
        logs = 2.0 * torch.log2(torch.clamp(one, min=SMALLEST) / torch.clamp(other, min=SMALLEST))
        of_one, of_other = encoded[0::2], encoded[1::2]
        middle = torch.abs(of_one + of_other - 2.0 * MID_GRAY / 255.0).argmin(1, keepdim=True)
        logs = logs - logs.gather(1, middle)
        low, high = (code / 255.0 for code in MID_CODES)
        both = (torch.minimum(of_one, of_other) >= low) & (torch.maximum(of_one, of_other) <= high)
        tones = (torch.sqrt(logs**2 + 1e-6) * both).sum(1) / both.sum(1)
        return Apart(tones, error)
