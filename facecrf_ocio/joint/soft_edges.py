"""Soft edges, counted: what blends of two colors tell, at several sizes.

Out of focus, in a penumbra or behind a lens's blur, light of two sides blends. In linear light the
middle of a rise lies halfway between its sides on the average (after Lin and Zhang, CVPR 2005),
and all channels blend by the same share (after Lin et al., CVPR 2004): colors across an edge lie on
a line. Sharpening, demosaicing and JPEG change rises of a pixel or two; wider ones they leave
alone, which is why they are sought at several sizes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Bool, Float

SOFT_LEVELS = 8
"""Of 32 codes each."""
SOFT_SIZES = (1, 2, 4, 8)
"""Pixels of the photo per sample; each alone says something, all together most."""
CHANNEL_PAIRS = ((0, 1), (1, 2), (0, 2))
"""Each once."""
_FAINTEST = 14  # codes between both sides
# Parts of the rise: in each of its four steps (monotone, and not at once).
_LEAST, _MOST = (1, 25), (9, 20)
_FLAT = 5  # such a part of the rise, the fifth, the sides themselves may rise by
_BLACK, _WHITE = 0.5, 254.5  # [code value] below and from which a pixel is clipped
_LEVEL = 256 // SOFT_LEVELS  # codes
_APART = 2  # columns, of the finest size alone: neighbors see the same edge, and cost the most
_SMALL = 4  # pixels of a sample, products of whose sums fit 16 bits
_RUN = 7  # samples across an edge: both sides, three between them, and one beyond each side

# Code values, times the pixels that a sample is the mean of: integers.
Image = npt.NDArray[Any]
Plane = npt.NDArray[np.float32]
Places = npt.NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class SoftEdges:
    """What the soft edges of a window hold, at four sizes and by eight levels.

    Attributes
    ----------
    middles
        (4, 8, 8, 3) by the levels of the dark and the bright side: edges in all channels, the sum
        of their middles' place between the two sides, and of its square.
    lines
        (4, 8, 11) least squares for the bend `g'' / g'` of an inverse response g at each level,
        from edges that two channels show: the normal equations' matrix (8, 8) and right side,
        how many edges have a channel at this level, and what the squares of the differences
        between both channels' places sum up to.
    """

    middles: Float
    lines: Float


def count_soft_edges(windows: Sequence[Image]) -> SoftEdges:
    """Soft edges down and across windows, given at all of `SOFT_SIZES`.

    Their channels (3, N, H, W) hold 8-bit codes, or sums of as many as a sample has pixels.
    """
    found: list[tuple[int, _Edges]] = []
    for number, (size, channels) in enumerate(zip(SOFT_SIZES, windows, strict=True)):
        if not channels.size:
            break
        stacks = _stacks(channels, _APART if size == 1 else 1)
        found += [(number, _Edges.along(stack, size**2)) for stack in stacks]
    middles = np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS, 3))
    lines = np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS + 3))
    if found:
        _count_middles(*_of_all([(number, edges.run) for number, edges in found]), middles)
        in_both = [(number, edges.in_both()) for number, edges in found]
        _count_lines(*_of_all(in_both), lines)
    return SoftEdges(middles, lines)


def _of_all(found: Sequence[tuple[int, Plane]]) -> tuple[Plane, Places]:
    """(7, ..., N) runs of several sizes, and (N,) the size that each is of."""
    numbers = [np.full(runs.shape[-1], number) for number, runs in found]
    return np.concatenate([runs for _, runs in found], axis=-1), np.concatenate(numbers)


def _stacks(channels: Image, step: int) -> Iterator[Image]:
    """(H, T, 3, W) planes to be searched from top to bottom, every `step`-th column of each.

    As few stacks as there are heights: planes of T turned windows and three channels are searched
    at once, since most of the time goes by the call.
    """
    turns = channels.transpose(2, 1, 0, 3), channels.transpose(3, 1, 0, 2)
    height, width = channels.shape[2:]
    for part in [turns] if height == width else [(turn,) for turn in turns]:
        if len(part[0]) >= _RUN:
            yield np.concatenate([turn[..., ::step] for turn in part], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class _Edges:
    """Where seven samples down a stack of planes are a soft edge.

    Attributes
    ----------
    size, width
        How many pixels the planes have, and how many in a row.
    places
        (N,) index of the first sample of each into the stack's pixels; ascending.
    run
        (7, N) samples, in code values.
    """

    size: int
    width: int
    places: Places
    run: Plane

    @classmethod
    def along(cls, stack: Image, unit: int) -> _Edges:
        """All of a stack."""
        places = np.flatnonzero(_may_be_soft(stack.reshape(len(stack), -1), unit))
        line = stack.ravel()
        # Row by row: all indices at once would be seven times as many, and take twice as long.
        run = np.array([line[row * stack[0].size :].take(places) for row in range(_RUN)])
        kept = np.flatnonzero(_is_soft(run.astype(np.int16 if unit <= _SMALL else np.int32), unit))
        in_codes = run.take(kept, axis=1).astype(np.float32) / np.float32(unit)
        return cls(stack.size, stack.shape[-1], places.take(kept), in_codes)

    def in_both(self) -> Plane:
        """(7, 2, N) samples of the edges that two channels show at the same place, not in black."""
        open_ = np.flatnonzero(self.run.min(axis=0) > _BLACK)
        places = self.places.take(open_)
        number = np.zeros(self.size, np.int32)  # of the edge at a place, from 1 on
        number[places] = open_ + 1
        channel = places // self.width % 3
        pairs = []
        for one, other in CHANNEL_PAIRS:
            there = channel == one
            second = number.take(places.compress(there) + (other - one) * self.width) - 1
            pairs.append(np.stack([open_.compress(there), second]).compress(second >= 0, axis=1))
        return self.run.take(np.concatenate(pairs, axis=1), axis=1)


def _may_be_soft(planes: Any, unit: int) -> Bool:
    """(H - 6, W) where samples down planes (H, W) rise or fall enough, all the way, and no farther.

    Few places are left of many that rise by noise, and those alone are looked at closer.
    """
    # Bytes that fall do not rise at all: OpenCV does not let them wrap.
    up, down = cv2.subtract(planes[1:], planes[:-1]), cv2.subtract(planes[:-1], planes[1:])
    rise = np.asarray(cv2.absdiff(planes[5:-1], planes[1:-5]))
    steady: Any = cv2.max(_least_of_four(up[1:-1]), _least_of_four(down[1:-1]))
    steps = cv2.max(up, down)
    beyond: Any = cv2.max(steps[:-5], steps[5:])
    found = rise >= _FAINTEST * unit
    found &= np.asarray(steady) > 0
    found &= np.asarray(beyond) <= rise // _FLAT
    return np.asarray(found)


def _least_of_four(steps: Any) -> Any:
    """(H - 3, W) least of each four below one another in (H, W)."""
    of_two: Any = cv2.min(steps[:-1], steps[1:])
    return cv2.min(of_two[:-2], of_two[2:])


def _is_soft(run: Image, unit: int) -> Bool:
    """(N,) where runs (7, N) rise or fall steadily between their sides, and are not clipped above.

    In integers, since the shares of a rise are ratios of small ones.
    """
    steps = np.abs(np.diff(run[1:6], axis=0))
    rise = np.abs(run[5] - run[1])
    found = steps.min(axis=0) * _LEAST[1] >= rise * _LEAST[0]
    found &= steps.max(axis=0) * _MOST[1] <= rise * _MOST[0]
    found &= run.max(axis=0) < _WHITE * unit
    return np.asarray(found)


def _count_middles(run: Plane, size: Places, found: Float) -> None:
    """Add edges (7, N) to (4, 8, 8, 3)."""
    low, high = np.minimum(run[1], run[5]), np.maximum(run[1], run[5])
    middle = ((run[2] + run[3] + run[4]) / 3.0 - low) / (high - low)
    cells = (size * SOFT_LEVELS + _level(low)) * SOFT_LEVELS + _level(high)
    for power in range(3):
        _add(found[..., power], cells, middle**power if power else None)


def _count_lines(runs: Plane, size: Places, found: Float) -> None:
    """Add edges (7, 2, N) in two channels to the normal equations (4, 8, 11).

    Where light has the share b of the rise r from one side to the other, its code has
    b + b (1 - b) r k / 2 of it, to second order, for k = g'' / g' at the codes between. b is the
    same in all channels, and what the codes' shares differ by is linear in k.
    """
    rise = runs[5] - runs[1]
    shares = (runs[2:5] - runs[1]) / rise
    common = 0.5 * (shares[:, 0] + shares[:, 1])
    blend = (common * (1.0 - common)).sum(axis=0) / 6.0
    level = _level(0.5 * (runs[1] + runs[5]))
    apart = (shares[:, 0] - shares[:, 1]).sum(axis=0) / 3.0
    x = np.stack([blend, -blend]) * rise / 255.0
    row = size * SOFT_LEVELS + level
    cells = row[:, None] * SOFT_LEVELS + level
    _add(found[..., :SOFT_LEVELS], cells, x[:, None] * x)
    for column, weights in enumerate((x * apart, None, np.broadcast_to(apart**2, x.shape))):
        _add(found[..., SOFT_LEVELS + column], row, weights)


def _level(codes: Plane) -> Places:
    return (codes / np.float32(_LEVEL)).astype(np.intp)


def _add(found: Float, cells: Places, weights: Plane | None) -> None:
    """Add weights, 1 each if None, to the cells of an array, which are flat indices of it."""
    told = None if weights is None else weights.ravel()
    found += np.bincount(cells.ravel(), told, found.size).reshape(found.shape)
