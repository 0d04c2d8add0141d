"""What frames of one scene tell of the curve: points whose light all frames share.

Between two frames the light of every point changes by one factor, the exposure's. A curve under
which that holds for dark and bright points alike is the camera's, up to an exponent (Grossberg and
Nayar, PAMI 2003), which the faces tell. Where the curve itself changes over the clip, points of
fixed light show that, its exponent too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.clip.tracked_points import TrackedPoints
from facecrf_ocio.joint.prior import FamilyPrior, Posterior
from facecrf_ocio.values import CHANNELS, Bool, Float

_ROUNDS = 8  # of Gauss-Newton, each with weights anew
_TUKEY = 4.685  # 95 % efficient for Gaussian residuals
_CODE_NOISE = 0.5  # [code value] of a patch's mean, with what codecs do to it
_FLOOR = 0.02  # [stop] what points differ by at best: lights that flicker, vignetting, shading
_NEWTON = 3  # steps from a code to that of its fitted light
_LEAST_ROOT = 0.02  # of the root of light, where the logarithm would run away
# Values err alike (a codec's blocks, noise beneath a bent curve, shading of what moves): so many
# count as one for the curve. From one end of the clip to the other less is alike.
_ALIKE, _ALIKE_IN_TIME = 30.0, 3.0
# Variance of each coefficient that is added to what faces leave: they tell how bright a curve is,
# and not its finest bends, which points tell better. In units of the prior's.
_FINE = 1.0
_SEEN = (0.02, 0.98)  # quantiles of the codes between which a drift is seen
_DRIFT = 0.3  # standard deviation of a drift, in units of the prior's
_UNKNOWN = 10.0  # [stop] standard deviation of exposures of which nothing is known
_TOLD = 0.03  # [stop] of those that files tell: shutters, and what they leave out


def add_points(
    faces: Posterior,
    points: TrackedPoints,
    stops: Float,
    prior: FamilyPrior,
    scale: float,
) -> Posterior:
    """What faces leave of the prior, and then points whose exposures are told.

    Parameters
    ----------
    faces
        Coefficients by the faces.
    points
        The same points in J frames.
    stops
        (J,) log2 of the exposures.
    prior
        Of the curves.
    scale
        Factor on the deviations of posteriors that makes them honest.
    """
    size = faces.mean.size
    values = _values(points, np.zeros(len(stops)), stops)
    start = np.concatenate([faces.mean, np.zeros(size)])
    covariance = scale**2 * faces.covariance + _FINE * np.eye(size)
    found, left = _solve(values, start, _precision(covariance), prior, _ALIKE)
    return Posterior(np.ones(1), found[None, :size], left[None, :size, :size] / scale**2)


def drift_of_points(
    faces: Posterior, points: TrackedPoints, times: Float, prior: FamilyPrior
) -> tuple[float, float]:
    """RMSE between the curves of both ends of a clip, where points lie, and its standard error.

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
    """
    values = _values(points, times, None)
    start = np.concatenate([faces.mean, np.zeros(faces.mean.size)])
    solved = _solve(values, start, _precision(faces.covariance), prior, _ALIKE_IN_TIME)
    return _drift(*solved, values.codes, prior)


def _precision(covariance: Float) -> Float:
    """Of the curve's coefficients, and of those of its drift."""
    size = len(covariance)
    precision = np.eye(2 * size) / _DRIFT**2
    precision[:size, :size] = np.linalg.inv(covariance)
    return precision


def _solve(
    values: _Values, start: Float, precision: Float, prior: FamilyPrior, alike: float
) -> tuple[Float, Float]:
    """Coefficients of the curve and of its drift, and their covariance."""
    found: Float = start
    weights: Float = np.ones(values.codes.size)
    system: Float = precision
    for _ in range(_ROUNDS):
        light = _logs(values.codes, values, found, prior)
        left = _without((light - values.stops)[:, None], weights, values, alike)[:, 0]
        codes = _fitted_codes(light - left, values, found, prior)
        rows, noise = _linearized(codes, values, found, prior)
        weights = _weights(left, noise)
        columns = _without(np.column_stack([rows, light - values.stops]), weights, values, alike)
        joint = columns.T @ (columns * weights[:, None]) / alike
        system = precision + joint[:-1, :-1]
        found = found + np.linalg.solve(system, precision @ (start - found) - joint[:-1, -1])
    return found, np.linalg.inv(system)


@dataclass(frozen=True, slots=True, eq=False)
class _Values:
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


def _values(points: TrackedPoints, times: Float, stops: Float | None) -> _Values:
    usable: Bool = np.repeat(points.usable[:, :, None], len(CHANNELS), axis=2)
    shots = len(points.codes)
    flat = usable.reshape(shots, -1).T
    point, shot = np.nonzero(flat)
    codes = points.codes.reshape(shots, -1).T[point, shot] / 255.0
    group = shot * len(CHANNELS) + point % len(CHANNELS)
    first = np.flatnonzero(np.diff(point, prepend=-1))
    told = np.zeros(shots) if stops is None else stops
    return _Values(
        codes,
        np.asarray(times)[shot],
        group,
        first,
        shots * len(CHANNELS),
        np.asarray(told)[shot],
        _UNKNOWN if stops is None else _TOLD,
    )


def _logs(codes: Float, values: _Values, found: Float, prior: FamilyPrior) -> Float:
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


def _linearized(
    codes: Float, values: _Values, found: Float, prior: FamilyPrior
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
    noise = np.hypot(_FLOOR, per_root * slope * _CODE_NOISE / 255.0)
    return np.hstack([rows, values.time[:, None] * rows]), noise


def _fitted_codes(fitted: Float, values: _Values, found: Float, prior: FamilyPrior) -> Float:
    """(V,) codes that the curve gives to fitted log light, by Newton steps from the codes seen.

    Derivatives are taken there and not at the codes seen: noise would be in them and in what they
    are to explain, and pull toward the curve that explains everything, which is a flat one.
    """
    codes = values.codes
    for _ in range(_NEWTON):
        rows = _logs(codes, values, found, prior)
        step = 1.0 / (prior.grid.size - 1)
        slope = (_logs(codes + step, values, found, prior) - rows) / step
        codes = np.clip(codes + np.clip((fitted - rows) / np.maximum(slope, 0.5), -0.1, 0.1), 0, 1)
    return codes


def _weights(left: Float, noise: Float) -> Float:
    """Inverse variances by Tukey's biweight of what is left unexplained."""
    standard = left / noise
    scale = max(1.4826 * float(np.median(np.abs(standard))), 0.25)
    tukey = np.clip(1.0 - (standard / (_TUKEY * scale)) ** 2, 0.0, 1.0) ** 2
    return np.asarray(tukey / (noise * max(scale, 1.0)) ** 2)


def _without(columns: Float, weights: Float, values: _Values, alike: float) -> Float:
    """Columns less what one number a point and one a frame and channel explain of them."""
    centered = _centered(columns, weights, values.first)
    shown: Float = np.zeros((len(columns), values.groups))
    shown[np.arange(len(columns)), values.group] = 1.0
    shown = _centered(shown, weights, values.first)
    normal = shown.T @ (shown * weights[:, None]) + np.eye(values.groups) * alike / values.loose**2
    explained = np.linalg.solve(normal, shown.T @ (centered * weights[:, None]))
    return np.asarray(centered - shown @ explained)


def _centered(columns: Float, weights: Float, first: np.typing.NDArray[np.intp]) -> Float:
    sums = np.add.reduceat(columns * weights[:, None], first)
    total = np.maximum(np.add.reduceat(weights, first), 1e-12)
    count = np.diff(first, append=len(columns))
    return np.asarray(columns - np.repeat(sums / total[:, None], count, axis=0))


def _drift(
    found: Float, covariance: Float, codes: Float, prior: FamilyPrior
) -> tuple[float, float]:
    """RMSE between both ends of the clip where points lie, after their scale; its standard error.

    The light of white, which no point has, goes with the exposures and is no drift.
    """
    size = found.size // 2
    low, high = np.quantile(codes, _SEEN)
    seen = (prior.grid >= low) & (prior.grid <= high)
    root = prior.roots(found[:size])[seen]
    light = root**2
    change = 2.0 * root[:, None] * prior.basis.T[seen]
    change -= np.outer(light, light @ change) / (light @ light)
    spread = np.einsum("km,mn,kn->k", change, covariance[size:, size:], change)
    drift = change @ found[size:]
    return float(np.sqrt((drift**2).mean())), float(np.sqrt(spread.mean()))
