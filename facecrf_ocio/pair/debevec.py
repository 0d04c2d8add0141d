"""The response of a bracket: exposures of one scene, of which EXIF tells the ratios.

Debevec and Malik, *Recovering High Dynamic Range Radiance Maps from Photographs* (SIGGRAPH 1997),
as OpenCV implements it, on the points of `samples.py`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from facecrf_ocio.pair.code_samples import Samples
from facecrf_ocio.response.model import inverse_crf
from facecrf_ocio.values import CHANNELS, Float, InverseCRF

# Code values from which and up to which a point is neither drowned nor clipped in a photo.
LOWEST, HIGHEST = 2, 252
_SIDE = 14  # a square of so many points at most is handed to OpenCV, which takes them all
_FEWEST = 100
_SMOOTHNESS = 100.0  # OpenCV's lambda; its 10 gave three times the error on rendered faces
_SAME_STEP = 0.1  # [stop]
_NEAR = 8  # [code value] what a point says of its neighbors

# When a bracket's curve is used. Of 245 brackets of rendered faces (DoRF's responses, JPEG, noise,
# three to five exposures 0.7 to 3 stops apart) 58 passed: their error after one scale was 0.010 in
# the median and 0.033 at most, that of the others 0.035 and more than 0.097 for one in ten.
MIN_STOPS = 1.0
MIN_COVERED = 0.8
MAX_HALVES = 0.02
MAX_BEND = 0.02
MAX_RESIDUAL = 0.3
_FLOOR = 0.012  # deviation of the curves that passed, beyond what halves and smoothness tell


@dataclass(frozen=True, slots=True, eq=False)
class BracketCurve:
    """What Debevec's method makes of a bracket, and how far it can be trusted.

    Attributes
    ----------
    found
        The curve, None where too few points are neither drowned nor clipped.
    sigma
        (3, 4096) deviation of the curve, from what two halves of the points say.
    stops
        From the shortest to the longest exposure.
    halves
        RMSE between the curves of the halves.
    bend
        RMSE between the curves of half and of double the smoothness.
    residual
        RMS of log exposure (natural) that the curve leaves unexplained.
    covered
        Share of the code values from `LOWEST` to `HIGHEST` that some point lies near.
    problem
        Why the curve is not to be used, empty if it is.
    """

    found: InverseCRF | None
    sigma: Float
    stops: float
    halves: float
    bend: float
    residual: float
    covered: float
    problem: str


def solve_bracket(samples: Sequence[Samples], stops: Sequence[float]) -> BracketCurve:
    """Estimate the response of one bracket.

    Parameters
    ----------
    samples
        For each exposure, (N, 3) code values at the same points.
    stops
        log2 of each exposure; only differences matter.
    """
    codes = np.stack(samples)
    span = max(stops) - min(stops)
    points, step = _pairs(codes, stops)
    if points.shape[1] < _FEWEST:
        problem = "too few points are neither drowned nor clipped in two of its photos"
        return BracketCurve(None, np.empty(0), span, 0.0, 0.0, 0.0, 0.0, problem)
    whole = _debevec(points, step, _SMOOTHNESS)
    found = _normalized(whole)
    one, other = (
        _normalized(_debevec(points[:, half::2], step, _SMOOTHNESS)).linear for half in (0, 1)
    )
    rough, smooth = (
        _normalized(_debevec(points, step, _SMOOTHNESS * factor)).linear for factor in (0.5, 2.0)
    )
    apart, bent = one - other, rough - smooth
    halves = float(np.sqrt((apart**2).mean()))
    bend = float(np.sqrt((bent**2).mean()))
    residual, covered = _residual(whole, points, step), _covered(points)
    # Two halves differ by twice the deviation of their mean.
    variance = ((apart / 2.0) ** 2 + bent**2).mean(axis=0) + _FLOOR**2
    sigma = np.tile(np.sqrt(variance), (len(CHANNELS), 1))
    problem = _problem(span, halves, bend, residual, covered)
    return BracketCurve(found, sigma, span, halves, bend, residual, covered, problem)


def _problem(span: float, halves: float, bend: float, residual: float, covered: float) -> str:
    if span < MIN_STOPS:
        return f"its exposures span {span:.1f} stops, fewer than {MIN_STOPS:g}"
    if covered < MIN_COVERED:
        return f"its points lie near {100.0 * covered:.0f} % of the code values, too few"
    if residual > MAX_RESIDUAL:
        return f"its photos do not agree with their exposures (residual {residual:.2f})"
    if halves > MAX_HALVES:
        return f"two halves of its points give curves {halves:.3f} apart, too far"
    if bend > MAX_BEND:
        return f"its curve depends on how smooth it is asked to be, by {bend:.3f}, too much"
    return ""


def _pairs(codes: Samples, stops: Sequence[float]) -> tuple[Samples, float]:
    """Points as two photos see them that are one step apart, (2, N, 3), and that step in stops.

    Debevec's method knows each point's light up to one factor only, so pairs from all along a
    bracket can stand for two photos, and values that are drowned or clipped need not come in:
    with all photos at once these bent the curves of wide brackets by two to three times the error.
    """
    order = np.argsort(stops, kind="stable")
    steps = np.diff(np.asarray(stops, dtype=np.float64)[order])
    alike = [np.abs(steps - step) < _SAME_STEP for step in steps]
    best = max(range(len(steps)), key=lambda index: (alike[index].sum(), -index))
    clear = (codes >= LOWEST) & (codes <= HIGHEST)
    found = []
    for index in np.flatnonzero(alike[best]):
        pair = order[[index, index + 1]]
        found.append(codes[pair][:, clear[pair].all(axis=(0, 2))])
    points = np.concatenate(found, axis=1)
    bright = points.astype(np.float64).mean(axis=(0, 2))
    return points[:, np.argsort(bright, kind="stable")], float(steps[best])


def _debevec(points: Samples, step: float, smoothness: float) -> Float:
    """(3, 256) exposure at each code value, up to one scale."""
    count = points.shape[1]
    side = min(_SIDE, int(np.sqrt(count)))
    index = np.linspace(0, count - 1, side * side).astype(np.intp)
    images = [np.ascontiguousarray(one[index].reshape(side, side, 3)) for one in points]
    solver = cv2.createCalibrateDebevec(samples=side * side)
    solver.setLambda(smoothness)
    response = solver.process(images, np.array([1.0, 2.0**step], np.float32))
    return np.asarray(response[:, 0, :].T, dtype=np.float64)


def _normalized(response: Float) -> InverseCRF:
    grid = np.linspace(0.0, 1.0, 256)
    rising = np.maximum.accumulate(response, axis=1)
    return inverse_crf(grid, rising / rising[:, -1:])


def _residual(response: Float, points: Samples, step: float) -> float:
    """RMS of what each point's exposure grew by, less what it should have, in log."""
    apart = np.stack(
        [
            np.log(response[c, points[1, :, c]] / response[c, points[0, :, c]])
            for c in range(len(CHANNELS))
        ]
    )
    return float(np.sqrt(((apart - step * np.log(2.0)) ** 2).mean()))


def _covered(points: Samples) -> float:
    """Share of the code values that a point lies near, in the channel where it is least."""
    shares = []
    for channel in range(len(CHANNELS)):
        hit = np.zeros(256)
        hit[points[..., channel]] = 1.0
        near = np.convolve(hit, np.ones(2 * _NEAR + 1), mode="same") > 0
        shares.append(float(near[LOWEST : HIGHEST + 1].mean()))
    return min(shares)


def rmse_after_scale(one: InverseCRF, other: InverseCRF) -> float:
    """RMSE of two curves on 1,024 uniform code values, after the scale of `one` that fits best."""
    grid = np.linspace(0.0, 1.0, 1024)
    ours, theirs = (
        np.stack([np.interp(grid, curve.encoded, row) for row in curve.linear])
        for curve in (one, other)
    )
    scale = float((ours * theirs).sum() / (ours**2).sum())
    return float(np.sqrt(((scale * ours - theirs) ** 2).mean()))
