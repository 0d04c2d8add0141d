"""Whether the curve itself changes over a clip: a test in stops, over the codes the scene shows.

Points of fixed light show a change of the curve as light that changes by code, and not by place or
frame. How far that can be trusted is told by how much parts of the picture disagree (the covariance
of Liang and Zeger, Biometrika 1986), and by what is not known of the curve that stays.
"""

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
    change_begins,
    change_bends,
    columns_at,
    moving_light,
    precision_of,
    smooth_fields,
    start_curve,
)
from facecrf_ocio.clip.point_values import centered, expected_noise
from facecrf_ocio.clip.tracked_points import TrackedPoints
from facecrf_ocio.joint.prior import FamilyPrior, Posterior
from facecrf_ocio.response.robust import biweight_of_squares, robust_deviation
from facecrf_ocio.values import CHANNELS, Float, Index, InverseCRF

# F of a change from which it is told, by 230 clips: of 115 with one 93 show more, without one ten.
_SURE = 7.5
_ROUNDS = 3  # of places on the curve
_REWEIGHTED = 2  # times a round
_LEAST_SCALE = 0.1  # of residuals to the noise that was expected
# A point's own noise is taken from its values, beside so many of the usual: those at edges, and
# where light moves, count less.
_USUAL = 5.0
_MOST_NOISE = 9.0  # [usual variance] that one value counts in that
_ALIKE = 3.0  # values that count as one beside what is known beforehand
_LOOSE = 1e-2  # precision of a frame's exposure, of which nothing is known
_TILES = 7  # parts of the picture, a side, that err each in their own way
_SPAN = (0.005, 0.995)  # quantiles of the codes over which bends are laid
_SHOWN = (0.05, 0.88)  # codes over which a change counts: beyond, codes are few or coarse
_SAMPLES = 64  # of those codes
# [stop, code] by which encoders and resampling change the curve at all, over how many codes they
# do so alike. By the same clips, of 0.006 to 0.012.
_ALWAYS, _ALIKE_CODES = 0.006, 0.15
# Of light that moves over the picture: what may go with codes, as shading does, and be left by
# smooth fields. By the same clips, of 0 to 0.7.
_LEAKS = 0.1
# [stop over the clip] of exposures that go one way, below which a change of the curve alone passes
# for them: of 0.03 (RMSE) for 0.23 at most.
_PASSES = 0.2
_BLIND = 0.02  # [stop] of standard error: a drift of 0.04, which matters, is two of them
_FEWEST_FRAMES = 4  # that show a change beside their scatter
_FEW = 1.5  # of a standard error by few frames, which is not sure itself
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
        return self.evidence > _SURE

    @property
    def is_hidden(self) -> bool:
        """Whether one that matters could be there unseen, as where exposure goes one way."""
        return not self.is_sure and not 0.0 < self.error <= _BLIND


def drift_of_points(
    faces: Posterior, points: TrackedPoints, times: Float, prior: FamilyPrior, scale: float
) -> Drift:
    """The change of the curve from one end of a clip to the other, where points show it.

    Parameters
    ----------
    faces
        Coefficients of the curve by the faces.
    points
        The same points in J frames.
    times
        (J,) of the frames, -0.5 to 0.5 from first to last.
    prior
        Of the curves.
    scale
        Factor on the deviations of posteriors that makes them honest.
    """
    usable = points.usable & (points.usable.sum(axis=0) >= 2)
    point, frame = np.nonzero(usable.T)
    if len(times) < _FEWEST_FRAMES or len(point) < CHANGES:
        return Drift()
    codes = points.codes[frame, point] / 255.0
    fields, waves = smooth_fields(points.places)
    low, high = (float(one) for one in np.quantile(codes, _SPAN))
    placed = Placed(frame, point, times[frame], len(times), (low, high), fields[point], waves)
    tile = (np.minimum(points.places, 1.0 - 1e-9) * _TILES).astype(np.intp) @ (_TILES, 1)
    curve = start_curve(faces, prior, scale)
    found = [_change(codes[:, one], curve, placed, tile[point]) for one in range(len(CHANNELS))]
    return _judged(found, curve, placed, times)


def drift_of_curves(curves: Sequence[InverseCRF]) -> Drift:
    """By a line over frames through their own curves, where there are no points.

    Its evidence is by their scatter about the line, of which faces leave much.
    """
    count = len(curves)
    if count < _FEWEST_FRAMES:
        return Drift()
    codes = np.linspace(*_SHOWN, _SAMPLES)
    light = np.log2([np.interp(codes, one.encoded, one.linear[0]) for one in curves])
    light -= light.mean(axis=1, keepdims=True)
    going = np.linspace(-0.5, 0.5, count)
    change = going @ light / (going @ going)
    left = light - light.mean(axis=0) - np.outer(going, change)
    scatter = float((left**2).sum()) / (count - 2) / _SAMPLES / float(going @ going)
    apart, error = float((change**2).mean()), _FEW * float(np.hypot(np.sqrt(scatter), _ALWAYS))
    return Drift(apart**0.5, error, apart / error**2)


@dataclass(frozen=True, slots=True, eq=False)
class _Change:
    """Of one channel.

    `bends` (CHANGES,) of the change, `pulls` (CHANGES, T) by which each part of the picture pulls
    them, `known` (CHANGES, CHANGES) covariance by what was known beforehand, `exposures` (J,)
    [stop] of the frames, and `moving` [stop] RMS of light that moves over the picture with time.
    """

    bends: Float
    pulls: Float
    known: Float
    exposures: Float
    moving: float


@dataclass(frozen=True, slots=True, eq=False)
class _Step:
    """What is solved for with given weights.

    `columns` (V, C) less what points and frames explain of them, `system` (C, C) that is solved,
    `parts` (C,) found, `left` (V,) [stop] what they leave of the light, `exposures` (J,) [stop].
    """

    columns: Float
    system: Float
    parts: Float
    left: Float
    exposures: Float


def _change(codes: Float, curve: StartCurve, placed: Placed, tile: Index) -> _Change:
    first = np.flatnonzero(np.diff(placed.point, prepend=-1))
    light, known = curve.light(codes), precision_of(curve, placed)
    weights = expected_noise(curve.slope(codes)) ** -2.0
    fitted = curve.codes(light - _alone(light, weights, placed, first))
    for _ in range(_ROUNDS):
        # Columns are those of fitted codes: noise would be in them and in what they explain.
        columns = columns_at(fitted, curve, placed)
        noise = expected_noise(curve.slope(fitted))
        for _ in range(_REWEIGHTED):
            step = _step(columns, light, weights, known, placed, first)
            weights = _weights(step.left / noise, first) / noise**2
        fitted = curve.codes(light - step.left)
    begin = change_begins(curve)
    ours = np.linalg.inv(step.system)[begin : begin + CHANGES]
    scores: Float = np.zeros((_TILES**2, step.parts.size))
    np.add.at(scores, tile, step.columns * (weights * step.left)[:, None])
    return _Change(
        step.parts[begin : begin + CHANGES],
        ours @ scores.T / _ALIKE,
        ours @ known @ ours.T,
        step.exposures,
        moving_light(step.parts, curve, placed),
    )


def _alone(light: Float, weights: Float, placed: Placed, first: Index) -> Float:
    """(V,) what points and exposures alone leave of the light."""
    return _beside_frames(light[:, None], weights, placed, first)[0][:, 0]


def _beside_frames(
    columns: Float, weights: Float, placed: Placed, first: Index
) -> tuple[Float, Float]:
    """Columns less what one number a point and one a frame explain of them, and those of frames."""
    shown: Float = np.zeros((len(columns), placed.frames))
    shown[np.arange(len(columns)), placed.frame] = 1.0
    shown, apart = centered(shown, weights, first), centered(columns, weights, first)
    heavy = shown * weights[:, None]
    normal = shown.T @ heavy + _LOOSE * np.eye(placed.frames)
    of_frames = np.linalg.solve(normal, heavy.T @ apart)
    return apart - shown @ of_frames, of_frames


def _step(
    columns: Float, light: Float, weights: Float, known: Float, placed: Placed, first: Index
) -> _Step:
    both = np.column_stack([columns, light])
    apart, of_frames = _beside_frames(both, weights, placed, first)
    columns, heavy = apart[:, :-1], apart[:, :-1] * weights[:, None]
    system = columns.T @ heavy / _ALIKE + known
    parts = -np.linalg.solve(system, heavy.T @ apart[:, -1] / _ALIKE)
    left = apart[:, -1] + columns @ parts
    return _Step(columns, system, parts, left, of_frames[:, -1] + of_frames[:, :-1] @ parts)


def _weights(standard: Float, first: Index) -> Float:
    """(V,) by residuals in units of the noise that was expected, and by each point's own noise."""
    scale = max(robust_deviation(standard), _LEAST_SCALE)
    standard = standard / scale
    count = np.diff(first, append=len(standard))
    own = np.add.reduceat(np.minimum(standard**2, _MOST_NOISE), first)
    variance = np.repeat((_USUAL + own) / (_USUAL + count), count)
    return np.asarray(biweight_of_squares(standard**2 / variance) / (variance * scale**2))


def _judged(found: Sequence[_Change], curve: StartCurve, placed: Placed, times: Float) -> Drift:
    """Of the mean change of the channels, over the codes shown."""
    low, high = (np.clip(placed.span, *_SHOWN)[one] for one in (0, 1))
    codes = np.linspace(low, high, _SAMPLES)
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
    always = _without_scale(_without_scale((_ALWAYS**2 + leaked**2) * alike).T)
    directions, sizes, _ = np.linalg.svd(shown, full_matrices=False)
    directions = directions[:, sizes > 1e-6 * sizes[0]]
    seen = directions.T @ change
    spread = directions.T @ (unsure + always) @ directions
    return Drift(
        float(np.sqrt((change**2).mean())),
        float(np.sqrt(np.trace(unsure + always) / _SAMPLES)),
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
