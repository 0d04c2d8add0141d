"""Exposures of one scene and their curve in, one linear image of all its light out.

Each photo's light counts by the inverse of its variance: noise of a code through the curve's slope,
and photon noise (Mann and Picard, 1995; Granados et al., CVPR 2010). What moved is taken from the
reference, photo by photo outward in exposure: where bounds on the light, which noise, texture and
the curve's own deviation set, do not meet. Clipped codes bound it from below alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.pair.bracket_pixels import SmallBracket, warped
from facecrf_ocio.values import Bool, Float, InverseCRF, Photo

Image = npt.NDArray[np.float32]

_CODE = 1.0 / 255.0  # [1] one code value of 8 bits
_PIXEL_NOISE = 1.0 * _CODE  # of a pixel of an 8-bit JPEG
_PHOTON = 2e-4  # variance of light 1 at white: a signal-to-noise ratio of 70, a small sensor's
_READ = 4e-6  # variance of light 0: a deviation of 1/500 of white, as small sensors have
# A pixel counts fully between these codes, and not at all below and above the outer ones.
_DARK, _BRIGHT = (2.0 * _CODE, 8.0 * _CODE), (244.0 * _CODE, 252.0 * _CODE)
_LAST = 1e-6  # weight of what no photo shows well, in the one that shows it best
_LOOSE, _TEXTURED = 3.0 * _CODE, 0.2  # codes, and of the local range, that bounds lie apart
_SURE = 2.0  # standard deviations of the curve within the bounds
_BOX, _GROWN = 5, 9  # [px]
_TABLE = 4096  # of encoded values: 16 for each code of 8 bits
_FARTHEST = 0.35  # [stop] of an exposure from what EXIF says
_FEWEST = 30  # patches: a median of so many is off by a quarter of their spread


@dataclass(frozen=True, slots=True, eq=False)
class Merged:
    """One image of a bracket.

    Attributes
    ----------
    linear
        (H, W, 3) light in units of the reference's white; above 1 where it was clipped.
    reference
        The photo whose frame and moving things it shows.
    moved
        For each photo, the share of its pixels that was set aside as moved.
    """

    linear: Image
    reference: Photo
    moved: tuple[float, ...]


def merge_bracket(
    read: Callable[[int], Photo],
    bracket: SmallBracket,
    curve: InverseCRF,
    *,
    sigma: Float | None = None,
    still: bool = False,
) -> Merged:
    """Merge photos one after another, so that two of them are in memory and no more.

    Parameters
    ----------
    read
        Gives a photo by its index in the bracket.
    bracket
        Movements and exposures of the photos.
    curve
        The camera's inverse response.
    sigma
        (3, K) its standard deviation: as far as that, photos disagree though nothing moved.
    still
        Trust that nothing moved.
    """
    stops = bracket.stops - bracket.stops[bracket.reference]
    order = np.argsort(np.abs(stops), kind="stable")
    reference = read(bracket.reference)
    total = np.zeros(reference.encoded.shape, np.float32)
    weight, moved = np.zeros_like(total), np.zeros(len(stops))
    known: _Bounds | None = None
    for index in order:
        photo = reference if index == bracket.reference else read(int(index))
        codes = warped(photo.encoded, bracket.warps[index])
        share = _weights(codes, curve, stops, int(index))
        if not still:
            shown = _bounds(codes, curve, sigma, float(stops[index]))
            gone = _moved(shown, known)
            moved[index] = gone.mean()
            share[gone] = 0.0
            known = _narrowed(known, shown, gone)
        total += share * curve.linearize(codes) * np.float32(2.0 ** -stops[index])
        weight += share
    unseen = weight <= 0.0
    linear = np.where(unseen, curve.linearize(reference.encoded), total / np.maximum(weight, 1e-30))
    return Merged(linear.astype(np.float32), reference, tuple(map(float, moved)))


def refined_stops(stops: Float, codes: Float, usable: Bool, curve: InverseCRF) -> Float:
    """(J,) exposures as the pixels have them, by a curve that is known.

    Each is judged against its neighbor by patches that both show; an exposure of which they say
    nothing, or nothing likely, stays what it was.

    Parameters
    ----------
    stops
        (J,) exposures as told.
    codes, usable
        Of patches, as `flat_patches` gives them.
    curve
        The camera's inverse response.
    """
    light = np.log2(np.maximum(curve.linearize(codes / 255.0), 1e-6)).mean(axis=2)
    order = np.argsort(stops, kind="stable")
    refined = stops.astype(np.float64).copy()
    for low, high in pairwise(order):
        both = usable[low] & usable[high]
        told = float(stops[high] - stops[low])
        found = float(np.median(light[high, both] - light[low, both])) if both.any() else told
        if both.sum() < _FEWEST or abs(found - told) > _FARTHEST:
            found = told
        refined[high] = refined[low] + found
    return refined


def _weights(codes: Image, curve: InverseCRF, stops: Float, index: int) -> Image:
    """(H, W, 3) inverse variance of each pixel's light; outside of a moved photo nothing."""
    slope = np.gradient(curve.linear, curve.encoded, axis=1)
    variance = (slope * _PIXEL_NOISE) ** 2 + _PHOTON * curve.linear + _READ
    weight = _by_code(codes, curve, 4.0 ** stops[index] / variance)
    dark, bright = codes.min(axis=2), codes.max(axis=2)
    low = np.clip((dark - _DARK[0]) / (_DARK[1] - _DARK[0]), 0.0, 1.0)
    high = np.clip((_BRIGHT[1] - bright) / (_BRIGHT[1] - _BRIGHT[0]), 0.0, 1.0)
    if index == int(np.argmax(stops)):
        low = np.maximum(low, _LAST)
    if index == int(np.argmin(stops)):
        high = np.maximum(high, _LAST)
    inside = dark >= 0.0
    weight *= (low * high * inside)[..., None]
    return weight


def _by_code(codes: Image, curve: InverseCRF, values: Float) -> Image:
    """(3, K) values at the curve's codes, looked up at the codes of each channel."""
    grid = np.linspace(0.0, 1.0, _TABLE)
    place = np.rint(np.clip(codes, 0.0, 1.0) * (_TABLE - 1)).astype(np.intp)
    found = np.empty_like(codes)
    for channel, row in enumerate(values):
        table = np.interp(grid, curve.encoded, row).astype(np.float32)
        found[..., channel] = table[place[..., channel]]
    return found


class _Bounds(NamedTuple):
    """(H, W, 3) between which the light of each pixel lies, as photos show it."""

    least: Image
    most: Image


def _bounds(codes: Image, curve: InverseCRF, sigma: Float | None, stops: float) -> _Bounds:
    """What a photo, `stops` above the reference, says of the light of that.

    A code that is clipped, or next to one, says how much there is at least; one that is drowned
    how much at most; and what lies outside of a moved photo says nothing.
    """
    kernel, factor = np.ones((_BOX, _BOX), np.uint8), np.float32(2.0**-stops)
    highest, lowest = cv2.dilate(codes, kernel), cv2.erode(codes, kernel)
    loose = _LOOSE + np.float32(_TEXTURED) * (highest - lowest).max(axis=2, keepdims=True)
    flat = np.asarray(cv2.blur(codes, (_BOX, _BOX)), np.float32)
    apart = 1.0 + _SURE * _by_code(flat, curve, _doubt(curve, sigma))
    least = curve.linearize(np.clip(flat - loose, 0.0, 1.0)) / apart * factor
    most = curve.linearize(np.clip(flat + loose, 0.0, 1.0)) * apart * factor
    # A color that is clipped draws the others after it: hue is kept, and chroma is subsampled.
    most[highest.max(axis=2) >= _BRIGHT[0]] = np.inf
    least[lowest.min(axis=2) <= _DARK[0]] = 0.0
    most[lowest.min(axis=2) < 0.0] = np.inf
    return _Bounds(least.astype(np.float32), most.astype(np.float32))


def _doubt(curve: InverseCRF, sigma: Float | None) -> Float:
    """(3, K) standard deviation of the curve relative to its light, up to clipping."""
    if sigma is None:
        return np.zeros_like(curve.linear)
    relative = sigma / np.maximum(curve.linear, _READ**0.5)
    return np.where(curve.encoded <= _BRIGHT[0], relative, 0.0)


def _moved(shown: _Bounds, known: _Bounds | None) -> Bool:
    """(H, W) where a photo shows something else than those before it, grown by a few pixels."""
    if known is None:
        return np.zeros(shown.least.shape[:2], np.bool_)
    apart = (shown.least > known.most) | (shown.most < known.least)
    found = np.asarray(apart.any(axis=2), np.uint8)
    found = np.asarray(cv2.morphologyEx(found, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)))
    return np.asarray(cv2.dilate(found, np.ones((_GROWN, _GROWN), np.uint8)) > 0, np.bool_)


def _narrowed(known: _Bounds | None, shown: _Bounds, gone: Bool) -> _Bounds:
    """The bounds that all photos so far leave; where one is `gone` (H, W), those of the others."""
    if known is None:
        return shown
    least, most = np.maximum(known.least, shown.least), np.minimum(known.most, shown.most)
    kept = gone[..., None] | (least > most)
    return _Bounds(np.where(kept, known.least, least), np.where(kept, known.most, most))
