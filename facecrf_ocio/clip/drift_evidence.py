"""How sure a change of the curve is: its size over the codes shown, beside all that feigns one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from facecrf_ocio.clip.light_parts import (
    CHANGES,
    CUBE,
    SQUARE,
    Placed,
    StartCurve,
    change_bends,
)
from facecrf_ocio.values import Float

ROUNDS = 3  # of places on the curve
REWEIGHTED = 2  # times a round
ALIKE = 3.0  # values that count as one beside what is known beforehand
TILES = 7  # parts of the picture, a side, that err each in their own way
SHOWN = (0.05, 0.88)  # codes over which a change counts: beyond, codes are few or coarse
SAMPLES = 64  # of those codes
# F of a change from which it is told, in channels alone and in all at once. By 124 clips that drift
# and 124 that do not: 86 and 8 show more in both.
SURE = 2.5
# [stop, code] by which encoders and resampling change the curve at all, over how many codes they
# do so alike. By 230 clips, of 0.006 to 0.012.
ALWAYS, _ALIKE_CODES = 0.006, 0.15
# Of light that moves over the picture: what may go with codes, as shading does, and be left by
# smooth fields. By the same clips, of 0.1 to 1.
_LEAKS = 0.5
# [stop over the clip] of exposures that go one way, below which a change of the curve alone passes
# for them: of 0.03 (RMSE) for 0.23 at most.
_PASSES = 0.2
_BLIND = 0.02  # [stop] of standard error: a drift of 0.04, which matters, is two of them
_FEWEST_TILES = 2 * CHANGES  # that show how parts of the picture disagree


@dataclass(frozen=True, slots=True)
class Drift:
    """A change of the curve from the first frame to the last, in proportion to time.

    Attributes
    ----------
    stops, error
        [stop] RMS of the change of log light over the codes shown, after its scale, and its
        standard error.
    evidence
        F of the change: 1 is what is expected where there is none.
    """

    stops: float = 0.0
    error: float = 0.0
    evidence: float = 0.0

    @property
    def is_sure(self) -> bool:
        """Whether it is beyond doubt."""
        return self.evidence > SURE

    @property
    def is_hidden(self) -> bool:
        """Whether one that matters could be there unseen, as where exposure goes one way."""
        return not self.is_sure and not 0.0 < self.error <= _BLIND


@dataclass(frozen=True, slots=True, eq=False)
class Change:
    """Of one channel, or of all.

    `bends` (CHANGES,) of the change, `pulls` (CHANGES, T) by which each part of the picture pulls
    them, `known` (CHANGES, CHANGES) covariance by what was known beforehand, `exposures` (J,)
    [stop] of the frames, and `moving` [stop] RMS of light that moves over the picture with time.
    """

    bends: Float
    pulls: Float
    known: Float
    exposures: Float
    moving: float


def judged(found: Sequence[Change], curve: StartCurve, placed: Placed, times: Float) -> Drift:
    """Of the mean change of the channels, over the codes shown."""
    low, high = (np.clip(placed.span, *SHOWN)[one] for one in (0, 1))
    codes = np.linspace(low, high, SAMPLES)
    shown = _without_scale(change_bends(codes, curve, placed.span))
    change = shown @ np.mean([one.bends for one in found], axis=0)
    pulls = np.mean([one.pulls for one in found], axis=0)
    tiles = int((np.abs(pulls).sum(axis=0) > 0.0).sum())
    if tiles < _FEWEST_TILES:
        return Drift()
    known = np.sum([one.known for one in found], axis=0) / len(found) ** 2
    covariance = pulls @ pulls.T * tiles / (tiles - CHANGES) + known
    exposures = np.mean([one.exposures for one in found], axis=0)
    unsure = shown @ covariance @ shown.T + _feigned(exposures, times, curve.light(codes))
    alike = np.exp(-0.5 * (np.subtract.outer(codes, codes) / _ALIKE_CODES) ** 2)
    leaked = _LEAKS * float(np.mean([one.moving for one in found]))
    always = _without_scale(_without_scale((ALWAYS**2 + leaked**2) * alike).T)
    directions, sizes, _ = np.linalg.svd(shown, full_matrices=False)
    directions = directions[:, sizes > 1e-6 * sizes[0]]
    seen = directions.T @ change
    spread = directions.T @ (unsure + always) @ directions
    return Drift(
        float(np.sqrt((change**2).mean())),
        float(np.sqrt(np.trace(unsure + always) / SAMPLES)),
        float(seen @ np.linalg.solve(spread, seen)) / seen.size,
    )


def _feigned(exposures: Float, times: Float, light: Float) -> Float:
    """(S, S) covariance of the change that exposure feigns which goes one way over time.

    Where it does, the curve that stays and is bent like a square of log light cannot be told from
    one whose exponent changes, and a cube not from one that bends.
    """
    going = times - times.mean()
    slope = abs(float(going @ exposures) / float(going @ going))
    alike = float(np.corrcoef(exposures, times)[0, 1]) if np.ptp(exposures) > 0.0 else 0.0
    size = max(slope - _PASSES, 0.0) * alike**2
    middle = light - light.mean()
    columns = np.column_stack([2.0 * SQUARE * middle, 3.0 * CUBE * middle**2])
    columns = size * _without_scale(columns)
    return np.asarray(columns @ columns.T)


def _without_scale(columns: Float) -> Float:
    """Less their mean over codes: the scale of light, which goes with the exposures."""
    return np.asarray(columns - columns.mean(axis=0))
