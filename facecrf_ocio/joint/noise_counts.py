"""One look at how neighbors differ in the windows of a photo.

Whatever is asked of noise (`grain.py`, `texture.py`), of edges (`edges.py`) and of exposure follows
from what is counted here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from functools import cache

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.joint.edge_counts import EDGE_LEVELS, count_edges
from facecrf_ocio.joint.second_differences import (
    LAGS,
    LARGEST,
    LEVELS,
    NARROWEST,
    RESIDUES,
    SecondDifferences,
    counts_of,
    sizes_of,
)
from facecrf_ocio.joint.soft_edges import (
    CHANNEL_PAIRS,
    SOFT_LEVELS,
    SOFT_SIZES,
    count_soft_edges,
)
from facecrf_ocio.photo.raster.pixels import Pixels, eight_bit
from facecrf_ocio.values import CHANNELS, Bool, Float, frozen

SIZES = 3
"""As stored, at half the size, and at a quarter of it."""
ROUNDING = 0.25
"""Added to a deviation before its logarithm: where 8 bits show none, there is still rounding."""
BLOCK = 8  # [px] side of a JPEG's blocks

_GREEN = 1  # index of the channel that a mosaic samples most densely
_WHITE = 255  # [code value] of 8 bits
_EDGE_SIZES = 2  # as stored and at half of it; chosen by judgment, and trained with
# Windows counted at once: by the call one takes two fifths more time and three a tenth; nine, all
# of a photo's, gain no more, and need a cache of twice the size.
_AT_ONCE = 5
_EDGES = np.append(np.maximum(RESIDUES - 0.5, 0.0), LARGEST + 0.5)  # of the bins of residues
_MOST_DIFFERENCE = 32  # codes: what counts of a difference for blocks, lest edges outweigh all

Codes = npt.NDArray[np.uint8]


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

    def plus(self, other: NoiseCounts) -> NoiseCounts:
        """Counts of both."""
        names = [item.name for item in fields(self)]
        return NoiseCounts(*(getattr(self, name) + getattr(other, name) for name in names))

    def times(self, weight: float) -> NoiseCounts:
        """Counts of so many windows of the same kind."""
        return NoiseCounts(*(weight * getattr(self, item.name) for item in fields(self)))


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
        (H, W) pixels to count, by their middle; all if None. With masks soft edges are counted all
        the same; codes, blocks and edges, which are asked of whole photos, are not.
    weights
        How often each window counts; once if None.
    """
    total = _no_counts()
    for first, end in _alike(windows, weights):
        codes = np.array([eight_bit(window) for window in windows[first:end]])
        mask = None if masks is None else np.array(masks[first:end])
        found = _counts(codes, mask)
        total = total.plus(found if weights is None else found.times(weights[first]))
    return total


def _alike(windows: Sequence[Pixels], weights: Sequence[float] | None) -> Iterator[tuple[int, int]]:
    """First and one past the last of windows in a row that are of one size and count alike."""
    first = 0
    for number in range(1, len(windows) + 1):
        if (
            number == len(windows)
            or number - first == _AT_ONCE
            or windows[number].shape != windows[first].shape
            or (weights is not None and weights[number] != weights[first])
        ):
            yield first, number
            first = number


def quantile(counts: Float, share: float) -> Float:
    """Quantiles (...) of counts (..., R), each bin spread evenly up to the next one; 0 of none.

    Rounding to 8 bits leaves few distinct numbers, whose plain quantile would jump: a number counts
    for half a unit on either side.
    """
    below = np.cumsum(counts, axis=-1)
    total = below[..., -1]
    wanted = share * total
    bins = counts.shape[-1]
    place = np.minimum((below < wanted[..., None]).sum(axis=-1), bins - 1)
    there = bins * np.arange(place.size).reshape(place.shape) + place
    inside = counts.take(there)
    part = (wanted - (below.take(there) - inside)) / np.maximum(inside, 1e-12)
    found = _EDGES[place] + np.clip(part, 0.0, 1.0) * (_EDGES[place + 1] - _EDGES[place])
    return np.asarray(np.where(total > 0.0, found, 0.0))


def _counts(codes: Codes, mask: Bool | None) -> NoiseCounts:
    """Of windows (N, H, W, 3) of one size, with masks (N, H, W)."""
    none = _no_counts()
    histograms, pairs, lags, edges = (
        np.array(one) for one in (none.histograms, none.pairs, none.lags, none.edges)
    )
    sizes = sizes_of(codes, len(SOFT_SIZES))
    soft, below = count_soft_edges(sizes), mask
    for size, channels in enumerate(sizes[:SIZES]):
        if min(channels.shape[2:]) < NARROWEST:
            break
        white = _WHITE * 4**size
        found = SecondDifferences.of(channels, white, below)
        histograms[size] = found.histograms(size)
        signs = found.signs()
        pairs[size] = found.pairs(signs)
        if size < _EDGE_SIZES and mask is None:
            edges[size] = count_edges(channels[_GREEN], white)
        if size == 0:
            lags = found.lags(signs)
        below = None if below is None else below[:, 1::2, 1::2]
    stored, blocks = none.codes, none.blocks
    if mask is None:
        stored = np.stack([counts_of(plane, _WHITE + 1) for plane in sizes[0]])
        blocks = _block_sums(sizes[0][_GREEN])
    return NoiseCounts(histograms, pairs, lags, stored, blocks, edges, soft.middles, soft.lines)


@cache
def _no_counts() -> NoiseCounts:
    return NoiseCounts(
        np.zeros((SIZES, len(CHANNELS), LEVELS, RESIDUES.size)),
        np.zeros((SIZES, len(CHANNEL_PAIRS), 2, LEVELS)),
        np.zeros((len(LAGS), 2, LEVELS)),
        np.zeros((len(CHANNELS), _WHITE + 1)),
        np.zeros((2, BLOCK, 2)),
        np.zeros((_EDGE_SIZES, EDGE_LEVELS, EDGE_LEVELS, 3)),
        np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS, 3)),
        np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS + 3)),
    )


def _block_sums(green: Codes) -> Float:
    """(2, 8, 2) as `NoiseCounts.blocks`, of windows (N, H, W)."""
    found = np.zeros((2, BLOCK, 2))
    number, height, width = green.shape
    tall = green.reshape(-1, width)
    if height >= NARROWEST:
        # Where one window ends and the next begins, nothing is counted.
        sums = np.zeros(len(tall))
        sums[1:] = _steps(tall[1:], tall[:-1], 1)
        of_rows = sums.reshape(number, height)[:, 1:].sum(axis=0)
        found[0] = _by_place(of_rows, number * width)
    if width >= NARROWEST:
        found[1] = _by_place(_steps(tall[:, 1:], tall[:, :-1], 0), len(tall))
    return found


def _steps(one: Codes, other: Codes, axis: int) -> Float:
    """Sums of what pixels differ by, of each row (axis 1) or column (0)."""
    step = np.minimum(cv2.absdiff(one, other), np.uint8(_MOST_DIFFERENCE))
    sums = cv2.reduce(step, axis, cv2.REDUCE_SUM, dtype=cv2.CV_32S)
    return np.asarray(sums, np.float64).ravel()


def _by_place(sums: Float, pixels: int) -> Float:
    """(8, 2) sums by their place in a block, and of how many pixels they are."""
    place = np.arange(len(sums)) % BLOCK
    number = pixels * np.bincount(place, minlength=BLOCK)
    return np.stack([np.bincount(place, sums, BLOCK), number], axis=1)
