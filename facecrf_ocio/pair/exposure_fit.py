"""Fit code values of one scene at several exposures: one response, one light a point.

The objective is that of Debevec and Malik (SIGGRAPH 1997, eq. 3), with what real brackets need
besides: the response is a spline, residuals count in units of what noise of one code does there
and by Tukey's biweight, and the exposures may depart from the camera's grid.

What is smooth is told by how known responses bend (`response_bends.py`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline
from scipy.sparse.csgraph import connected_components

from facecrf_ocio.pair.response_bends import DEGREE, SIZE, knots, known_bends
from facecrf_ocio.response.own_light import without_own_light
from facecrf_ocio.response.robust import biweight, robust_deviation
from facecrf_ocio.values import CHANNELS, Bool, Float, Index

CODES = 256  # of 8 bits, to which all photos of a bracket are brought
FEWEST_POINTS = 100  # of a fit: five and more for each of the curve's coefficients
FEWEST_SHARED = 30  # points that two photos, or a photo and the others, are compared by
# Of weighing anew, from nothing and from a fit of other points; chosen by judgment.
_ROUNDS, _FEW_ROUNDS = 6, 2
_PATCH_NOISE = 0.6  # [code value] of the mean of a small patch, with what JPEG does to it
# [stop] What points differ by at best: flicker, shutters, rounding of JPEG's blocks.
_AT_BEST = 0.012
_SHUTTER = 0.02  # [stop] standard deviation of one exposure from its place on the grid
_EXACT = 1e4  # [1/stop] how firmly it is held that exposures are not stretched as a whole
# Points that two photos share, from which on one tells of the other's exposure. Of a scene, a few
# of a thousand are glare, compression or what moved, and agree on nothing.
_LINKED = 30
_LEAST_SLOPE = 0.2  # [stop / full range] while slopes turn codes into stops
_FEWEST_SPREAD = 0.25  # of a residual: a perfect fit leaves no scale to judge by


@dataclass(frozen=True, slots=True, eq=False)
class ExposureFit:
    """What one system of equations gives.

    Attributes
    ----------
    light
        (3, 256) log2 of light at each code value, up to one constant a channel; it means something
        only where there were points.
    stops
        (J,) the exposures, near those given.
    residual
        [stop] Robust standard deviation of what the fit leaves of a point.
    kept
        Share of the values that were not set aside as moved, textured or otherwise wrong.
    stretch
        Standard error of the factor of all exposures, from how far those given are off.
    solution
        All unknowns, for another fit to start from.
    """

    light: Float
    stops: Float
    residual: float
    kept: float
    stretch: float
    solution: Float


def fit_exposures(
    codes: Float,
    usable: Bool,
    stops: Float,
    smoothness: float = 1.0,
    start: ExposureFit | None = None,
) -> ExposureFit:
    """Solve for the response, the light of all points and the departures of the exposures.

    Parameters
    ----------
    codes
        (J, N, 3) code values of N points in J exposures, 0 to 255.
    usable
        (J, N) which of them are neither clipped nor drowned; each point in two exposures or more.
    stops
        (J,) log2 of the exposures. A factor common to all their differences cannot be told from
        the response's exponent, so it is held.
    smoothness
        Factor on the precision of the spline's second differences.
    start
        A fit of the same bracket, from which this one needs fewer rounds.
    """
    values, linked = _values(codes, usable), _linked(usable)
    solution = np.empty(0) if start is None else start.solution
    for _ in range(_ROUNDS if start is None else _FEW_ROUNDS):
        weights = _weights(values, solution)[0] if solution.size else values.even
        told = np.bincount(values.shot, weights.sum(axis=0), len(stops)).astype(np.float64)
        prior, right = _prior(stops, smoothness, _held(stops, told, linked))
        rows = [
            without_own_light(a, w, values.first) for a, w in zip(values.rows, weights, strict=True)
        ]
        solution = np.linalg.solve(prior + _normal(rows, weights, len(stops)), right)
    raw, kept = _weights(values, solution)[1:]
    grid = np.arange(CODES) / 255.0
    light = np.array([_spline(solution, c)(grid) for c in range(len(CHANNELS))])
    refined = solution[len(CHANNELS) * SIZE :]
    stretch = _stretch(refined - stops, _held(stops, told, linked))
    return ExposureFit(light, refined, raw, kept, stretch, solution)


@dataclass(frozen=True, slots=True, eq=False)
class _Values:
    """All usable values, those of a point one after another.

    `codes` (3, V); `rows` of each channel (V, unknowns): the spline's basis there, and minus 1 for
    the exposure; `shot` (V,) which exposure; `first` (N,) place of each point's first value.
    """

    codes: Float
    rows: tuple[Float, ...]
    shot: Index
    first: Index

    @property
    def even(self) -> Float:
        return np.ones(self.codes.shape)


def _values(codes: Float, usable: Bool) -> _Values:
    point, shot = np.nonzero(usable.T)
    chosen = codes[shot, point].T
    exposure = -np.eye(len(codes))[shot]
    rows = []
    for one in chosen:
        basis = BSpline.design_matrix(np.clip(one / 255.0, 0.0, 1.0), knots(), DEGREE)
        rows.append(np.hstack([basis.toarray(), exposure]))
    return _Values(chosen, tuple(rows), shot, np.flatnonzero(np.diff(point, prepend=-1)))


def _weights(values: _Values, solution: Float) -> tuple[Float, float, float]:
    """(3, V) weights by Tukey's biweight, [stop] residual, and the share that is not set aside.

    A point is judged by its worst channel and shot: what moved or is textured is wrong in all.
    """
    spread = np.array([_spread(one, solution, c) for c, one in enumerate(values.codes)])
    predicted = np.array([a @ _of_channel(solution, c) for c, a in enumerate(values.rows)])
    weight = 1.0 / spread**2
    residual = np.array(
        [
            without_own_light(p[:, None], w, values.first)[:, 0]
            for p, w in zip(predicted, weight, strict=True)
        ]
    )
    standard = np.sqrt(((residual / spread) ** 2).mean(axis=0))
    scale = max(float(np.median(standard)), _FEWEST_SPREAD)
    tukey = biweight(standard, scale)
    return weight * tukey / scale**2, robust_deviation(residual), float((tukey > 0.0).mean())


def _normal(rows: list[Float], weights: Float, shots: int) -> Float:
    """Sum (U, U) of the normal equations of channels' rows (N, ...), each with its own spline."""
    size = len(CHANNELS) * SIZE + shots
    total = np.zeros((size, size))
    for channel, (a, w) in enumerate(zip(rows, weights, strict=True)):
        place = _places(channel, size)
        total[np.ix_(place, place)] += (a * w[:, None]).T @ a
    return total


def _linked(usable: Bool) -> Index:
    """(J,) which photos share points, those of one group by one number."""
    seen = usable.astype(np.float64)
    return np.asarray(connected_components(seen @ seen.T >= _LINKED, directed=False)[1])


@dataclass(frozen=True, slots=True, eq=False)
class _Held:
    """What is held of the exposures of each group that shares points, (G, J) each.

    `share` of each photo in what its group tells; `depth` [stop] of its exposure from their mean.
    """

    share: Float
    depth: Float

    @property
    def directions(self) -> Float:
        """(2G, J) in which exposures do not depart: as one, and in proportion."""
        rows = np.concatenate([self.share, self.share * self.depth])
        return np.asarray(rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-12))


def _held(stops: Float, told: Float, linked: Index) -> _Held:
    """Of (J,) exposures, the weight of the values of each, and the group each belongs to."""
    share = np.where(linked == np.arange(linked.max() + 1)[:, None], np.maximum(told, 1e-9), 0.0)
    share = share / share.sum(axis=1, keepdims=True)
    return _Held(share, stops - (share @ stops)[:, None])


def _stretch(departures: Float, held: _Held) -> float:
    """Standard error of the slope of true exposures over those given, by departures [stop]."""
    several = (held.share > 0.0).sum(axis=1) > 1
    share, depth = held.share[several], held.depth[several]
    if not share.size or not (share * depth**2).sum() > 0.0:
        return 0.0
    free = (share > 0.0).sum() - 2 * len(share)
    count = (share > 0.0).sum(axis=1, keepdims=True)
    square = float((share * count * departures**2).sum() / free) if free > 0 else 0.0
    leverage = np.linalg.norm(share * depth) / (share * depth**2).sum()
    return float(leverage * max(np.sqrt(square), _SHUTTER))


def _prior(stops: Float, smoothness: float, held: _Held) -> tuple[Float, Float]:
    """Splines that bend as responses do, 0 in mid-range; exposures near those given (J,) [stop].

    As normal equations: matrix (U, U) and right side (U,).
    """
    size = len(CHANNELS) * SIZE + len(stops)
    matrix, right = 1e-9 * np.eye(size), np.zeros(size)
    second = np.diff(np.eye(SIZE), 2, axis=0)
    usual, precision_of_bends = known_bends()
    weight = smoothness * second.T @ precision_of_bends
    middle = BSpline.design_matrix(np.array([0.5]), knots(), DEGREE).toarray()[0]
    one = weight @ second + _EXACT**2 * np.outer(middle, middle)
    for channel in range(len(CHANNELS)):
        place = slice(channel * SIZE, (channel + 1) * SIZE)
        matrix[place, place] += one
        right[place] = weight @ usual
    fixed = held.directions
    precision = np.eye(len(stops)) / _SHUTTER**2 + _EXACT**2 * fixed.T @ fixed
    last = slice(len(CHANNELS) * SIZE, size)
    matrix[last, last] += precision
    right[last] = precision @ stops
    return matrix, right


def _spread(codes: Float, solution: Float, channel: int) -> Float:
    """[stop] what noise does to each value."""
    slope = _spline(solution, channel).derivative()(codes / 255.0)
    return np.asarray(np.hypot(_AT_BEST, np.maximum(slope, _LEAST_SLOPE) * _PATCH_NOISE / 255.0))


def _spline(solution: Float, channel: int) -> BSpline:
    return BSpline(knots(), solution[channel * SIZE : (channel + 1) * SIZE], DEGREE)


def _places(channel: int, size: int) -> Index:
    own = np.arange(channel * SIZE, (channel + 1) * SIZE)
    return np.concatenate([own, np.arange(len(CHANNELS) * SIZE, size)])


def _of_channel(solution: Float, channel: int) -> Float:
    return np.asarray(solution[_places(channel, solution.size)])
