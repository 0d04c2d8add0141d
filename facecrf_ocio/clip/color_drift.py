"""A change of the curve where the light of points moves: all channels of a point at once.

Heads and lamps that turn, and shadows, change the light of a point in all channels alike, near
enough, and a change of the curve each by its own code. So values are taken as brightness (the mean
of the channels) and two colors (their differences), each with the noise that it shows: where light
moves, brightness counts little, and colors tell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.clip.drift_evidence import ALIKE, REWEIGHTED, ROUNDS, TILES, Change
from facecrf_ocio.clip.light_parts import (
    CHANGES,
    Placed,
    StartCurve,
    bends_at,
    field_columns,
    moving_light,
    splines,
    spread_of_bends,
    spread_of_fields,
    without_exponent,
)
from facecrf_ocio.clip.point_values import beside_frames, expected_noise, weights_of
from facecrf_ocio.values import CHANNELS, Float, Index

# Rows: brightness, and two colors, orthonormal.
_TURNED = np.array([[1.0, 1.0, 1.0], [1.0, 0.0, -1.0], [1.0, -2.0, 1.0]])
_TURNED /= np.linalg.norm(_TURNED, axis=1, keepdims=True)
_APART = 6  # bends, even over codes, by which the curve of a channel differs from another's
_APART_STOPS = 0.03  # [stop] standard deviation of each: curves of one camera are near
_FIELD_COLORS = 0.3  # of what brightness moves over a picture: how far colors do


@dataclass(frozen=True, slots=True, eq=False)
class _Turned:
    """Brightness, or one of the colors, with given weights.

    `columns` (V, N) of bends, less what points, frames and moving fields explain, `light` (V,) the
    same of what is seen, `system` (N, N) and `pull` (N,) of the bends, `of_fields` (F, N + 1) what
    fields take of bends and light, and `of_frames` (J,) what frames take of light.
    """

    columns: Float
    light: Float
    system: Float
    pull: Float
    of_fields: Float
    of_frames: Float


def change_of_colors(codes: Float, curve: StartCurve, placed: Placed, tile: Index) -> Change:
    """The change that all channels share.

    Parameters
    ----------
    codes
        (V, 3) in [0, 1].
    curve
        That faces tell.
    placed
        Where and when the values were seen.
    tile
        (V,) part of the picture of each.
    """
    solved = _solved(codes, curve, placed)
    parts, bright, to_mean = solved.parts, solved.turned[0], len(CHANNELS) ** -0.5
    ours = np.linalg.inv(solved.system)[-CHANGES:]
    scores: Float = np.zeros((TILES**2, parts.size))
    for one, pull in zip(solved.turned, solved.pulls, strict=True):
        np.add.at(scores, tile, one.columns * pull[:, None])
    moved = -(bright.of_fields[:, -1] + bright.of_fields[:, :-1] @ parts)
    return Change(
        parts[-CHANGES:],
        ours @ scores.T / ALIKE,
        ours @ _precision(curve) @ ours.T,
        bright.of_frames * to_mean,
        moving_light(moved, placed) * to_mean,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Solved:
    """The bends that brightness and both colors ask for together.

    `parts` (N,) of each bend, `system` (N, N) that they solve, `turned` brightness and colors as
    last weighed, `pulls` (3, V) what each value of these still asks for, by its weight.
    """

    parts: Float
    system: Float
    turned: tuple[_Turned, ...]
    pulls: Float


def _solved(codes: Float, curve: StartCurve, placed: Placed) -> _Solved:
    """Of codes (V, 3), weighed anew until what is far off has little say."""
    first = np.flatnonzero(np.diff(placed.point, prepend=-1))
    light, fields, known = curve.light(codes), field_columns(placed), _precision(curve)
    turned, fitted = light @ _TURNED.T, codes
    weights = np.repeat(_noise(codes, curve)[:, None] ** -2.0, len(CHANNELS), axis=1)
    for _ in range(ROUNDS):
        # Columns are those of fitted codes: noise would be in them and in what they explain.
        columns, noise = _columns(fitted, curve, placed), _noise(fitted, curve)[:, None]
        for _ in range(REWEIGHTED):
            steps = tuple(
                _step(
                    np.column_stack([columns[:, one], fields, turned[:, one]]),
                    one,
                    each,
                    placed,
                    first,
                )
                for one, each in enumerate(weights.T)
            )
            system = known + np.sum([one.system for one in steps], axis=0)
            parts = -np.linalg.solve(system, np.sum([one.pull for one in steps], axis=0))
            left = np.stack([one.light + one.columns @ parts for one in steps], axis=1)
            weights = _weights(left / noise, first) / noise**2
        fitted = curve.codes(light - left @ _TURNED)
    return _Solved(parts, system, steps, (weights * left).T)


def _weights(standard: Float, first: Index) -> Float:
    """(V, 3) of residuals (V, 3) in units of noise, of brightness and of colors by themselves."""
    alone = [weights_of(part, first) for part in (standard[:, :1], standard[:, 1:])]
    return np.column_stack(alone)


def _noise(codes: Float, curve: StartCurve) -> Float:
    """(V,) [stop] expected of values whose channels have these codes (V, 3)."""
    return np.asarray(np.sqrt((expected_noise(curve.slope(codes)) ** 2).mean(axis=1)))


def _columns(codes: Float, curve: StartCurve, placed: Placed) -> Float:
    """(V, 3, N) of bends that stay, those that channels differ by, and the change, turned."""
    flat = codes.reshape(-1)
    light, time = curve.light(flat), np.repeat(placed.time, len(CHANNELS))
    staying, change = bends_at(flat, time, curve, placed.span)
    apart = without_exponent(splines(flat, *placed.span, _APART), light)
    which = np.arange(flat.size) % len(CHANNELS)
    both = [apart * one[which, None] for one in _TURNED[1:] / np.abs(_TURNED[1:, :1])]
    columns = np.column_stack([staying, *both, change])
    return np.asarray(np.einsum("kc,vcn->vkn", _TURNED, columns.reshape(*codes.shape, -1)))


def _precision(curve: StartCurve) -> Float:
    """(N, N) of what is known of these bends beforehand."""
    size, spread = len(curve.precision), spread_of_bends(curve)
    apart = np.full(2 * _APART, _APART_STOPS)
    precision = np.diag(np.concatenate([spread[:-CHANGES], apart, spread[-CHANGES:]]) ** -2.0)
    precision[:size, :size] = curve.precision
    return np.asarray(precision)


def _step(both: Float, number: int, weights: Float, placed: Placed, first: Index) -> _Turned:
    """Of columns of bends, then fields, then light; `number` 0 is brightness."""
    apart, of_frames = beside_frames(both, weights, placed, first)
    spread = spread_of_fields(placed) * (_FIELD_COLORS if number else 1.0)
    begin, end = both.shape[1] - 1 - spread.size, both.shape[1] - 1
    fields, others = apart[:, begin:end], np.delete(apart, np.s_[begin:end], axis=1)
    heavy = fields * weights[:, None] / ALIKE
    taken = heavy.T @ others
    explained = np.linalg.solve(heavy.T @ fields + np.diag(spread**-2.0), taken)
    joint = others.T @ (others * weights[:, None]) / ALIKE - taken.T @ explained
    rest = others - fields @ explained
    return _Turned(
        rest[:, :-1], rest[:, -1], joint[:-1, :-1], joint[:-1, -1], explained, of_frames[:, -1]
    )
