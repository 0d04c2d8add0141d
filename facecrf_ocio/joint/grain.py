"""Noise against level over a whole photo, which tells the slope of the curve.

The variance of photon noise grows with light, so its deviation in encoded values is the root of
light times the slope of the response. Summed from black, the inverse of that deviation is therefore
the root of linear light up to a factor, exponent and all: what no ratio of skin colors tells
(Takamatsu, Matsushita, Ikeuchi, CVPR 2008, use the same noise in another way).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float, frozen

LEVELS = 24
NARROWEST = 3
SECOND_DIFFERENCE = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32)
"""In both directions: of independent noise it has six times the deviation."""

_SIDE, _PARTS = 1024, 4
_LARGEST = 1023
# Texture reaches the upper quantiles of a second difference first.
_QUANTILE = 0.3
_ROUNDING = 0.25
_FEWEST, _FEW = 30, 150.0
_TRUST, _SMOOTH, _FLAT, _OFFSET = 8.0, 1.0, 0.02, 0.05


Codes = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class NoiseTable:
    """What was measured at each level.

    Attributes
    ----------
    deviation
        (3, L) quantile of the absolute second difference, in 8-bit codes times six; 0 where
        nothing was measured.
    count
        (3, L) pixels that it was taken from.
    """

    deviation: Float
    count: Float

    def __post_init__(self) -> None:
        for name in ("deviation", "count"):
            object.__setattr__(self, name, frozen(getattr(self, name)))


@dataclass(frozen=True, slots=True, eq=False)
class Differences:
    """Second differences inside a plane (H, W), each beside what surrounds it.

    Attributes
    ----------
    residue
        (H - 2, W - 2) second difference in both directions, in codes.
    level
        (H - 2, W - 2) index of the mean of its surroundings among uniform levels.
    unclipped
        (H - 2, W - 2) False where black or white is among the nine pixels.
    """

    residue: npt.NDArray[np.int16]
    level: npt.NDArray[np.uint8]
    unclipped: npt.NDArray[np.bool_]


def sample_codes(encoded: npt.NDArray[np.float32]) -> tuple[Codes, ...]:
    """Where noise is looked at: a photo (H, W, 3) in 8 bits, whole or in parts.

    Sides beyond 1024 pixels are sampled in four strips each, so that bright and dark surroundings
    are seen and not the middle alone. Parts too small for a second difference are left out.
    """
    return tuple(
        np.asarray(cv2.convertScaleAbs(encoded[rows, columns], alpha=255.0), np.uint8)
        for rows, columns in _windows(*encoded.shape[:2])
        if min(rows.stop - rows.start, columns.stop - columns.start) >= NARROWEST
    )


def measure_noise(samples: Sequence[Codes]) -> NoiseTable:
    """Noise of each channel at uniform levels of encoded values, clipped pixels left out."""
    histograms = np.zeros((3, LEVELS, _LARGEST + 1))
    for codes in samples:
        for channel, plane in enumerate(np.ascontiguousarray(np.moveaxis(codes, 2, 0))):
            histograms[channel] += histogram(second_differences(plane, 255, LEVELS), LEVELS)
    return NoiseTable(
        np.array([[quantile(row, _QUANTILE) for row in channel] for channel in histograms]),
        histograms.sum(axis=2),
    )


def noise_curve(table: NoiseTable) -> Float | None:
    """One curve of noise against level from all channels; None where nothing was measured.

    The channels differ by a factor, which is that of their white balance, and each shows other
    levels. Their log deviations are fitted by one smooth curve and two offsets, which also bridges
    levels that no channel shows: a linear least squares problem with 26 unknowns.

    Returns
    -------
    Float
        (3 L + 2,): the mean log deviation; the curve of log deviations less that mean (L); log
        trust in each level (L); offsets of red and blue (2); the sum from black of the inverse
        deviation, as a share of the whole (L - 1).
    """
    trust = np.where(table.count >= _FEWEST, table.count / (table.count + _FEW), 0.0) * _TRUST
    if trust.sum() <= 0.0:
        return None
    measured = np.log(table.deviation + _ROUNDING)
    bend, step = (np.diff(np.eye(LEVELS), order, axis=0) for order in (2, 1))
    A = np.zeros((LEVELS + 2, LEVELS + 2))
    A[:LEVELS, :LEVELS] = _SMOOTH * bend.T @ bend + _FLAT * step.T @ step + 1e-6 * np.eye(LEVELS)
    A[LEVELS:, LEVELS:] = _OFFSET * np.eye(2)
    b = np.zeros(LEVELS + 2)
    levels = np.arange(LEVELS)
    for channel, offset in ((0, LEVELS), (1, None), (2, LEVELS + 1)):
        A[levels, levels] += trust[channel]
        b[:LEVELS] += trust[channel] * measured[channel]
        if offset is not None:
            A[levels, offset] += trust[channel]
            A[offset, levels] += trust[channel]
            A[offset, offset] += trust[channel].sum()
            b[offset] += trust[channel] @ measured[channel]
    solution = np.linalg.solve(A, b)
    seen = trust.sum(axis=0)
    mean = float(seen @ solution[:LEVELS] / seen.sum())
    curve = solution[:LEVELS] - mean
    root_of_light = np.cumsum(np.exp(-curve))
    return np.concatenate(
        [
            [mean],
            curve,
            np.log(seen + 0.05),
            solution[LEVELS:],
            root_of_light[:-1] / root_of_light[-1],
        ]
    )


def _windows(height: int, width: int) -> Iterator[tuple[slice, slice]]:
    """The whole photo, or parts of it spread over sides that are longer than `_SIDE`."""

    def cuts(size: int) -> list[slice]:
        if size <= _SIDE:
            return [slice(0, size)]
        part = _SIDE // _PARTS
        return [slice(s, s + part) for s in np.linspace(0, size - part, _PARTS).astype(int)]

    return ((rows, columns) for rows in cuts(height) for columns in cuts(width))


def second_differences(
    plane: npt.NDArray[np.uint8] | npt.NDArray[np.uint16], white: int, levels: int
) -> Differences:
    """Second differences of a plane, at least 3 x 3, of whole numbers from 0 to `white`."""
    inside = slice(1, -1), slice(1, -1)
    sums = cv2.boxFilter(plane, cv2.CV_16U, (3, 3), normalize=False)[inside]
    # OpenCV has no filter from 16 bits to signed 16 bits.
    depth = cv2.CV_16S if plane.dtype == np.uint8 else cv2.CV_32F
    residue = cv2.filter2D(plane, depth, SECOND_DIFFERENCE)[inside].astype(np.int16)
    brightest = cv2.dilate(plane, np.ones((3, 3), np.uint8))[inside]
    darkest = cv2.erode(plane, np.ones((3, 3), np.uint8))[inside]
    level = np.minimum(np.arange(9 * white + 1) * levels // (9 * white), levels - 1)
    unclipped = (brightest < white) & (darkest > 0)
    return Differences(residue, level.astype(np.uint8)[sums], unclipped)


def counted(
    cells: npt.NDArray[np.uint8] | npt.NDArray[np.uint16],
    chosen: npt.NDArray[np.bool_],
    count: int,
) -> Float:
    """(count,) chosen pixels of each cell; OpenCV takes a tenth of the time of `np.bincount`."""
    mask = chosen.astype(np.uint8)
    found = cv2.calcHist([cells], [0], mask, [count], [0, count])
    return np.asarray(found, dtype=np.float64).ravel()


def histogram(differences: Differences, levels: int, unit: int = 1) -> Float:
    """(levels, 1024) unclipped pixels by level and absolute second difference over `unit`."""
    size = np.minimum(np.abs(differences.residue) // np.int16(unit), _LARGEST).astype(np.uint16)
    cells = differences.level * np.uint16(_LARGEST + 1) + size
    return counted(cells, differences.unclipped, levels * (_LARGEST + 1)).reshape(levels, -1)


def quantile(counts: Float, share: float) -> float:
    """Quantile of whole numbers with these counts, each spread evenly over half a unit around it.

    Rounding to 8 bits leaves few distinct numbers, whose plain quantile would jump.
    """
    total = float(counts.sum())
    if total == 0.0:
        return 0.0
    shares = np.concatenate([[0.0], np.cumsum(counts) / total])
    edges = np.concatenate([[0.0], np.arange(counts.size) + 0.5])
    return float(np.interp(share, shares, edges))
