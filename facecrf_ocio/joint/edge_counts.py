"""Edges of one channel, counted: where their middles lie between their sides."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float

EDGE_LEVELS = 8  # of 32 codes each, not much more than the faintest edge has

_WHITE = 255  # [code value] of 8 bits
_FAINTEST = 24  # codes between the two sides of an edge
_FLAT = 3, 20  # such a part of that, which the sides themselves may rise by
_RUN = 7  # samples across an edge: both sides, three between them, and one beyond each side


def count_edges(planes: npt.NDArray[np.uint8] | npt.NDArray[np.int16], white: int) -> Float:
    """(8, 8, 3) as one size of `NoiseCounts.edges`: steps within four pixels, flat on both sides.

    In linear light a blur is as far from one side as from the other, so the mean of an edge's
    middle pixels lies halfway on the average (after Lin and Zhang, CVPR 2005). Planes are (N, H, W)
    of as many windows, white is 255 or a multiple of it.
    """
    parts = white // _WHITE  # of a code, which the planes' integers count
    # Side by side, as runs go down, so that none leads from one window to the next.
    _, height, width = planes.shape
    down = np.ascontiguousarray(planes.transpose(1, 0, 2)).reshape(height, -1)
    wide: tuple[Any, ...] = (down, cv2.transpose(planes.reshape(-1, width)))
    runs = [_runs(plane, parts) for plane in wide if len(plane) >= _RUN]
    if not runs:
        return np.zeros((EDGE_LEVELS, EDGE_LEVELS, 3))
    run = np.concatenate(runs, axis=1) / np.float32(parts)
    low, high = np.minimum(run[1], run[5]), np.maximum(run[1], run[5])
    middle = ((run[2] + run[3] + run[4]) / 3.0 - low) / (high - low)
    unit = np.float32((_WHITE + 1) / EDGE_LEVELS)
    cells = (low / unit).astype(np.intp) * EDGE_LEVELS + (high / unit).astype(np.intp)
    powers = [
        np.bincount(cells, middle**power if power else None, EDGE_LEVELS * EDGE_LEVELS)
        for power in range(3)
    ]
    return np.stack(powers, axis=-1).reshape(EDGE_LEVELS, EDGE_LEVELS, 3).astype(np.float64)


def _runs(
    plane: npt.NDArray[np.uint8] | npt.NDArray[np.int16], parts: int
) -> npt.NDArray[np.float32]:
    """(7, N) samples down a plane that are an edge."""
    rise = np.asarray(cv2.absdiff(plane[5:-1], plane[1:-5]))
    place = np.flatnonzero(rise >= _FAINTEST * parts)
    below = np.arange(_RUN)[:, None] * plane.shape[1]
    run = plane.ravel().take(place + below).astype(np.int16)
    step = np.diff(run, axis=0)
    inner = step[1:5]
    steady = (inner.min(axis=0) >= 0) | (inner.max(axis=0) <= 0)
    most = rise.ravel()[place].astype(np.int16) * _FLAT[0]
    for beyond in (step[0], step[5]):
        steady &= np.abs(beyond) * _FLAT[1] <= most
    return np.asarray(run.compress(steady, axis=1), np.float32)
