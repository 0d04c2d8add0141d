"""The response of a bracket: exposures of one scene, of which EXIF tells the ratios."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from facecrf_ocio.pair.exposure_fit import CODES, FEWEST_POINTS, ExposureFit, fit_exposures
from facecrf_ocio.pair.extrapolate import continued
from facecrf_ocio.pair.left_out import false_exposure, fits_without
from facecrf_ocio.pair.told_order import out_of_order
from facecrf_ocio.response.expected_stops import expected_of_deviation
from facecrf_ocio.response.model import dorf_model, inverse_crf
from facecrf_ocio.response.stops import MID_GRAY
from facecrf_ocio.values import CHANNELS, Bool, Float, InStops, InverseCRF

# Code values from which and up to which a point is neither drowned nor clipped in a photo.
LOWEST, HIGHEST = 4, 249
# Next to white some pixels of a patch are clipped already, and next to black some are drowned.
_SURE_FROM, _SURE_TO = 6.0, 245.0
_NEAR = 8  # [code value] what a point says of its neighbors

MIN_STOPS = 1.0  # [stop] from the darkest to the brightest exposure; chosen by judgment
# Share of the code values with points near them. Made curves with 80 and 86 % would be 0.01 stops
# off in the midtones, up to 0.64 in the shadows; a curve unlike all known ones with 83 % was off by
# 0.2 (RMSE), and nothing else told (docs/evidence).
MIN_COVERED = 0.88
# Both chosen by judgment.
MAX_HALVES = 0.03  # [1] RMSE of curves from two halves of the points: what the tables call 3
MAX_BEND = 0.02  # [1] RMSE by which another smoothness may change the curve
MAX_RESIDUAL = 0.15
"""[stop]"""
MIN_KEPT = 0.6  # share of the points that Tukey's biweight keeps: at less, most of the scene moved
_BEYOND = 0.02  # [stop] deviation of the curves that passed, beyond what halves and smoothness tell
_GUESSED = 0.3  # of the stops from the brightest point to white, which known responses bridge
# Of all stops: how far the camera's times may be stretched as a whole, besides what is told by how
# they depart from the pixels.
_STRETCH = 0.015
# [stop] What steady cameras leave. By what is left beyond it each photo's own curve differs.
_USUAL_RESIDUAL = 0.06
# [stop] Standard deviation of two channels' light above this code, up to which they are alike: of
# one curve 0.007 at most, of responses whose channels differ 0.02 to 0.4.
_ALIKE, _ALIKE_FROM = 0.05, 0.25


@dataclass(frozen=True, slots=True, eq=False)
class BracketCurve:
    """What a bracket gives, and how far it can be trusted.

    Attributes
    ----------
    found
        The curve, None where too few points are neither drowned nor clipped.
    sigma
        (3, 4096) deviation of the curve, from what two halves of the points say.
    in_stops
        The same in stops, with the factor taken out at mid-gray: how far white lies beyond the
        brightest point, which is most of `sigma`, says nothing of the shape.
    stops
        From the shortest to the longest exposure.
    halves
        RMSE between the curves of the halves.
    bend
        RMSE between the curves of half and of double the smoothness.
    residual
        [stop] Robust standard deviation of the log exposures that the curve leaves unexplained.
    covered
        Share of the code values from `LOWEST` to `HIGHEST` that some point lies near.
    problem
        Why the curve is not to be used, empty if it is.
    refined
        (J,) the exposures in stops, as the pixels have them.
    false
        Index of the photo whose exposure is not what was told, and [stop] by how much, if one is.
    """

    found: InverseCRF | None
    sigma: Float
    in_stops: InStops | None
    stops: float
    halves: float
    bend: float
    residual: float
    covered: float
    problem: str
    refined: Float
    false: tuple[int, float] | None = None


def solve_bracket(
    samples: npt.ArrayLike,
    stops: Sequence[float] | Float,
    usable: Bool | None = None,
) -> BracketCurve:
    """Estimate the response of one bracket.

    Parameters
    ----------
    samples
        (J, N, 3) code values of each exposure at the same points, 0 to 255.
    stops
        log2 of each exposure; only differences matter.
    usable
        (J, N) which of them are to be used, besides being neither drowned nor clipped.
    """
    codes, given = np.asarray(samples, np.float64), np.asarray(stops, np.float64)
    span = float(np.ptp(given))
    clear = (codes.min(axis=2) >= LOWEST) & (codes.max(axis=2) <= HIGHEST)
    clear = clear if usable is None else clear & usable
    clear &= clear.sum(axis=0) >= 2
    told = clear.any(axis=0)
    if told.sum() < FEWEST_POINTS:
        problem = "too few points are neither drowned nor clipped in two of its photos"
        return BracketCurve(None, np.empty(0), None, span, 0.0, 0.0, 0.0, 0.0, problem, given)
    codes, clear = codes[:, told], clear[:, told]
    whole = fit_exposures(codes, clear, given)
    covered, seen = _covered(codes, clear), _seen(codes, clear)
    found = _curve(whole, seen)
    one, other = (
        _curve(fit_exposures(codes[:, half::2], clear[:, half::2], given, 1.0, whole), seen)
        for half in (0, 1)
    )
    rough, smooth = (_curve(fit_exposures(codes, clear, given, s, whole), seen) for s in (0.5, 2.0))
    halves, bend = _rmse(one, other), _rmse(rough, smooth)
    without = fits_without(codes, clear, given, whole)
    apart = np.stack(
        [
            _log_difference(one, other) / 2.0,
            _log_difference(rough, smooth),
            *_jackknife([_log_difference(_curve(fit, seen), found) for _, fit in without]),
        ]
    )
    sigma, in_stops = _deviations(found, apart, seen, whole.stretch, whole.residual)
    return BracketCurve(
        *(found, sigma, in_stops, span, halves, bend, whole.residual, covered),
        problem=out_of_order(codes, clear, given) or _problem(span, halves, bend, whole, covered),
        refined=whole.stops,
        false=false_exposure(codes, clear, given, without),
    )


def _jackknife(apart: list[Float]) -> list[Float]:
    """Deviations by curves without some photos, from their differences (...) to that of all."""
    if len(apart) < 2:
        return []
    scale = np.sqrt(1.0 - 1.0 / len(apart))
    return list(scale * (np.array(apart) - np.mean(apart, axis=0)))


def _deviations(
    found: InverseCRF,
    apart: Float,
    seen: list[tuple[float, float]],
    stretch: float,
    residual: float,
) -> tuple[Float, InStops]:
    """Of light with white at 1, and in stops with the factor out at mid-gray.

    `apart` (D, 3, K) are differences in stops, each a deviation of its own, `seen` the code values
    between which each channel's points lie, `stretch` the deviation of the factor of all exposures.
    """
    stretch = float(np.hypot(_STRETCH, stretch))
    toned = max(residual**2 - _USUAL_RESIDUAL**2, 0.0)
    depth = np.log2(np.maximum(found.linear, 2.0**-12))
    unseen = np.array(
        [[-np.interp(s[1] / 255.0, found.encoded, d)] for s, d in zip(seen, depth, strict=True)]
    )
    white = (
        (apart**2).sum(axis=0)
        + _BEYOND**2
        + toned
        + (stretch * depth) ** 2
        + (_GUESSED * np.minimum(unseen, -depth)) ** 2
    )
    sigma = found.linear * np.log(2.0) * np.sqrt(white)
    sigma[:, [0, -1]] = 0.0
    codes = np.arange(CODES) / 255.0
    depth, *differences = (
        np.array([np.interp(codes, found.encoded, row) for row in rows]) for rows in (depth, *apart)
    )
    shifts = [rows - rows[:, [MID_GRAY]] for rows in (stretch * depth, *differences)]
    guessed = _GUESSED * np.maximum(depth + unseen, 0.0)
    shape = 2.0 * _BEYOND**2 + toned + np.sum(np.square(shifts), axis=0) + guessed**2
    return sigma, expected_of_deviation(np.sqrt(shape))


def bracket_reasons(solved: BracketCurve) -> tuple[str, ...]:
    """What tells of a bracket's curve how good it is, in sentences."""
    return (
        f"two halves of the points give curves {solved.halves:.3f} apart (RMSE)",
        f"the exposures leave {solved.residual:.3f} stops of the points unexplained",
    )


def _problem(span: float, halves: float, bend: float, fit: ExposureFit, covered: float) -> str:
    if span < MIN_STOPS:
        return f"its exposures span {span:.1f} stops, fewer than {MIN_STOPS:g}"
    if covered < MIN_COVERED:
        return f"its points lie near {100.0 * covered:.0f} % of the code values, too few"
    if fit.residual > MAX_RESIDUAL or fit.kept < MIN_KEPT:
        return (
            f"its photos do not agree with their exposures (residual {fit.residual:.2f} stops, "
            f"{100.0 * (1.0 - fit.kept):.0f} % of the points far off)"
        )
    if halves > MAX_HALVES:
        return f"two halves of its points give curves {halves:.3f} apart, too far"
    if bend > MAX_BEND:
        return f"its curve depends on how smooth it is asked to be, by {bend:.3f}, too much"
    return ""


def _seen(codes: Float, clear: Bool) -> list[tuple[float, float]]:
    """[code value] between which a channel's points lie, without the few outermost."""
    own = codes[clear]
    return [
        (
            max(_SURE_FROM, float(np.quantile(own[:, c], 0.002))),
            min(_SURE_TO, float(np.quantile(own[:, c], 0.998))),
        )
        for c in range(len(CHANNELS))
    ]


def _curve(fit: ExposureFit, seen: list[tuple[float, float]]) -> InverseCRF:
    """Where points lie, what they say; below and above, as known responses go on.

    How a channel goes on to white decides all of its light beside the others'. So one that is like
    the channel that is seen highest goes on as that one does; others as the known response does
    that is nearest to them.
    """
    model = dorf_model()
    rows: list[Float] = []
    known, insides = [], []
    for light, (low, high) in zip(fit.light, seen, strict=True):
        own = np.interp(model.grid, np.arange(CODES) / 255.0, np.maximum.accumulate(np.exp2(light)))
        inside = (model.grid >= low / 255.0) & (model.grid <= high / 255.0)
        known.append(continued(own, inside, model))
        first = int(np.argmax(inside))
        own[:first] = known[-1][:first] * own[first] / known[-1][first]
        rows.append(own)
        insides.append(inside)
    highest = int(np.argmax([high for _, high in seen]))
    guide = _going_on(rows[highest], known[highest], insides[highest])
    for channel, inside in enumerate(insides):
        both = inside & insides[highest] & (model.grid > _ALIKE_FROM)
        apart = np.log2(rows[channel][both] / guide[both])
        alike = apart.size > 0 and float(apart.std()) < _ALIKE
        rows[channel] = _going_on(rows[channel], guide if alike else known[channel], inside)
    return inverse_crf(model.grid, np.array([(own - own[0]) / (own[-1] - own[0]) for own in rows]))


def _going_on(own: Float, other: Float, inside: Bool) -> Float:
    """A curve (K,), its own as far as points lie (K,), above it in proportion to another (K,)."""
    last = int(np.flatnonzero(inside)[-1])
    return np.concatenate([own[:last], other[last:] * own[last] / other[last]])


def _log_difference(one: InverseCRF, other: InverseCRF) -> Float:
    tiny = 2.0**-14
    return np.asarray(np.log2(np.maximum(one.linear, tiny) / np.maximum(other.linear, tiny)))


def _covered(codes: Float, clear: Bool) -> float:
    """Share of the code values that a point lies near, in the channel where it is least.

    `codes` (J, P, 3) count where they are `clear` (J, P).
    """
    shares = []
    for channel in range(len(CHANNELS)):
        hit = np.zeros(CODES)
        hit[np.rint(codes[clear][:, channel]).astype(np.intp)] = 1.0
        near = np.convolve(hit, np.ones(2 * _NEAR + 1), mode="same") > 0
        shares.append(float(near[LOWEST : HIGHEST + 1].mean()))
    return min(shares)


def _rmse(one: InverseCRF, other: InverseCRF) -> float:
    """RMSE of two curves, after the scale of each channel that fits best: white is not seen."""
    scale = (one.linear * other.linear).sum(axis=1) / (one.linear**2).sum(axis=1)
    return float(np.sqrt(((scale[:, None] * one.linear - other.linear) ** 2).mean()))


def rmse_after_scale(one: InverseCRF, other: InverseCRF) -> float:
    """RMSE of two curves on 1,024 uniform code values, after the scale of `one` that fits best."""
    grid = np.linspace(0.0, 1.0, 1024)
    ours, theirs = (
        np.stack([np.interp(grid, curve.encoded, row) for row in curve.linear])
        for curve in (one, other)
    )
    scale = float((ours * theirs).sum() / (ours**2).sum())
    return float(np.sqrt(((scale * ours - theirs) ** 2).mean()))
