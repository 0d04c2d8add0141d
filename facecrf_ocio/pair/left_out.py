"""Fits of a bracket without some of its photos: what each does to the curve, and whose time is off.

What is wrong with a photo is in all of its points, so halves of the points tell nothing of it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from facecrf_ocio.pair.exposure_fit import (
    CODES,
    FEWEST_POINTS,
    FEWEST_SHARED,
    ExposureFit,
    fit_exposures,
)
from facecrf_ocio.values import CHANNELS, Bool, Float, Index, InverseCRF

_MOST = 8  # fits of one bracket; of more photos, neighbors in exposure are left out together
# Of three, a false one leaves two that agree with any curve, but not with one that is known.
_FEWEST_PHOTOS, _FEWEST_BY_CURVE = 4, 3
_FALSE = 0.45  # [stop] departure that is called false (docs/evidence)
_CLEARLY = 3.0  # times what the others depart by once it is gone
_LEAST = 0.03  # [stop] departure that shutters and fits have anyway
# Beside a false photo others depart too: so many are tried, one is so many times clearer.
_SUSPECTS, _ALONE = 3, 1.5
_SCATTER = 0.2  # [stop] median distance of points from it: glare and what moved agree on nothing


LeftOut = tuple[Index, ExposureFit]  # indices of some photos, and the fit without them
# From code values, which are clear, and told exposures to the fit of all, and those without some.
_Fits = Callable[[Float, Bool, Float], tuple[ExposureFit, tuple[LeftOut, ...]]]
_DARKEST = 2.0**-20  # of light by a curve; 0 has no logarithm


def fits_without(
    codes: Float, clear: Bool, given: Float, whole: ExposureFit
) -> tuple[LeftOut, ...]:
    """Fit without each photo, or group of neighbors in exposure; `whole` is the fit of all.

    `codes` (J, P, 3) of J photos count where they are `clear` (J, P); `given` (J,) [stop].
    """
    groups = np.array_split(np.argsort(given, kind="stable"), min(_MOST, len(given)))
    found = []
    for group in groups:
        rest = clear.copy()
        rest[group] = False
        rest &= rest.sum(axis=0) >= 2
        told = rest.any(axis=0)
        if told.sum() >= FEWEST_POINTS:
            fit = fit_exposures(codes[:, told], rest[:, told], given, 1.0, whole)
            found.append((group, fit))
    return tuple(found)


def false_by_curve(
    codes: Float, clear: Bool, given: Float, curve: InverseCRF
) -> tuple[int, float] | None:
    """What `false_exposure` says of three photos, by a curve that is known.

    Of more, a curve of their own tells it better than one that may err (docs/evidence).
    """
    if (clear.sum(axis=1) >= FEWEST_SHARED).sum() >= _FEWEST_PHOTOS:
        return None
    at = np.arange(CODES) / (CODES - 1.0)
    rows = np.array([np.interp(at, curve.encoded, row) for row in curve.linear])
    known = ExposureFit(np.log2(np.maximum(rows, _DARKEST)), given, 0.0, 1.0, 0.0, np.empty(0))
    without = tuple((np.array([photo]), known) for photo in range(len(given)))
    return false_exposure(
        codes, clear, given, without, lambda *_: (known, without), _FEWEST_BY_CURVE
    )


def _fits(codes: Float, clear: Bool, given: Float) -> tuple[ExposureFit, tuple[LeftOut, ...]]:
    whole = fit_exposures(codes, clear, given)
    return whole, fits_without(codes, clear, given, whole)


def false_exposure(
    codes: Float,
    clear: Bool,
    given: Float,
    without: tuple[LeftOut, ...],
    fits: _Fits = _fits,
    fewest: int = _FEWEST_PHOTOS,
) -> tuple[int, float] | None:
    """Index of the photo whose exposure is another than told, and [stop] by how much, if one is.

    Parameters
    ----------
    codes, clear
        (J, N, 3) code values, and (J, N) which of them are to be used.
    given
        (J,) [stop] exposures.
    without
        Fits without each of the photos, or some.
    fits
        Of fewer points and photos.
    fewest
        Photos of which one can be told from the others.
    """
    told = np.flatnonzero(clear.sum(axis=1) >= FEWEST_SHARED)
    if len(told) < fewest:
        return None
    apart = np.abs(_departures(codes, clear, given, without))
    suspects = [int(s) for s in np.argsort(-apart)[:_SUSPECTS] if apart[s] >= _FALSE]
    tried = sorted((_tried(codes, clear, given, s, fits) for s in suspects), reverse=True)
    clearness = [*(one[0] for one in tried), 0.0, 0.0]
    if clearness[0] < max(_CLEARLY, _ALONE * clearness[1]):
        return None
    return tried[0][1:]


def _tried(
    codes: Float, clear: Bool, given: Float, photo: int, fits: _Fits
) -> tuple[float, int, float]:
    """Departure of a photo over that of the others without it, its index, its departure [stop]."""
    others = clear.copy()
    others[photo] = False
    others &= others.sum(axis=0) >= 2
    points = others.any(axis=0)
    if points.sum() < FEWEST_POINTS:
        return 0.0, photo, 0.0
    left, kept = codes[:, points], others[:, points]
    whole, without = fits(left, kept, given)
    rest = np.abs(_departures(left, kept, given, without)).max()
    stops = float(_departures(codes, clear, given, ((np.array([photo]), whole),))[photo])
    return abs(stops) / max(rest, _LEAST) * (abs(stops) >= _FALSE), photo, stops


def _departures(codes: Float, clear: Bool, given: Float, without: tuple[LeftOut, ...]) -> Float:
    """[stop] (J,) real less told exposure of each photo by the fit that did not see it, or 0."""
    departures = np.zeros(len(given))
    places = np.clip(np.rint(codes), 0, CODES - 1).astype(np.intp)
    for group, fit in without:
        light = np.stack([fit.light[c][places[..., c]] for c in range(len(CHANNELS))], axis=-1)
        seen = clear.copy()
        seen[group] = False
        count = seen.sum(axis=0)
        real = np.where(seen[..., None], light - fit.stops[:, None, None], 0.0).sum(axis=0)
        real /= np.maximum(count, 1)[:, None]
        for photo in group:
            shared = clear[photo] & (count > 0)
            if shared.sum() < FEWEST_SHARED:
                continue
            apart = (light[photo] - real)[shared] - given[photo]
            if np.median(np.abs(apart - np.median(apart))) <= _SCATTER:
                departures[photo] = np.median(apart)
    return departures
