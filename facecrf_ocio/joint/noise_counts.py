"""One look at how neighbors differ all over a photo.

Whatever is asked of noise (`grain.py`, `texture.py`) follows from what is counted here.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import CHANNELS, Float, Index, frozen

LEVELS = 24
LARGEST = 1023
SECOND_DIFFERENCE = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32)
"""In both directions: of independent noise it has six times the deviation."""
ROUNDING = 0.25
"""Added to a deviation before its logarithm: where 8 bits show none, there is still rounding."""

_PAIRS = ((0, 1), (1, 2), (0, 2))
_GREEN = 1
_WHITE = 255
_NEIGHBORS = np.ones((3, 3), np.uint8)
_SIDE, _PARTS = 1024, 4
_NARROWEST = 3

Codes = npt.NDArray[np.uint8]
HalfSize = npt.NDArray[np.uint16]


@dataclass(frozen=True, slots=True, eq=False)
class NoiseCounts:
    """Second differences of a photo, as stored and at half its size, at L uniform levels.

    Attributes
    ----------
    histograms
        (2, 3, L, 1024) pixels of each channel by their absolute second difference, in 8-bit codes;
        larger ones count as the largest. Where one of the nine pixels is clipped, none is counted.
    same, opposite
        (2, 3, L) by the level of green, how often the second differences of red and green, green
        and blue, red and blue have the same sign, and how often the opposite one.
    """

    histograms: Float
    same: Float
    opposite: Float

    def __post_init__(self) -> None:
        for name in ("histograms", "same", "opposite"):
            object.__setattr__(self, name, frozen(getattr(self, name)))


def count_noise(encoded: npt.NDArray[np.float32]) -> NoiseCounts:
    """Count a photo (H, W, 3), taken in 8 bits.

    Sides beyond 1024 pixels are sampled in four strips each, so that bright and dark surroundings
    are seen and not the middle alone.
    """
    histograms = np.zeros((2, len(CHANNELS), LEVELS, LARGEST + 1))
    signs = np.zeros((2, len(_PAIRS), 2, LEVELS))
    for rows, columns in _windows(*encoded.shape[:2]):
        codes = np.asarray(cv2.convertScaleAbs(encoded[rows, columns], alpha=_WHITE), np.uint8)
        sizes: tuple[Codes | HalfSize, ...] = (codes, _halved(codes))
        for size, pixels in enumerate(sizes):
            if min(pixels.shape[:2]) < _NARROWEST:
                continue
            channels = np.ascontiguousarray(np.moveaxis(pixels, 2, 0))
            planes = [_differences(channel, _WHITE * 4**size) for channel in channels]
            for channel, plane in enumerate(planes):
                histograms[size, channel] += _histogram(plane, 1 + size)
            for number, (one, other) in enumerate(_PAIRS):
                signs[size, number] += _signs(planes[one], planes[other], planes[_GREEN].level)
    return NoiseCounts(histograms, signs[:, :, 0], signs[:, :, 1])


def quantile(counts: Float, share: float) -> float:
    """Quantile of whole numbers with these counts, each spread evenly over half a unit around it.

    Rounding to 8 bits leaves few distinct numbers, whose plain quantile would jump. 0 of none.
    """
    total = float(counts.sum())
    if total == 0.0:
        return 0.0
    shares = np.concatenate([[0.0], np.cumsum(counts) / total])
    edges = np.concatenate([[0.0], np.arange(counts.size) + 0.5])
    return float(np.interp(share, shares, edges))


@dataclass(frozen=True, slots=True, eq=False)
class _Differences:
    """Of each pixel inside a plane; `unclipped` is False where black or white is near."""

    residue: npt.NDArray[np.int16]
    level: npt.NDArray[np.uint8]
    unclipped: npt.NDArray[np.bool_]


def _windows(height: int, width: int) -> Iterator[tuple[slice, slice]]:
    """The whole photo, or parts of it spread over sides that are longer than `_SIDE`."""

    def cuts(size: int) -> list[slice]:
        if size <= _SIDE:
            return [slice(0, size)]
        part = _SIDE // _PARTS
        return [slice(s, s + part) for s in np.linspace(0, size - part, _PARTS).astype(int)]

    return ((rows, columns) for rows in cuts(height) for columns in cuts(width))


def _halved(codes: Codes) -> HalfSize:
    """Sums of two by two pixels: the means of four times their values."""
    height, width = codes.shape[0] // 2, codes.shape[1] // 2
    if not height or not width:
        return np.zeros((0, 0, len(CHANNELS)), np.uint16)
    whole = codes[: 2 * height, : 2 * width].astype(np.uint16) * np.uint16(4)
    return np.asarray(cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA), np.uint16)


def _differences(plane: Codes | HalfSize, white: int) -> _Differences:
    inside = slice(1, -1), slice(1, -1)
    sums = cv2.boxFilter(plane, cv2.CV_16U, (3, 3), normalize=False)[inside]
    # OpenCV has no filter from 16 bits to signed 16 bits.
    depth = cv2.CV_16S if plane.dtype == np.uint8 else cv2.CV_32F
    residue = cv2.filter2D(plane, depth, SECOND_DIFFERENCE)[inside].astype(np.int16)
    brightest, darkest = (change(plane, _NEIGHBORS)[inside] for change in (cv2.dilate, cv2.erode))
    unclipped = (brightest < white) & (darkest > 0)
    return _Differences(residue, _level_of_sum(white)[sums], unclipped)


@cache
def _level_of_sum(white: int) -> npt.NDArray[np.uint8]:
    """Level of each possible sum of nine pixels."""
    level = np.arange(9 * white + 1) * LEVELS // (9 * white)
    return np.minimum(level, LEVELS - 1).astype(np.uint8)


def _histogram(differences: _Differences, unit: int) -> Index:
    """(L, 1024) unclipped pixels by level and absolute second difference over `unit`."""
    size = np.minimum(np.abs(differences.residue) // np.int16(unit), LARGEST).astype(np.uint16)
    cells = differences.level * np.uint16(LARGEST + 1) + size
    counts = np.bincount(cells[differences.unclipped], minlength=LEVELS * (LARGEST + 1))
    return counts.reshape(LEVELS, -1)


def _signs(one: _Differences, other: _Differences, level: npt.NDArray[np.uint8]) -> Index:
    """(2, L) pixels where both have the same sign, and where they have opposite ones."""
    chosen = one.unclipped & other.unclipped & (one.residue != 0) & (other.residue != 0)
    opposed = (one.residue < 0) ^ (other.residue < 0)
    cells = level + np.uint8(LEVELS) * opposed
    return np.bincount(cells[chosen], minlength=2 * LEVELS).reshape(2, LEVELS)
