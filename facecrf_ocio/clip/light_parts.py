"""What the light of points that frames share is made of, where the curve may change over the clip.

By the curve that faces tell, the log light of a point in a frame is its own, plus the frame's
exposure, plus parts that are columns here, each with a prior: bends of the curve that stay, of
which there are many, so that exposure that moves along a bend feigns no change; a change of the
curve in proportion to time; and light that moves over the picture.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from facecrf_ocio.joint.prior import FamilyPrior, Posterior
from facecrf_ocio.response.own_light import one_each
from facecrf_ocio.values import Float, Index

CHANGES = 5  # bends of a change: those of cameras are smooth, and more of them tell less
_STAYING = 24  # bends that stay: of 14 the rest feigned 0.02 stops where exposure moved
_STAYING_STOPS = 0.1  # [stop] standard deviation of each; curves miss what faces tell by as much
_CHANGE_STOPS = 0.3  # [stop] standard deviation of a bend of the change: wide, as it is sought
# [1/stop, 1/stop^2] standard deviations of a bend that is a square or cube of log light: twice what
# faces left of the curves of 70 clips, as some have far more.
SQUARE, CUBE = 0.06, 0.015
# Variance of each coefficient that is added to what faces leave: they tell how bright a curve is,
# and not its finest bends. In units of the prior's.
_FINE = 0.3
_WAVES, _WAVES_TOGETHER = 4, 5  # half waves of light over width or height, and over both
# Up to so many, light moves freely from frame to frame, and not only with time: a gradient, and how
# it bends. Without, light that wandered feigned 0.2 stops.
_FREE_WAVES = 2
_FIELD_STOPS = 0.1  # [stop] standard deviation of one half wave; of more of them less
_LEAST_ROOT = 0.02  # of the root of light, where the logarithm would run away
_RISE = 1e-7  # of the root a step of the grid: what makes any curve invertible
_DEGREE = 3  # of splines


@dataclass(frozen=True, slots=True, eq=False)
class StartCurve:
    """The curve that faces tell, in log light.

    Attributes
    ----------
    prior
        Whose grid it has.
    root, stops
        (K,) root of light, and log2 of light.
    precision
        (M, M) of the coefficients about it.
    """

    prior: FamilyPrior
    root: Float
    stops: Float
    precision: Float

    def light(self, codes: Float) -> Float:
        """(V,) log2 light of codes in [0, 1]."""
        return np.asarray(np.interp(codes, self.prior.grid, self.stops))

    def codes(self, light: Float) -> Float:
        """(V,) codes in [0, 1] of log2 light."""
        return np.asarray(np.interp(light, self.stops, self.prior.grid))

    def slope(self, codes: Float) -> Float:
        """(V,) [stop] by which light changes for codes from 0 to 1, at codes."""
        grid = self.prior.grid
        return np.asarray(np.interp(codes, grid, np.gradient(self.stops, grid)))


def start_curve(faces: Posterior, prior: FamilyPrior, scale: float) -> StartCurve:
    """By what faces leave of the prior; `scale` makes its deviations honest."""
    root = np.maximum.accumulate(np.maximum(prior.roots(faces.mean), _LEAST_ROOT))
    root = root + _RISE * np.arange(root.size)
    spread = scale**2 * faces.covariance + _FINE * np.eye(faces.mean.size)
    return StartCurve(prior, root, 2.0 * np.log2(root), np.linalg.inv(spread))


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """Where and when each value was seen.

    Attributes
    ----------
    frame, point
        (V,) of a value; those of a point follow one another.
    time
        (V,) in the clip.
    frames
        How many there are.
    span
        Least and largest code that count, in [0, 1].
    fields
        (V, F) smooth functions of the points' places in the picture.
    waves
        (F,) half waves of each.
    """

    frame: Index
    point: Index
    time: Float
    frames: int
    span: tuple[float, float]
    fields: Float
    waves: Float


def smooth_fields(places: Float) -> tuple[Float, Float]:
    """Half waves over a picture at places (N, 2) in [0, 1]: (N, F), and how many each has (F,)."""
    each = range(_WAVES + 1)
    pairs = [(a, b) for a in each for b in each if 0 < a + b <= _WAVES_TOGETHER]
    columns = [
        np.cos(np.pi * a * places[:, 0]) * np.cos(np.pi * b * places[:, 1]) for a, b in pairs
    ]
    return np.stack(columns, axis=1), np.array([float(a + b) for a, b in pairs])


def change_bends(codes: Float, curve: StartCurve, span: tuple[float, float]) -> Float:
    """(V, CHANGES) bends of a change, even in log light, so that a changing exponent is one."""
    low, high = curve.light(np.array(span))
    return splines(curve.light(codes), low, high, CHANGES)


def columns_at(codes: Float, curve: StartCurve, placed: Placed) -> Float:
    """(V, C) all parts at codes (V,): bends that stay, the change, light that moves."""
    bends = bends_at(codes, placed.time, curve, placed.span)
    return np.column_stack([*bends, field_columns(placed)])


def bends_at(
    codes: Float, time: Float, curve: StartCurve, span: tuple[float, float]
) -> tuple[Float, Float]:
    """Bends that stay, and those of the change, at codes (V,) and times (V,)."""
    prior = curve.prior
    light = curve.light(codes)
    middle = light - light.mean()
    per_root = 2.0 / (np.log(2.0) * np.interp(codes, prior.grid, curve.root))
    basis = np.stack([np.interp(codes, prior.grid, one) for one in prior.basis], axis=1)
    staying = np.column_stack(
        [basis * per_root[:, None], splines(codes, *span, _STAYING), middle**2, middle**3]
    )
    change = change_bends(codes, curve, span)
    change -= change.mean(axis=0)
    return without_exponent(staying, light), change * time[:, None]


def without_exponent(columns: Float, light: Float) -> Float:
    """Less scale and exponent of a curve, which no exposure shows: they would shrink all light."""
    even = np.column_stack([np.ones(light.size), light - light.mean()])
    return np.asarray(columns - even @ np.linalg.lstsq(even, columns, rcond=None)[0])


def field_columns(placed: Placed) -> Float:
    """Light that moves over the picture: in proportion to time, and some of it freely."""
    shown = one_each(placed.frame, placed.frames)
    free = [placed.fields[:, [one]] * shown[:, 1:] for one in np.flatnonzero(_is_free(placed))]
    return np.column_stack([placed.fields * placed.time[:, None], *free])


def change_begins(curve: StartCurve) -> int:
    """The first of the columns of the change."""
    return len(curve.precision) + _STAYING + 2


def precision_of(curve: StartCurve, placed: Placed) -> Float:
    """(C, C) of what is known of all parts beforehand."""
    size = len(curve.precision)
    spread = np.concatenate([spread_of_bends(curve), spread_of_fields(placed)])
    precision = np.diag(spread**-2.0)
    precision[:size, :size] = curve.precision
    return precision


def spread_of_bends(curve: StartCurve) -> Float:
    """Standard deviations of all bends; those of the curve's coefficients are 1, and not used."""
    size = len(curve.precision)
    staying = [np.ones(size), np.full(_STAYING, _STAYING_STOPS), [SQUARE, CUBE]]
    return np.concatenate([*staying, np.full(CHANGES, _CHANGE_STOPS)])


def spread_of_fields(placed: Placed) -> Float:
    """[stop] standard deviations of light that moves over the picture."""
    each = _FIELD_STOPS / placed.waves
    return np.concatenate([each, np.repeat(each[_is_free(placed)], placed.frames - 1)])


def moving_light(parts: Float, placed: Placed) -> float:
    """[stop] RMS over values of the light that moves over the picture from first to last frame."""
    count = placed.waves.size
    with_time: Float = np.array(parts[:count])
    free = parts[count:].reshape(-1, placed.frames - 1)
    values = np.bincount(placed.frame, minlength=placed.frames)
    times = np.bincount(placed.frame, placed.time, placed.frames) / np.maximum(values, 1)
    # A frame without a point, as one that is nearly black, has no say.
    going = np.where(values > 0, times - times[values > 0].mean(), 0.0)
    with_time[_is_free(placed)] += free @ going[1:] / (going @ going)
    return float(np.std(placed.fields @ with_time))


def _is_free(placed: Placed) -> np.typing.NDArray[np.bool_]:
    return np.asarray(placed.waves <= _FREE_WAVES)


def splines(at: Float, low: float, high: float, count: int) -> Float:
    """(V, count) cubic B-splines, evenly between two values, at values (V,)."""
    inner = np.linspace(low, high, count - _DEGREE + 1)
    knots = np.concatenate([[low] * _DEGREE, inner, [high] * _DEGREE])
    inside = np.clip(at, low, np.nextafter(high, low))
    return np.asarray(BSpline.design_matrix(inside, knots, _DEGREE).toarray())
