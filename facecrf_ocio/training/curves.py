"""Responses to train with: the measured ones, and what lies between and beside them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from facecrf_ocio.benchmark.folds import GUARD_ROWS
from facecrf_ocio.benchmark.joint_folds import FOLDS
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.values import Float, Index

_NEAREST = 12  # of the 40 in a fold: alike enough to be mixed; chosen by judgment
_POWERS = 0.15  # share of pure powers among the varied curves of DoRF's family
_RARE = 0.25  # root mean square distance from the mean curve
NO_ROW = -1  # no index of a row
_STRANGERS = 0.4  # share of mixed modern responses whose second is of any kind and maker
# Shares by what took a photo; chosen by judgment.
_KINDS = {"camera_jpeg": 0.45, "webcam": 0.25, "phone_isp": 0.25, "raw_converter": 0.05}


@dataclass(frozen=True, slots=True, eq=False)
class Draw:
    """One response.

    Attributes
    ----------
    inverse
        (1024,) linear light at uniform encoded values.
    family
        0 for DoRF, 1 for modern ones, as in `joint.prior.FAMILIES`.
    row
        Of the measured response, or of the first of two; `NO_ROW` for a curve of no camera.
    mixed_with
        Row of the second of two, else `NO_ROW`.
    """

    inverse: Float
    family: int
    row: int
    mixed_with: int = NO_ROW


@dataclass(frozen=True, slots=True, eq=False)
class CurveSource:
    """Measured responses of both families.

    Attributes
    ----------
    dorf
        (C, 1024).
    modern
        (D, 1024).
    kind
        (D,) of each modern response.
    maker
        (D,) of each modern response; those of one maker are mixed.
    """

    dorf: Float
    modern: Float
    kind: tuple[str, ...]
    maker: tuple[str, ...]

    def draw(self, generator: np.random.Generator, *, measured: bool) -> Draw:
        """A response of either family with equal odds.

        Parameters
        ----------
        generator
            Source of randomness.
        measured
            True for a measured one as it is; False for one between it and a neighbor, with another
            exponent and sometimes another shape or white, or for a pure power, so that curves of
            unseen makers are not farther from the trained ones than these are from each other.
        """
        family = int(generator.random() < 0.5)
        if not measured and not family and generator.random() < _POWERS:
            row, mixed_with, curve = NO_ROW, NO_ROW, _power(generator)
        else:
            row, mixed_with, curve = (self._modern if family else self._dorf)(generator, measured)
        if not measured:
            spread = 0.08 if generator.random() < 0.8 else 0.3
            curve = curve ** np.exp(generator.normal(0.0, spread))
            if generator.random() < 0.4:
                curve = _warped(curve, generator)
            if generator.random() < 0.5:
                curve = _with_white(curve, 1.0 - abs(generator.normal(0.0, 0.08)))
        return Draw(np.maximum.accumulate(np.clip(curve, 0.0, 1.0)), family, row, mixed_with)

    def _dorf(self, generator: np.random.Generator, measured: bool) -> tuple[int, int, Float]:
        """A neighbor to mix with comes from the same fold: what is held out must not leak."""
        row = int(generator.choice(len(self.dorf), p=self._odds()))
        curve = self.dorf[row]
        if measured or generator.random() < 0.4:
            return row, NO_ROW, curve
        fold_of = fold_of_rows(len(self.dorf))
        siblings = np.flatnonzero(fold_of == fold_of[row])
        order = np.argsort(((self.dorf[siblings] - curve) ** 2).sum(axis=1))
        other = int(siblings[generator.choice(order[1:_NEAREST])])
        share = 0.6 * generator.random()
        return row, other, (1.0 - share) * curve + share * self.dorf[other]

    def _odds(self) -> Float:
        """Rare shapes are drawn up to three times as often: errors on them are the largest."""
        distance = np.sqrt(((self.dorf - self.dorf.mean(axis=0)) ** 2).mean(axis=1))
        odds = 1.0 + 2.0 * np.minimum(distance / _RARE, 1.0)
        return np.asarray(odds / odds.sum())

    def _odds_of_models(self, rows: Index) -> Float:
        """Models of one maker are alike: nine of them are drawn as often as three of others."""
        makers = [self.maker[row] for row in rows]
        odds = np.array([makers.count(maker) ** -0.5 for maker in makers])
        return np.asarray(odds / odds.sum())

    def _modern(self, generator: np.random.Generator, measured: bool) -> tuple[int, int, Float]:
        kind = str(generator.choice(list(_KINDS), p=list(_KINDS.values())))
        rows = np.flatnonzero([k == kind for k in self.kind])
        row = int(generator.choice(rows, p=self._odds_of_models(rows)))
        curve = self.modern[row]
        if measured or generator.random() < 0.3:
            return row, NO_ROW, curve
        share = generator.random()
        if generator.random() < _STRANGERS:
            siblings = np.arange(len(self.modern))
        else:
            siblings = rows[[self.maker[other] == self.maker[row] for other in rows]]
        other = int(generator.choice(siblings))
        return row, other, (1.0 - share) * curve + share * self.modern[other]


def read_curves(dorf: Path, *modern: Path) -> CurveSource:
    """Read DoRF's .mat file, and files .npz with `inverse`, `kind` and `maker`, one after another.

    Of cameras that were measured in each channel, green counts where the file grades its curves:
    it is the best measured there.
    """
    film = read_responses(dorf).inverse[:, 0]
    digital: list[Float] = []
    kind: list[str] = []
    maker: list[str] = []
    for path in modern:
        inverse = read_responses(path).inverse
        with np.load(path) as stored:
            digital.append(inverse[:, 1] if "grade" in stored.files else inverse.mean(axis=1))
            kind += [str(k) for k in stored["kind"]]
            maker += [str(m) for m in stored["maker"]]
    return CurveSource(film, np.concatenate(digital), tuple(kind), tuple(maker))


def fold_of_rows(count: int) -> Index:
    """Fold of each row of DoRF, as the bench assigns them."""
    return np.asarray(np.arange(count) * FOLDS // count, dtype=np.intp)


def rows_outside(fold: int, count: int) -> npt.NDArray[np.bool_]:
    """Which rows of DoRF a held-out fold's training may see: the same as the bench's prior."""
    block = np.flatnonzero(fold_of_rows(count) == fold)
    seen = np.ones(count, bool)
    seen[max(0, block[0] - GUARD_ROWS) : block[-1] + 1 + GUARD_ROWS] = False
    return seen


def _with_white(curve: Float, white: float) -> Float:
    """The same response, clipped at a lower level of light."""
    grid = np.linspace(0.0, 1.0, curve.size)
    cut = np.interp(grid * white, grid, curve)
    return np.asarray(cut / cut[-1])


def _warped(curve: Float, generator: np.random.Generator) -> Float:
    """The same response with a gentle, smooth change of shape that leaves its ends in place."""
    order = np.arange(1, 5)
    spread = 0.02 if generator.random() < 0.7 else 0.06
    heights = generator.normal(0.0, spread, order.size) / order
    return np.asarray(curve + heights @ np.sin(np.pi * order[:, None] * curve))


def _power(generator: np.random.Generator) -> Float:
    """A gamma curve, from one that darkens to the steepest of film."""
    exponent = np.exp(generator.uniform(np.log(0.4), np.log(3.5)))
    return np.asarray(np.linspace(0.0, 1.0, 1024) ** exponent)
