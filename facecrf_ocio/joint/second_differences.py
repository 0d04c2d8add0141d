"""Second differences of a window's three channels at once: by size, by sign, and beside each other.

As few calls as can be, of the smallest integers that hold the numbers: windows are so small that
most of the time went by the call and by the width of what was counted.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.joint.soft_edges import CHANNEL_PAIRS
from facecrf_ocio.values import Bool, Float

LEVELS = 24  # of 10.6 codes each; chosen by judgment, and trained with
SECOND_DIFFERENCE = np.array([1, -2, 1], np.float32)
"""Down and across, one after the other: of independent noise it has six times the deviation."""
RESIDUES = np.array(
    [
        *range(13),
        *(14, 16, 18, 20, 22, 25, 28, 31, 35, 39, 44, 49, 55, 62, 70, 79, 89, 100, 113, 127, 143),
        *(161, 182, 205, 231, 260, 293, 330, 372, 419, 472, 532, 599, 675, 760, 856, 1021),
    ]
)
"""Smallest second difference of each bin, in 8-bit codes; by an eighth apart from twelve on."""
LARGEST = 1023
"""Second differences of larger size count in the last bin."""
# [px] down and right, by distance: 1, its diagonal, 2; a mosaic has a period of two.
LAGS = ((0, 1), (1, 0)), ((1, 1),), ((0, 2), (2, 0))
NARROWEST = 3
"""[px] The side of a second difference."""

_WHITE = 255  # [code value] of 8 bits
_GREEN = 1  # index of the channel that a mosaic samples most densely
_NEIGHBORS = np.ones((3, 3), np.uint8)  # a pixel and those whose second difference it is
_DOWN = 1e-5 - 0.5  # makes rounding to the nearest level rounding down; sums lie 3e-5 apart
_SIGNS = 3  # opposite, none, and same

Codes = npt.NDArray[np.uint8]
Plane = npt.NDArray[np.uint8] | npt.NDArray[np.int16]
Signs = npt.NDArray[np.int8]


@dataclass(frozen=True, slots=True, eq=False)
class SecondDifferences:
    """Of each pixel of N windows (H, W), in three channels, those at a window's edges not counted.

    Attributes
    ----------
    residue
        (3, N, H, W) int16 second differences.
    level
        (3, N, H, W) which of the levels the mean of its nine pixels has.
    counted
        (3, N, H, W) 255, or 0 where black, white or the window's edge is near.
    """

    residue: npt.NDArray[np.int16]
    level: Codes
    counted: Codes

    @classmethod
    def of(cls, channels: Plane, white: int, mask: Bool | None) -> SecondDifferences:
        """Of channels (3, N, H, W) with codes up to `white`, 255 times a power of four."""
        # One below the other: what is inside of a window has no neighbor in the next.
        tall: Any = np.ascontiguousarray(channels).reshape(-1, channels.shape[-1])
        between = cv2.inRange(tall, np.array([1.0]), np.array([white - 1.0]))
        counted: Any = np.asarray(cv2.erode(between, _NEIGHBORS)).reshape(channels.shape)
        counted[..., [0, -1], :] = 0
        counted[..., [0, -1]] = 0
        if mask is not None:
            inside = mask[:, : channels.shape[2], : channels.shape[3]]
            counted &= inside.view(np.uint8) * np.uint8(_WHITE)
        residue = cv2.sepFilter2D(tall, cv2.CV_16S, SECOND_DIFFERENCE, SECOND_DIFFERENCE)
        sums = cv2.boxFilter(tall, cv2.CV_16U, (3, 3), normalize=False)
        # Rounded down: NumPy's way from floats to bytes takes ten times as long.
        level = cv2.convertScaleAbs(sums, alpha=LEVELS / (9 * white + 1), beta=_DOWN)
        of_channels: Any = np.asarray(residue).reshape(channels.shape)
        return cls(of_channels, np.asarray(level, np.uint8).reshape(channels.shape), counted)

    def histograms(self, size: int) -> Float:
        """(3, L, R) counted pixels by level and absolute second difference over 2**size."""
        residue = np.abs(self.residue) >> size if size else self.residue
        tall: Any = residue.reshape(-1, residue.shape[-1])
        sizes = cv2.convertScaleAbs(tall)
        table = _bin_of_residue()
        bins = np.asarray(cv2.LUT(sizes, table[: _WHITE + 1]), np.uint8)
        large = np.flatnonzero(np.asarray(sizes) == _WHITE)
        bins.ravel()[large] = table[np.minimum(np.abs(residue.ravel()[large]), LARGEST)]
        shape = LEVELS, RESIDUES.size
        level = self.level | ~self.counted  # beyond all levels where it does not count
        planes = zip(level, bins.reshape(level.shape), strict=True)
        return np.array([_counts_of_pairs(*pair, *shape) for pair in planes])

    def signs(self) -> Signs:
        """(3, N, H, W) sign of each residue, 0 where it is 0 or not counted."""
        above, below = (side.view(np.int8) for side in (self.residue > 0, self.residue < 0))
        return (above - below) & self.counted.view(np.int8)

    def pairs(self, signs: Signs) -> Float:
        """(3, 2, L) as one size of `NoiseCounts.pairs`."""
        red, green, blue = signs
        state = (red * np.int8(9) + green * np.int8(3) + (blue + np.int8(13))).view(np.uint8)
        return self._by_state(_pair_states(), state)

    def lags(self, signs: Signs) -> Float:
        """(3, 2, L) as `NoiseCounts.lags`."""
        # One row after the other: a lag is a shift of that line. Its neighbors beyond the last
        # column and row are those of the edge, whose sign is 0.
        line, width = signs[_GREEN].ravel(), signs.shape[-1]
        state = np.zeros(line.shape, np.uint8)
        for down, right in (lag for lags in LAGS for lag in lags):
            shift = down * width + right
            agree = np.ones(line.shape, np.int8)
            agree[:-shift] += line[:-shift] * line[shift:]
            state = state * np.uint8(_SIGNS) + agree.view(np.uint8)
        return self._by_state(_lag_states(), state.reshape(signs.shape[1:]))

    def _by_state(self, states: Float, state: Codes) -> Float:
        """(N, 2, L) pixels by green's level, of N pairs of signs those that are same, or opposite.

        All pairs are counted at once, by the state that they are in together; `states` (N, 2, S)
        tells what that means for each pair.
        """
        return states @ _counts_of_pairs(state, self.level[_GREEN], states.shape[2], LEVELS)


def sizes_of(codes: Codes, number: int) -> list[Plane]:
    """Channels (3, N, H, W) of windows (N, H, W, 3), then of their halves, halves of these, ..."""
    planes: Any = cv2.split(codes.reshape(-1, *codes.shape[2:]))
    sizes: list[Plane] = [np.array(planes).reshape(3, *codes.shape[:3])]
    while len(sizes) < number:
        sizes.append(_halved(sizes[-1]))
    return sizes


def _halved(channels: Plane) -> npt.NDArray[np.int16]:
    """Sums of two by two pixels of (3, N, H, W): the means of four times their values."""
    height, width = channels.shape[2] // 2, channels.shape[3] // 2
    shape = *channels.shape[:2], height, width
    if not height or not width:
        return np.zeros(shape, np.int16)
    whole = channels[..., : 2 * height, : 2 * width].astype(np.int16) * np.int16(4)
    tall = whole.reshape(-1, 2 * width)
    small = cv2.resize(tall, (width, len(tall) // 2), interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.int16).reshape(shape)


def counts_of(codes: Codes, number: int) -> Float:
    """(number,) how often each is there; OpenCV counts bytes some times as fast as NumPy."""
    found = cv2.calcHist([codes.reshape(-1, codes.shape[-1])], [0], None, [number], [0, number])
    return np.asarray(found.ravel(), np.float64)


def _counts_of_pairs(one: Codes, other: Codes, ones: int, others: int) -> Float:
    """(ones, others) how often each is where each of the others is; larger ones are left out."""
    pair = [codes.reshape(-1, codes.shape[-1]) for codes in (one, other)]
    found = cv2.calcHist(pair, [0, 1], None, [ones, others], [0, ones, 0, others])
    return np.asarray(found, np.float64)


@cache
def _bin_of_residue() -> Codes:
    """Bin of each second difference up to the largest."""
    return (np.searchsorted(RESIDUES, np.arange(LARGEST + 1), side="right") - 1).astype(np.uint8)


@cache
def _pair_states() -> Float:
    """(3, 2, 27) by the signs of red, green and blue: which pairs are same, and which opposite."""
    signs = np.indices((_SIGNS,) * 3).reshape(3, -1) - 1
    products = np.array([signs[one] * signs[other] for one, other in CHANNEL_PAIRS])
    return np.stack([products > 0, products < 0], axis=1).astype(np.float64)


@cache
def _lag_states() -> Float:
    """(3, 2, 243) by the agreement at each lag: how many of a distance are same, and opposite."""
    number = [len(lags) for lags in LAGS]
    agree = np.indices((_SIGNS,) * sum(number)).reshape(sum(number), -1)
    parts = np.split(agree, np.cumsum(number)[:-1])
    return np.array([[(part == 2).sum(axis=0), (part == 0).sum(axis=0)] for part in parts], float)
