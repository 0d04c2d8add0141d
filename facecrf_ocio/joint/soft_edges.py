"""Soft edges, counted: what blends of two colors tell, at several sizes.

Out of focus, in a penumbra or behind a lens's blur, light of two sides blends. In linear light the
middle of a rise lies halfway between its sides on the average (after Lin and Zhang, CVPR 2005),
and all channels blend by the same share (after Lin et al., CVPR 2004): colors across an edge lie on
a line. Sharpening, demosaicing and JPEG change rises of a pixel or two; wider ones they leave
alone, which is why they are sought at several sizes.
"""

from __future__ import annotations

from dataclasses import dataclass

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
_FAINTEST = 14.0  # codes between both sides
_LEAST, _MOST = 0.04, 0.45  # of the rise, in each of its four steps: monotone, and not at once
_FLAT = 0.2  # of the rise, by which the sides themselves may rise
_BLACK, _WHITE = 0.5, 254.5  # [code value] below and from which a pixel is clipped
_LEVEL = 256 // SOFT_LEVELS  # codes
_APART = 2  # columns, of the finest size alone: neighbors see the same edge, and cost the most
_RUN = 7  # samples across an edge: both sides, three between them, and one beyond each side

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
    middles = np.zeros((len(SOFT_SIZES), SOFT_LEVELS * SOFT_LEVELS, 3))
    lines = np.zeros((len(SOFT_SIZES), SOFT_LEVELS, SOFT_LEVELS + 3))
    channels = cv2.split(codes)
    for number, size in enumerate(SOFT_SIZES):
        planes = [_reduced(np.asarray(channel, np.float32), size) for channel in channels]
        step = _APART if size == 1 else 1
        seen, both = [], []
        for turned in (planes, [plane.T for plane in planes]):
            if len(turned[0]) < _RUN:
                continue
            edges = [_Edges.down(np.ascontiguousarray(plane[:, ::step])) for plane in turned]
            seen += [edge.run for edge in edges]
            both += [_seen_in_both(edges[one], edges[other]) for one, other in CHANNEL_PAIRS]
        if seen:
            _count_middles(np.concatenate(seen, axis=1), middles[number])
            _count_lines(np.concatenate(both, axis=1), lines[number])
    return SoftEdges(middles.reshape(*lines.shape[:2], SOFT_LEVELS, 3), lines)


def _reduced(plane: Plane, size: int) -> Plane:
    height, width = plane.shape[0] // size, plane.shape[1] // size
    whole = plane[: height * size, : width * size]
    if size == 1 or not whole.size:
        return whole[:height, :width]
    return np.asarray(cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA), np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class _Edges:
    """Where seven samples down a plane are a soft edge.

    Attributes
    ----------
    places
        (N,) index of the first sample of each into the plane's pixels; ascending.
    run
        (7, N) samples.
    """

    places: Places
    run: Plane

    @classmethod
    def down(cls, plane: Plane) -> _Edges:
        """All of a plane (H, W)."""
        values, apart = plane.ravel(), np.arange(_RUN)[:, None] * plane.shape[1]
        rises = (plane[5:-1] - plane[1:-5]).ravel()
        places = np.flatnonzero(np.abs(rises) >= _FAINTEST)
        # Most fail here, before the samples beyond both sides are looked at.
        step = np.diff(values.take(places + apart[1:6]), axis=0) / rises[places]
        places = places[(step.min(axis=0) >= _LEAST) & (step.max(axis=0) <= _MOST)]
        run, rise = values.take(places + apart), np.abs(rises[places])
        soft = (np.abs(run[1] - run[0]) / rise <= _FLAT) & (np.abs(run[6] - run[5]) / rise <= _FLAT)
        soft &= run.max(axis=0) < _WHITE
        return cls(places[soft], run[:, soft])


def _seen_in_both(one: _Edges, other: _Edges) -> Plane:
    """(7, N, 2) samples of the edges that two channels show at the same place."""
    _, first, second = np.intersect1d(
        one.places, other.places, assume_unique=True, return_indices=True
    )
    return np.stack([one.run[:, first], other.run[:, second]], axis=-1)


def _count_middles(run: Plane, found: Float) -> None:
    """Add edges (7, N) to (64, 3)."""
    low, high = np.minimum(run[1], run[5]), np.maximum(run[1], run[5])
    middle = ((run[2] + run[3] + run[4]) / 3.0 - low) / (high - low)
    cells = (low // _LEVEL).astype(np.intp) * SOFT_LEVELS + (high // _LEVEL).astype(np.intp)
    for power in range(3):
        found[:, power] += np.bincount(cells, middle**power, minlength=len(found))


def _count_lines(runs: Plane, found: Float) -> None:
    """Add edges (7, N, 2) in two channels to the normal equations (8, 11).

    Where light has the share b of the rise r from one side to the other, its code has
    b + b (1 - b) r k / 2 of it, to second order, for k = g'' / g' at the codes between. b is the
    same in all channels, and what the codes' shares differ by is linear in k.
    """
    runs = runs[:, runs.min(axis=(0, 2)) > _BLACK]
    rise = runs[5] - runs[1]
    shares = (runs[2:5] - runs[1]) / rise
    common = 0.5 * (shares[..., 0] + shares[..., 1])
    blend = (common * (1.0 - common)).sum(axis=0) / 6.0
    level = ((runs[1] + runs[5]) / (2 * _LEVEL)).astype(np.intp)
    apart = (shares[..., 0] - shares[..., 1]).sum(axis=0) / 3.0
    x = np.stack([blend, -blend], axis=1) * rise / 255.0
    for one in (0, 1):
        for other in (0, 1):
            cells = level[:, one] * SOFT_LEVELS + level[:, other]
            product = np.bincount(cells, x[:, one] * x[:, other], SOFT_LEVELS * SOFT_LEVELS)
            found[:, :SOFT_LEVELS] += product.reshape(SOFT_LEVELS, SOFT_LEVELS)
        for column, weights in enumerate((x[:, one] * apart, None, apart**2)):
            found[:, SOFT_LEVELS + column] += np.bincount(level[:, one], weights, SOFT_LEVELS)
