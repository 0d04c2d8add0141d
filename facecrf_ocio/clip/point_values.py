"""Values of points that frames share, and how they depend on the coefficients of a curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.clip.light_parts import Placed
from facecrf_ocio.clip.tracked_points import TrackedPoints
from facecrf_ocio.joint.prior import FamilyPrior
from facecrf_ocio.response.own_light import one_each, without_own_light
from facecrf_ocio.response.robust import biweight, biweight_of_squares, robust_deviation
from facecrf_ocio.values import CHANNELS, Bool, Float, Index

_CODE_NOISE = 0.5  # [code value] of a patch's mean, with what codecs do to it
_FLOOR = 0.02  # [stop] what points differ by at best: lights that flicker, vignetting, shading
_NEWTON = 3  # steps from a code to that of its fitted light
_LEAST_ROOT = 0.02  # of the root of light, where the logarithm would run away
_UNKNOWN = 10.0  # [stop] standard deviation of exposures of which nothing is known
_TOLD = 0.03  # [stop] of those that files tell: shutters, and what they leave out

# Of a fit of light that may drift. A point's own noise is taken from its values, beside so many of
# the usual: those at edges, and where light moves, count less.
_USUAL = 5.0
_MOST_NOISE = 9.0  # [usual variance] that one value counts in that
_LEAST_SCALE = 0.1  # of residuals to the noise that was expected
_LOOSE = 1e-2  # precision of a frame's exposure, of which nothing is known


@dataclass(frozen=True, slots=True, eq=False)
class Values:
    """All usable values, those of a point one after another; each channel is a point of its own.

    `codes` (V,) in [0, 1], `time` (V,), `group` (V,) of frame and channel, `first` (P,) place of
    each point's first value, `groups` how many there are; `stops` (V,) what is known of the
    exposures, and `loose` [stop] how far they may lie from that.
    """

    codes: Float
    time: Float
    group: np.typing.NDArray[np.intp]
    first: np.typing.NDArray[np.intp]
    groups: int
    stops: Float
    loose: float


def values_of(points: TrackedPoints, times: Float, stops: Float | None) -> Values:
    """What is usable of points in J frames, of these times and told exposures (J,), if any."""
    usable: Bool = np.repeat(points.usable[:, :, None], len(CHANNELS), axis=2)
    shots = len(points.codes)
    flat = usable.reshape(shots, -1).T
    point, shot = np.nonzero(flat)
    codes = points.codes.reshape(shots, -1).T[point, shot] / 255.0
    group = shot * len(CHANNELS) + point % len(CHANNELS)
    first = np.flatnonzero(np.diff(point, prepend=-1))
    told = np.zeros(shots) if stops is None else stops
    return Values(
        codes,
        np.asarray(times)[shot],
        group,
        first,
        shots * len(CHANNELS),
        np.asarray(told)[shot],
        _UNKNOWN if stops is None else _TOLD,
    )


def log_light(codes: Float, values: Values, found: Float, prior: FamilyPrior) -> Float:
    """(V,) log2 of light of codes, each at its own time."""
    basis, _ = _basis(codes, prior)
    own = found[: found.size // 2] + values.time[:, None] * found[found.size // 2 :]
    mean = np.interp(codes, prior.grid, prior.mean)
    return np.asarray(2.0 * np.log2(np.maximum(mean + (basis * own).sum(axis=1), _LEAST_ROOT)))


def _basis(codes: Float, prior: FamilyPrior) -> tuple[Float, Float]:
    """(V, M) eigenvectors at codes, and their slopes."""
    last = prior.grid.size - 1
    place = np.clip(codes, 0.0, 1.0) * last
    low = np.minimum(place.astype(np.intp), last - 1)
    at, step = prior.basis.T[low], prior.basis.T[low + 1]
    return at + (place - low)[:, None] * (step - at), (step - at) * last


def linearized(
    codes: Float, values: Values, found: Float, prior: FamilyPrior
) -> tuple[Float, Float]:
    """Derivatives (V, 2 M) of the log light of codes, and noise (V,) there in stops."""
    size = found.size // 2
    basis, slopes = _basis(codes, prior)
    own = found[:size] + values.time[:, None] * found[size:]
    slope_of_mean = np.interp(codes, prior.grid, np.gradient(prior.mean, prior.grid))
    mean = np.interp(codes, prior.grid, prior.mean)
    root = np.maximum(mean + (basis * own).sum(axis=1), _LEAST_ROOT)
    slope = np.maximum(slope_of_mean + (slopes * own).sum(axis=1), 0.0)
    per_root = 2.0 / (np.log(2.0) * root)
    rows = per_root[:, None] * basis
    return np.hstack([rows, values.time[:, None] * rows]), expected_noise(per_root * slope)


def fitted_codes(fitted: Float, values: Values, found: Float, prior: FamilyPrior) -> Float:
    """(V,) codes that the curve gives to fitted log light, by Newton steps from the codes seen.

    Derivatives are taken there and not at the codes seen: noise would be in them and in what they
    are to explain, and pull toward the curve that explains everything, which is a flat one.
    """
    codes = values.codes
    for _ in range(_NEWTON):
        rows = log_light(codes, values, found, prior)
        step = 1.0 / (prior.grid.size - 1)
        slope = (log_light(codes + step, values, found, prior) - rows) / step
        codes = np.clip(codes + np.clip((fitted - rows) / np.maximum(slope, 0.5), -0.1, 0.1), 0, 1)
    return codes


def compared(
    values: Values, found: Float, weights: Float, prior: FamilyPrior, alike: float
) -> tuple[Float, Float, Float, Float]:
    """What a Gauss-Newton step rests on.

    Returns
    -------
    relative, left
        (V,) log light beyond what is known of exposures; what points and frames leave of it.
    rows, noise
        As `linearized` has them, where that is explained.
    """
    light = log_light(values.codes, values, found, prior)
    relative = light - values.stops
    left = unexplained(relative[:, None], weights, values, alike)[:, 0]
    fitted = fitted_codes(light - left, values, found, prior)
    return relative, left, *linearized(fitted, values, found, prior)


def expected_noise(slope: Float) -> Float:
    """[stop] of patches' log light at best, by its slope [stop / full range] at their codes."""
    return np.asarray(np.hypot(_FLOOR, slope * _CODE_NOISE / 255.0))


def robust_weights(left: Float, noise: Float) -> Float:
    """Inverse variances (V,) by Tukey's biweight of what is left unexplained (V,) [stop]."""
    standard = left / noise
    scale = max(robust_deviation(standard), 0.25)
    return np.asarray(biweight(standard, scale) / (noise * max(scale, 1.0)) ** 2)


def unexplained(columns: Float, weights: Float, values: Values, alike: float) -> Float:
    """Columns (V, K) less what one number a point and one a frame and channel explain of them."""
    apart = without_own_light(columns, weights, values.first)
    shown = without_own_light(one_each(values.group, values.groups), weights, values.first)
    normal = shown.T @ (shown * weights[:, None]) + np.eye(values.groups) * alike / values.loose**2
    explained = np.linalg.solve(normal, shown.T @ (apart * weights[:, None]))
    return np.asarray(apart - shown @ explained)


def beside_frames(
    columns: Float, weights: Float, placed: Placed, first: Index
) -> tuple[Float, Float]:
    """Columns less what one number a point and one a frame explain of them, and those of frames.

    `first` (P,) is the place of each point's first value.
    """
    shown = without_own_light(one_each(placed.frame, placed.frames), weights, first)
    apart = without_own_light(columns, weights, first)
    heavy = shown * weights[:, None]
    normal = shown.T @ heavy + _LOOSE * np.eye(placed.frames)
    of_frames = np.linalg.solve(normal, heavy.T @ apart)
    return apart - shown @ of_frames, of_frames


def weights_of(standard: Float, first: Index) -> Float:
    """(V, K) of residuals (V, K) in units of the noise that was expected.

    By their scale, by each point's own noise, and robustly; K values at a time are of one kind.
    """
    scale = max(robust_deviation(standard), _LEAST_SCALE)
    standard = standard / scale
    count = np.diff(first, append=len(standard))
    squares = np.minimum(standard**2, _MOST_NOISE).mean(axis=1)
    own = np.add.reduceat(squares, first)
    variance = np.repeat((_USUAL + own) / (_USUAL + count), count)[:, None]
    return np.asarray(biweight_of_squares(standard**2 / variance) / (variance * scale**2))
