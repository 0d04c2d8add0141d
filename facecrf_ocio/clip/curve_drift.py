"""Whether the curve itself changes over a clip: a test in stops, over the codes the scene shows.

Points of fixed light show a change of the curve as light that changes by code, and not by place or
frame. How far that can be trusted is told by how much parts of the picture disagree (the covariance
of Liang and Zeger, Biometrika 1986), and by what is not known of the curve that stays. It is sought
in each channel alone, and in all at once (`color_drift`), which other things mislead: both must
tell it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from facecrf_ocio.clip.color_drift import change_of_colors
from facecrf_ocio.clip.drift_evidence import (
    ALIKE,
    ALWAYS,
    REWEIGHTED,
    ROUNDS,
    SAMPLES,
    SHOWN,
    SURE,
    TILES,
    Change,
    Drift,
    judged,
)
from facecrf_ocio.clip.light_parts import (
    CHANGES,
    Placed,
    StartCurve,
    change_begins,
    columns_at,
    moving_light,
    precision_of,
    smooth_fields,
    start_curve,
)
from facecrf_ocio.clip.point_values import beside_frames, expected_noise, weights_of
from facecrf_ocio.clip.tracked_points import TrackedPoints
from facecrf_ocio.joint.prior import FamilyPrior, Posterior
from facecrf_ocio.values import CHANNELS, Float, Index, InverseCRF

_SPAN = (0.005, 0.995)  # quantiles of the codes over which bends are laid
_FEWEST_FRAMES = 4  # that show a change beside their scatter
_SURE_ALONE = 7.5  # [squared standard error] from which frames' own curves tell a change
_FEW = 1.5  # of a standard error by few frames, which is not sure itself


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
    tile = (np.minimum(points.places, 1.0 - 1e-9) * TILES).astype(np.intp) @ (TILES, 1)
    curve = start_curve(faces, prior, scale)
    found = [_of_channel(codes[:, one], curve, placed, tile[point]) for one in range(len(CHANNELS))]
    alone = judged(found, curve, placed, times)
    if not alone.is_sure:
        return alone
    at_once = judged([change_of_colors(codes, curve, placed, tile[point])], curve, placed, times)
    return replace(alone, evidence=min(alone.evidence, at_once.evidence))


def drift_of_curves(curves: Sequence[InverseCRF]) -> Drift:
    """By a line over frames through their own curves, where there are no points.

    Its evidence is by their scatter about the line, of which faces leave much.
    """
    count = len(curves)
    if count < _FEWEST_FRAMES:
        return Drift()
    codes = np.linspace(*SHOWN, SAMPLES)
    light = np.log2([np.interp(codes, one.encoded, one.linear[0]) for one in curves])
    light -= light.mean(axis=1, keepdims=True)
    going = np.linspace(-0.5, 0.5, count)
    change = going @ light / (going @ going)
    left = light - light.mean(axis=0) - np.outer(going, change)
    scatter = float((left**2).sum()) / (count - 2) / SAMPLES / float(going @ going)
    apart, error = float((change**2).mean()), _FEW * float(np.hypot(np.sqrt(scatter), ALWAYS))
    return Drift(apart**0.5, error, apart / error**2 * SURE / _SURE_ALONE)


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


def _of_channel(codes: Float, curve: StartCurve, placed: Placed, tile: Index) -> Change:
    first = np.flatnonzero(np.diff(placed.point, prepend=-1))
    light, known = curve.light(codes), precision_of(curve, placed)
    weights = expected_noise(curve.slope(codes)) ** -2.0
    fitted = curve.codes(light - _alone(light, weights, placed, first))
    for _ in range(ROUNDS):
        # Columns are those of fitted codes: noise would be in them and in what they explain.
        columns = columns_at(fitted, curve, placed)
        noise = expected_noise(curve.slope(fitted))
        for _ in range(REWEIGHTED):
            step = _step(columns, light, weights, known, placed, first)
            weights = weights_of((step.left / noise)[:, None], first)[:, 0] / noise**2
        fitted = curve.codes(light - step.left)
    begin = change_begins(curve)
    ours = np.linalg.inv(step.system)[begin : begin + CHANGES]
    scores: Float = np.zeros((TILES**2, step.parts.size))
    np.add.at(scores, tile, step.columns * (weights * step.left)[:, None])
    return Change(
        step.parts[begin : begin + CHANGES],
        ours @ scores.T / ALIKE,
        ours @ known @ ours.T,
        step.exposures,
        moving_light(step.parts[begin + CHANGES :], placed),
    )


def _alone(light: Float, weights: Float, placed: Placed, first: Index) -> Float:
    """(V,) what points and exposures alone leave of the light."""
    return beside_frames(light[:, None], weights, placed, first)[0][:, 0]


def _step(
    columns: Float, light: Float, weights: Float, known: Float, placed: Placed, first: Index
) -> _Step:
    both = np.column_stack([columns, light])
    apart, of_frames = beside_frames(both, weights, placed, first)
    columns, heavy = apart[:, :-1], apart[:, :-1] * weights[:, None]
    system = columns.T @ heavy / ALIKE + known
    parts = -np.linalg.solve(system, heavy.T @ apart[:, -1] / ALIKE)
    left = apart[:, -1] + columns @ parts
    return _Step(columns, system, parts, left, of_frames[:, -1] + of_frames[:, :-1] @ parts)
