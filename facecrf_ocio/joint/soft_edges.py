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

from facecrf_ocio.values import Float

SOFT_LEVELS = 8
"""Of 32 codes each."""
SOFT_SIZES = (1, 2, 4, 8)
"""Pixels of the photo per sample; each alone says something, all together most."""
CHANNEL_PAIRS = ((0, 1), (1, 2), (0, 2))
"""Each once."""
_FAINTEST = 14  # codes between both sides
_LEAST, _MOST = 0.04, 0.45  # of the rise, in each of its four steps: monotone, and not at once
_FLAT = 0.2  # of the rise, by which the sides themselves may rise
_BLACK, _WHITE = 0.5, 254.5  # [code value] below and from which a pixel is clipped
_LEVEL = 256 // SOFT_LEVELS  # codes
_APART = 2  # columns, of the finest size alone: neighbors see the same edge, and cost the most
_RUN = 7  # samples across an edge: both sides, three between them, and one beyond each side

Image = npt.NDArray[np.uint8] | npt.NDArray[np.float32]
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


def count_soft_edges(codes: npt.NDArray[np.uint8]) -> SoftEdges:
    """Soft edges down and across a window (H, W, 3) of 8-bit codes."""
    image: Image = codes
    found: list[tuple[int, _Edges]] = []
    for number, size in enumerate(SOFT_SIZES):
        if size > 1:
            image = _halved(image)
        if not image.size:
            break
        stacks = _stacks(image, _APART if size == 1 else 1)
        found += [(number, _Edges.along(stack)) for stack in stacks]
    middles = np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS, 3))
    lines = np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS + 3))
    if found:
        _count_middles(*_of_all([(number, edges.run) for number, edges in found]), middles)
        _count_lines(*_of_all([(number, edges.in_both()) for number, edges in found]), lines)
    return SoftEdges(middles, lines)


def _of_all(found: Sequence[tuple[int, Plane]]) -> tuple[Plane, Places]:
    """(7, N, ...) runs of several sizes, and (N,) the size that each is of."""
    numbers = [np.full(runs.shape[1], number) for number, runs in found]
    return np.concatenate([runs for _, runs in found], axis=1), np.concatenate(numbers)


def _halved(image: Image) -> Image:
    """Means of two by two pixels, exact: of 64 codes they have no more bits than a float."""
    height, width = image.shape[0] // 2, image.shape[1] // 2
    if not height or not width:
        return np.zeros((height, width, 3), np.float32)
    whole = image[: 2 * height, : 2 * width].astype(np.float32)
    return np.asarray(cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA), np.float32)


def _stacks(image: Image, step: int) -> Iterator[Image]:
    """(H, T, 3, W) planes to be searched from top to bottom, every `step`-th column of each.

    As few stacks as there are heights: planes of T turns and three channels are searched at once,
    since most of the time goes by the call.
    """
    split: Any = cv2.split(image)
    channels: list[Any] = list(split)
    turns = channels, [cv2.transpose(channel) for channel in channels]
    height, width = channels[0].shape
    for part in [turns] if height == width else [(turn,) for turn in turns]:
        if len(part[0][0]) >= _RUN:
            planes = [np.stack([plane[:, ::step] for plane in turn], axis=1) for turn in part]
            yield np.stack(planes, axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class _Edges:
    """Where seven samples down a stack of planes are a soft edge.

    Attributes
    ----------
    stack
        (H, T, 3, W) the planes.
    places
        (N,) index of the first sample of each into the stack's pixels; ascending.
    run
        (7, N) samples.
    """

    stack: Image
    places: Places
    run: Plane

    @classmethod
    def along(cls, stack: Image) -> _Edges:
        """All of a stack."""
        rises = cv2.absdiff(*(part.reshape(len(part), -1) for part in (stack[5:-1], stack[1:-5])))
        places = np.flatnonzero(np.asarray(rises) >= _FAINTEST)
        # Most fail here, before the samples beyond both sides are looked at.
        inner = _samples(stack, places, slice(1, 6))
        step = np.diff(inner, axis=0) / (inner[4] - inner[0])
        places = places[(step.min(axis=0) >= _LEAST) & (step.max(axis=0) <= _MOST)]
        run = _samples(stack, places, slice(0, _RUN))
        rise = np.abs(run[5] - run[1])
        soft = (np.abs(run[1] - run[0]) / rise <= _FLAT) & (np.abs(run[6] - run[5]) / rise <= _FLAT)
        soft &= run.max(axis=0) < _WHITE
        return cls(stack, places[soft], run[:, soft])

    def in_both(self) -> Plane:
        """(7, N, 2) samples of the edges that two channels show at the same place."""
        _, turns, _, width = self.stack.shape
        there = np.zeros((len(self.stack) * turns, 3, width), bool)
        there.ravel()[self.places] = True
        pairs = []
        for one, other in CHANNEL_PAIRS:
            places = np.flatnonzero(there[:, one] & there[:, other])
            row, column = np.divmod(places, width)
            first = row * (3 * width) + column
            pairs.append(np.stack([first + one * width, first + other * width], axis=-1))
        return _samples(self.stack, np.concatenate(pairs), slice(0, _RUN))


def _samples(stack: Image, places: Places, rows: slice) -> Plane:
    """(R, ...) the samples of some rows below each place, from its own on."""
    below = np.arange(rows.start, rows.stop) * stack[0].size
    found = stack.ravel().take(places + below.reshape(-1, *(1 for _ in places.shape)))
    return np.asarray(found, np.float32)


def _count_middles(run: Plane, size: Places, found: Float) -> None:
    """Add edges (7, N) to (4, 8, 8, 3)."""
    low, high = np.minimum(run[1], run[5]), np.maximum(run[1], run[5])
    middle = ((run[2] + run[3] + run[4]) / 3.0 - low) / (high - low)
    cells = (size * SOFT_LEVELS + _level(low)) * SOFT_LEVELS + _level(high)
    for power in range(3):
        _add(found[..., power], cells, middle**power if power else None)


def _count_lines(runs: Plane, size: Places, found: Float) -> None:
    """Add edges (7, N, 2) in two channels to the normal equations (4, 8, 11).

    Where light has the share b of the rise r from one side to the other, its code has
    b + b (1 - b) r k / 2 of it, to second order, for k = g'' / g' at the codes between. b is the
    same in all channels, and what the codes' shares differ by is linear in k.
    """
    unclipped = runs.min(axis=(0, 2)) > _BLACK
    runs, size = runs[:, unclipped], size[unclipped]
    rise = runs[5] - runs[1]
    shares = (runs[2:5] - runs[1]) / rise
    common = 0.5 * (shares[..., 0] + shares[..., 1])
    blend = (common * (1.0 - common)).sum(axis=0) / 6.0
    level = _level(0.5 * (runs[1] + runs[5]))
    apart = ((shares[..., 0] - shares[..., 1]).sum(axis=0) / 3.0)[:, None]
    x = np.stack([blend, -blend], axis=1) * rise / 255.0
    row = size[:, None] * SOFT_LEVELS + level
    cells = row[:, :, None] * SOFT_LEVELS + level[:, None, :]
    _add(found[..., :SOFT_LEVELS], cells, x[:, :, None] * x[:, None, :])
    for column, weights in enumerate((x * apart, None, np.broadcast_to(apart**2, x.shape))):
        _add(found[..., SOFT_LEVELS + column], row, weights)


def _level(codes: Plane) -> Places:
    return (codes / np.float32(_LEVEL)).astype(np.intp)


def _add(found: Float, cells: Places, weights: Plane | None) -> None:
    """Add weights, 1 each if None, to the cells of an array."""
    told = None if weights is None else weights.ravel()
    found += np.bincount(cells.ravel(), told, found.size).reshape(found.shape)
