"""How a curve that changes goes over a clip: frame by frame, and in stretches that share one.

One direction of change is sought (all coefficients change together) and how far along it each frame
lies, in turn. Then a line over time and one or two sudden changes are held against each other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations, pairwise

import numpy as np

from facecrf_ocio.clip.point_values import (
    Values,
    compared,
    log_light,
    robust_weights,
    unexplained,
    values_of,
)
from facecrf_ocio.clip.shared_light import ALIKE_IN_TIME, solve_drift
from facecrf_ocio.clip.tracked_points import TrackedPoints
from facecrf_ocio.joint.prior import FamilyPrior, Posterior
from facecrf_ocio.response.own_light import without_own_light
from facecrf_ocio.values import CHANNELS, Float

_ROUNDS = 5  # of direction and course in turn: where exposure is fixed they come near slowly
# [stop] standard deviation of exposures that tell nothing of a bend: a change of the curve by 0.03
# passes for 0.13.
_STILL = 0.2
# Correlation of exposure with time: of eight clips above it that were told to drift five did not,
# of 24 others in light that keeps its pattern one.
_EVENLY = 0.9
_NEWTON = 3  # steps to the course that a direction gives
_WIDE = 1.0  # standard deviation of a frame's place, in units of the clip's length
_FEWEST = 6  # frames in which a course shows
_PARTS = 3  # of a change that goes evenly: a sixth of it is left at either end of each
_JUMPS = 2  # sudden changes at most: more are not told from an even one by a dozen frames
_LEAST_JUMP = 0.25  # of the whole change: a smaller second jump is scatter
_CLEAR = 4.0  # scatter of frames about their course that it must exceed to be told


@dataclass(frozen=True, slots=True, eq=False)
class CurveCourse:
    """How a curve goes over a clip.

    Attributes
    ----------
    change
        (M,) of the coefficients for one unit of the course.
    covariance
        (M, M) of that.
    places
        (J,) of the frames along it, their mean 0.
    with_exposure
        Whether exposure goes one way over time as well, which can feign such a course.
    """

    change: Float
    covariance: Float
    places: Float
    with_exposure: bool


@dataclass(frozen=True, slots=True)
class Level:
    """Frames that share a curve: first and last of J, their place on the course."""

    first: int
    last: int
    place: float


@dataclass(frozen=True, slots=True)
class CourseLevels:
    """All of a clip, and whether the curve goes evenly from one to the next or jumps."""

    even: bool
    parts: tuple[Level, ...]


def course_of_points(
    faces: Posterior, points: TrackedPoints, times: Float, prior: FamilyPrior
) -> CurveCourse:
    """Direction and course of a curve's change; parameters as of `drift_of_points`."""
    values = values_of(points, times, None)
    places: Float = times
    length = float(np.std(times))
    for _ in range(_ROUNDS):
        found, covariance = solve_drift(faces, values, prior)
        stops = _exposures(values, found, prior)
        places = _beside(stops, _places(values, found, places, faces, prior), times)
        places = (places - places.mean()) * length / max(float(np.std(places)), 1e-9)
        values = replace(values, time=places[values.group // len(CHANNELS)])
    found, covariance = solve_drift(faces, values, prior)
    size = faces.mean.size
    stops = _exposures(values, found, prior)
    alike = abs(float(np.corrcoef(stops, times)[0, 1])) if np.std(stops) >= _STILL else 0.0
    return CurveCourse(found[size:], covariance[size:, size:], places, alike > _EVENLY)


def _exposures(values: Values, found: Float, prior: FamilyPrior) -> Float:
    """(J,) log2 of what frames were exposed by, as points show it."""
    light = log_light(values.codes, values, found, prior)
    apart = without_own_light(light[:, None], np.ones(light.size), values.first)[:, 0]
    frame = values.group // len(CHANNELS)
    return np.array([np.median(apart[frame == one]) for one in range(frame.max() + 1)])


def _beside(stops: Float, places: Float, times: Float) -> Float:
    """Places less what goes with exposure, and not with time.

    A bend of the curve looks like an exponent that goes with exposure, and the other way round.
    """
    if np.std(stops) < _STILL:
        return places
    going = stops - stops.mean()
    both = np.column_stack([np.ones(len(times)), times, going])
    return np.asarray(places - np.linalg.lstsq(both, places, rcond=None)[0][2] * going)


def _places(
    values: Values, found: Float, places: Float, faces: Posterior, prior: FamilyPrior
) -> Float:
    """(J,) of frames along one direction; the curve itself, which exposure shows, is free."""
    size, count = found.size // 2, len(places)
    frame = values.group // len(CHANNELS)
    start = np.concatenate([found[:size], places])
    spread = np.zeros((size + count, size + count))
    spread[:size, :size] = np.linalg.inv(faces.covariance)
    spread[size:, size:] = np.eye(count) / _WIDE**2
    now: Float = start
    weights: Float = np.ones(values.codes.size)
    for number in range(_NEWTON):
        values = replace(values, time=now[size:][frame])
        both = np.concatenate([now[:size], found[size:]])
        light, left, rows, noise = compared(values, both, weights, prior, ALIKE_IN_TIME)
        # All values count until places are found once: before, what fits a wrong one least tells.
        weights = robust_weights(left, noise) if number == _NEWTON - 1 else noise**-2
        of_frame = np.zeros((len(light), count))
        of_frame[np.arange(len(light)), frame] = rows[:, :size] @ found[size:]
        shown = np.column_stack([rows[:, :size], of_frame, light])
        shown = unexplained(shown, weights, values, ALIKE_IN_TIME)
        joint = shown.T @ (shown * weights[:, None]) / ALIKE_IN_TIME
        pull = spread @ (start - now) - joint[:-1, -1]
        now = now + np.linalg.solve(spread + joint[:-1, :-1], pull)
    return np.asarray(now[size:])


def posterior_at(place: float, course: CurveCourse, whole: Posterior, scale: float) -> Posterior:
    """Of the curve at a place of its course, by that of the whole clip.

    `scale` is the factor on the deviations of posteriors that makes them honest.
    """
    wider = (place / scale) ** 2 * course.covariance
    return Posterior(whole.weights, whole.means + place * course.change, whole.covariances + wider)


def levels_of(places: Float, times: Float) -> CourseLevels | None:
    """Stretches of frames that share a curve; None where their scatter hides the course.

    Parameters
    ----------
    places, times
        (J,) of the frames, along the course and in the clip.
    """
    count = len(places)
    if count < _FEWEST:
        return None
    line = np.polynomial.Polynomial.fit(times, places, 1)(times)
    # A line has two numbers, levels with jumps between them one more than twice the jumps.
    fits: list[tuple[tuple[float, float], Float, tuple[int, ...]]]
    fits = [(_worth(places, line, 2), line, ())]
    for at in _jumps(count):
        fitted = _levels(places, at)
        if _is_of_jumps(fitted, at):
            fits.append((_worth(places, fitted, 1 + 2 * len(at)), fitted, at))
    (_, scatter), fitted, at = min(fits, key=lambda one: one[0][0])
    if float(np.ptp(fitted)) < _CLEAR * scatter:
        return None
    cuts = at or tuple(np.searchsorted(times, np.linspace(times[0], times[-1], _PARTS + 1)[1:-1]))
    return CourseLevels(
        not at,
        tuple(
            Level(int(a), int(b) - 1, float(fitted[a:b].mean()))
            for a, b in pairwise((0, *cuts, count))
        ),
    )


def _jumps(count: int) -> Iterator[tuple[int, ...]]:
    """Places of one or two jumps, two frames apart or more: one frame alone is no stretch."""
    for number in range(1, _JUMPS + 1):
        for at in combinations(range(2, count - 1), number):
            if all(after - before > 1 for before, after in pairwise(at)):
                yield at


def _is_of_jumps(fitted: Float, at: tuple[int, ...]) -> bool:
    """Whether each jump is a part of the change that counts."""
    sizes = [abs(fitted[one] - fitted[one - 1]) for one in at]
    return bool(min(sizes) >= _LEAST_JUMP * float(np.ptp(fitted)))


def _levels(places: Float, at: tuple[int, ...]) -> Float:
    bounds = pairwise((0, *at, len(places)))
    return np.concatenate([np.full(b - a, places[a:b].mean()) for a, b in bounds])


def _worth(places: Float, fitted: Float, numbers: int) -> tuple[float, float]:
    """Bayesian information criterion (less is better), and the scatter about the fit."""
    count, left = len(places), float(((places - fitted) ** 2).sum()) + 1e-12
    return count * np.log(left / count) + numbers * np.log(count), (left / (count - numbers)) ** 0.5
