"""Edges of one channel, counted: where their middles lie between their sides."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float

EDGE_LEVELS = 8  # of 32 codes each, not much more than the faintest edge has

_WHITE = 255  # [code value] of 8 bits
_FAINTEST = 24  # codes between the two sides of an edge
_FLAT = 0.15  # of that, which the sides themselves may rise by


def count_edges(plane: npt.NDArray[np.uint8] | npt.NDArray[np.uint16], white: int) -> Float:
    """(8, 8, 3) as one size of `NoiseCounts.edges`: steps within four pixels, flat on both sides.

    In linear light a blur is as far from one side as from the other, so the mean of an edge's
    middle pixels lies halfway on the average (after Lin and Zhang, CVPR 2005).
    """
    found = np.zeros((EDGE_LEVELS * EDGE_LEVELS, 3))
    values = plane.astype(np.float32) * np.float32(_WHITE / white)
    for p in (values, np.ascontiguousarray(values.T)):
        if len(p) < 7:
            continue
        rise = p[5:-1] - p[1:-5]
        place = np.flatnonzero(cv2.absdiff(p[5:-1], p[1:-5]) >= _FAINTEST)
        run = [p.ravel()[place + i * p.shape[1]] for i in range(7)]
        rise = rise.ravel()[place]
        step = [(run[i + 1] - run[i]) / rise for i in range(6)]
        steady = np.minimum.reduce(step[1:5]) >= 0.0
        steady &= (np.abs(step[0]) <= _FLAT) & (np.abs(step[5]) <= _FLAT)
        low, high = np.minimum(run[1], run[5])[steady], np.maximum(run[1], run[5])[steady]
        middle = ((run[2] + run[3] + run[4])[steady] / 3.0 - low) / np.maximum(high - low, 1.0)
        unit = (_WHITE + 1) / EDGE_LEVELS
        cells = (low // unit).astype(np.intp) * EDGE_LEVELS + (high // unit).astype(np.intp)
        for power in range(3):
            found[:, power] += np.bincount(cells, middle**power, minlength=len(found))
    return found.reshape(EDGE_LEVELS, EDGE_LEVELS, 3)
