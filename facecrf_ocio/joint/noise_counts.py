"""One look at how neighbors differ in the windows of a photo.

Whatever is asked of noise (`grain.py`, `texture.py`), of edges (`edges.py`) and of exposure follows
from what is counted here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cache, partial
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.joint.edge_counts import EDGE_LEVELS, count_edges
from facecrf_ocio.joint.soft_edges import (
    CHANNEL_PAIRS,
    SOFT_LEVELS,
    SOFT_SIZES,
    count_soft_edges,
)
from facecrf_ocio.photo.pixels import Pixels, eight_bit
from facecrf_ocio.values import CHANNELS, Float, frozen

LEVELS = 24  # of 10.6 codes each; chosen by judgment, and trained with
SIZES = 3
"""As stored, at half the size, and at a quarter of it."""
SECOND_DIFFERENCE = np.array([[1, -2, 1], [-2, 4, -2], [1, -2, 1]], np.float32)
"""In both directions: of independent noise it has six times the deviation."""
ROUNDING = 0.25
"""Added to a deviation before its logarithm: where 8 bits show none, there is still rounding."""
RESIDUES = np.array(
    [
        *range(13),
        *(14, 16, 18, 20, 22, 25, 28, 31, 35, 39, 44, 49, 55, 62, 70, 79, 89, 100, 113, 127, 143),
        *(161, 182, 205, 231, 260, 293, 330, 372, 419, 472, 532, 599, 675, 760, 856, 1021),
    ]
)
"""Smallest second difference of each bin, in 8-bit codes; by an eighth apart from twelve on."""
# [px] down and right, by distance: 1, its diagonal, 2; a mosaic has a period of two.
LAGS = ((0, 1), (1, 0)), ((1, 1),), ((0, 2), (2, 0))
BLOCK = 8  # [px] side of a JPEG's blocks

_GREEN = 1  # index of the channel that a mosaic samples most densely
_WHITE = 255  # [code value] of 8 bits
_NEIGHBORS = np.ones((3, 3), np.uint8)  # a pixel and those whose second difference it is
_NARROWEST = 3  # [px] the side of a second difference
_LARGEST = 1023  # second differences of larger size count in the last bin
_EDGE_SIZES = 2  # as stored and at half of it; chosen by judgment, and trained with
_MOST_DIFFERENCE = 32  # codes: what counts of a difference for blocks, lest edges outweigh all

Codes = npt.NDArray[np.uint8]
Bool = npt.NDArray[np.bool_]
Signs = npt.NDArray[np.int8]
Plane = npt.NDArray[np.uint8] | npt.NDArray[np.uint16]


@dataclass(frozen=True, slots=True, eq=False)
class NoiseCounts:
    """Second differences, edges and levels of a photo's windows, at L uniform levels.

    Attributes
    ----------
    histograms
        (3, 3, L, R) at each size (`SIZES`), pixels of each channel by their absolute second
        difference in 8-bit codes (`RESIDUES`). Where one of the nine pixels is clipped, none is
        counted.
    pairs
        (3, 3, 2, L) at each size, by the level of green, how often the second differences of red
        and green, green and blue, red and blue have the same sign, and how often the opposite one.
    lags
        (3, 2, L) how often neighbors in green (`LAGS`) have second differences of the same sign,
        and how often of opposite ones.
    codes
        (3, 256) pixels of each channel by their code.
    blocks
        (2, 8, 2) of differences down and across, by their place in a block: their sum, and number.
    edges
        (2, 8, 8, 3) at two sizes, by the levels of an edge's dark and bright side: edges in green,
        the sum of their middles' place between the two sides, and of its square.
    soft_edges, color_lines
        (4, 8, 8, 3) and (4, 8, 11) as `SoftEdges` has them: middles and lines.
    """

    histograms: Float
    pairs: Float
    lags: Float
    codes: Float
    blocks: Float
    edges: Float
    soft_edges: Float
    color_lines: Float

    def __post_init__(self) -> None:
        for item in fields(self):
            object.__setattr__(self, item.name, frozen(getattr(self, item.name)))


def count_noise(
    windows: Sequence[Pixels],
    masks: Sequence[Bool] | None = None,
    weights: Sequence[float] | None = None,
) -> NoiseCounts:
    """Count windows (H, W, 3), taken in 8 bits.

    Parameters
    ----------
    windows
        Encoded values, or codes of 8 bits; each begins where a JPEG's block does.
    masks
        (H, W) pixels to count, by their middle; all if None. Codes, blocks and edges are counted
        all the same.
    weights
        How often each window counts; once if None.
    """
    total = _Sums.zeros()
    for number, window in enumerate(windows):
        own = _Sums.zeros()
        own.count(eight_bit(window), None if masks is None else masks[number])
        total.add(own, 1.0 if weights is None else weights[number])
    return NoiseCounts(*(getattr(total, item.name) for item in fields(total)))


def quantile(counts: Float, share: float) -> Float:
    """Quantiles (...) of counts (..., R), each bin spread evenly up to the next one; 0 of none.

    Rounding to 8 bits leaves few distinct numbers, whose plain quantile would jump: a number counts
    for half a unit on either side.
    """
    edges = np.append(np.maximum(RESIDUES - 0.5, 0.0), _LARGEST + 0.5)
    below = np.cumsum(counts, axis=-1)
    total = below[..., -1:]
    wanted = share * total
    place = np.minimum((below < wanted).sum(axis=-1, keepdims=True), counts.shape[-1] - 1)
    inside = np.take_along_axis(counts, place, -1)
    before = np.take_along_axis(below, place, -1) - inside
    part = (wanted - before) / np.maximum(inside, 1e-12)
    found = edges[place] + np.clip(part, 0.0, 1.0) * (edges[place + 1] - edges[place])
    return np.where(total > 0.0, found, 0.0)[..., 0]


@dataclass(slots=True, eq=False)
class _Sums:
    histograms: Float
    pairs: Float
    lags: Float
    codes: Float
    blocks: Float
    edges: Float
    soft_edges: Float
    color_lines: Float

    @staticmethod
    def zeros() -> _Sums:
        return _Sums(
            np.zeros((SIZES, len(CHANNELS), LEVELS, RESIDUES.size)),
            np.zeros((SIZES, len(CHANNEL_PAIRS), 2, LEVELS)),
            np.zeros((len(LAGS), 2, LEVELS)),
            np.zeros((len(CHANNELS), _WHITE + 1)),
            np.zeros((2, BLOCK, 2)),
            np.zeros((_EDGE_SIZES, EDGE_LEVELS, EDGE_LEVELS, 3)),
            np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS, 3)),
            np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS + 3)),
        )

    def add(self, other: _Sums, weight: float) -> None:
        for item in fields(self):
            total = getattr(self, item.name)
            total += weight * getattr(other, item.name)

    def count(self, codes: Codes, mask: Bool | None) -> None:
        channels: Sequence[Plane] = [np.asarray(c, np.uint8) for c in cv2.split(codes)]
        for c, channel in enumerate(channels):
            self.codes[c] += _counts(channel, _WHITE + 1)
        self.blocks += _block_sums(np.asarray(channels[_GREEN], np.uint8))
        soft = count_soft_edges(codes)
        self.soft_edges += soft.middles
        self.color_lines += soft.lines
        for size in range(SIZES):
            if size:
                channels = [_halved(channel) for channel in channels]
                mask = None if mask is None else mask[1::2, 1::2]
            if min(channels[0].shape) < _NARROWEST:
                return
            self._count_size(channels, size, mask)

    def _count_size(self, channels: Sequence[Plane], size: int, mask: Bool | None) -> None:
        white = _WHITE * 4**size
        planes = [_differences(channel, white, mask) for channel in channels]
        for channel, plane in enumerate(planes):
            self.histograms[size, channel] += _histogram(plane, size)
        signs, level = [plane.signs() for plane in planes], planes[_GREEN].level
        for number, (one, other) in enumerate(CHANNEL_PAIRS):
            self.pairs[size, number] += _agreements(signs[one], signs[other], level)
        if size < _EDGE_SIZES:
            self.edges[size] += count_edges(channels[_GREEN], white)
        if size == 0:
            self.lags += _lag_agreements(signs[_GREEN], level)


@dataclass(frozen=True, slots=True, eq=False)
class _Differences:
    """Of each pixel inside a plane; `counted` is False where black or white is near."""

    residue: npt.NDArray[np.int32]
    level: Codes
    counted: Bool

    def signs(self) -> Signs:
        """Sign of each residue, 0 where it is 0 or not counted."""
        return np.sign(self.residue, dtype=np.int32).astype(np.int8) * self.counted


def _halved(plane: Plane) -> npt.NDArray[np.uint16]:
    """Sums of two by two pixels: the means of four times their values."""
    height, width = plane.shape[0] // 2, plane.shape[1] // 2
    if not height or not width:
        return np.zeros((0, 0), np.uint16)
    whole = plane[: 2 * height, : 2 * width].astype(np.uint16) * np.uint16(4)
    return np.asarray(cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA), np.uint16)


def _differences(plane: Plane, white: int, mask: Bool | None) -> _Differences:
    inside = slice(1, -1), slice(1, -1)
    sums = cv2.boxFilter(plane, cv2.CV_32F, (3, 3), normalize=False)[inside]
    # OpenCV has no filter from 16 bits to signed 16 bits.
    depth = cv2.CV_16S if plane.dtype == np.uint8 else cv2.CV_32F
    residue = cv2.filter2D(plane, depth, SECOND_DIFFERENCE)[inside].astype(np.int32)
    between = cv2.inRange(plane, np.array([1.0]), np.array([white - 1.0]))
    counted = cv2.erode(between, _NEIGHBORS)[inside] > 0
    if mask is not None:
        counted &= mask[: plane.shape[0], : plane.shape[1]][inside]
    level = (sums * np.float32(LEVELS / (9 * white + 1))).astype(np.uint8)
    return _Differences(residue, level, counted)


@cache
def _bin_of_residue() -> npt.NDArray[np.uint16]:
    """Bin of each second difference up to the largest."""
    return (np.searchsorted(RESIDUES, np.arange(_LARGEST + 1), side="right") - 1).astype(np.uint16)


def _histogram(differences: _Differences, size: int) -> Float:
    """(L, R) counted pixels by level and absolute second difference over 2**size."""
    sizes = np.minimum(np.abs(differences.residue) >> size, _LARGEST)
    cells = differences.level * np.uint16(RESIDUES.size) + _bin_of_residue()[sizes]
    cells[~differences.counted] = LEVELS * RESIDUES.size
    return _counts(cells, LEVELS * RESIDUES.size + 1)[:-1].reshape(LEVELS, -1)


def _counts(cells: Plane, number: int) -> Float:
    """(number,) how often each is there; OpenCV counts integers some times as fast as NumPy."""
    whole: Any = np.ascontiguousarray(cells)
    found = cv2.calcHist([whole], [0], None, [number], [0, number])
    return np.asarray(found.ravel(), np.float64)


def _agreements(one: Signs, other: Signs, level: Codes) -> Float:
    """(2, L) pixels where both have the same sign, and where they have opposite ones."""
    cells = (one * other + np.int8(1)).view(np.uint8) * np.uint8(LEVELS) + level
    opposite, _, same = _counts(cells, 3 * LEVELS).reshape(3, LEVELS)
    return np.stack([same, opposite])


def _lag_agreements(signs: Signs, level: Codes) -> Float:
    """(3, 2, L) as `NoiseCounts.lags`."""
    # One row after another, with neighbors of sign 0 beyond the last column and row: a lag is a
    # shift of one line of numbers then, and no neighbor lies in the next row.
    most = max(step for lags in LAGS for lag in lags for step in lag)
    height, width = signs.shape
    wide, pairs = width + most, (height + most) * (width + most) - most * (width + most + 1)
    around: Any = partial(cv2.copyMakeBorder, borderType=cv2.BORDER_CONSTANT)
    line, levels = (around(part, 0, most, 0, most).ravel() for part in (signs, level))
    found = np.zeros((len(LAGS), 2, LEVELS))
    for number, lags in enumerate(LAGS):
        for down, right in lags:
            shift = down * wide + right
            there = line[shift : shift + pairs]
            found[number] += _agreements(line[:pairs], there, levels[:pairs])
    return found


def _block_sums(green: Codes) -> Float:
    """(2, 8, 2) as `NoiseCounts.blocks`."""
    found = np.zeros((2, BLOCK, 2))
    for axis, (one, other) in enumerate(
        ((green[1:], green[:-1]), (green[:, 1:], green[:, :-1])),
    ):
        if green.shape[axis] < _NARROWEST:
            continue
        step = np.minimum(cv2.absdiff(one, other), np.uint8(_MOST_DIFFERENCE))
        sums = cv2.reduce(step, 1 - axis, cv2.REDUCE_SUM, dtype=cv2.CV_32S).ravel()
        place = np.arange(len(sums)) % BLOCK
        found[axis, :, 0] = np.bincount(place, sums, minlength=BLOCK)
        found[axis, :, 1] = np.bincount(place, minlength=BLOCK) * green.shape[1 - axis]
    return found
