"""Color differences as a JPEG stores them, from those that its decoder has smoothed."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.linalg import solve_banded

Int32 = npt.NDArray[np.int32]
_OFF = np.array([-1, 0, 1], np.int32)[:, None]  # [code] by which a rounded solution may be wrong
_BROKEN, _CERTAIN = 10, 1000  # cost of an equation, and of one that rounds nothing,
_AWAY = np.abs(_OFF)  # against one for each code away from the rounded solution
_FEWEST = 3  # stored columns; fewer are repeated by the decoder too


def as_stored(smoothed: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """(H, ceil(W / 2)) what was stored of (H, W) color differences halved in width (4:2:2).

    libjpeg makes (3 c[i] + c[i - 1] + 1) // 4 and (3 c[i] + c[i + 1] + 2) // 4 of each (jdsample.c,
    h2v1_fancy_upsample), and keeps both ends. Those are solved as if nothing had been rounded; one
    of the three codes about each solution is the stored one, and the row of codes that breaks
    fewest of the equations is found by dynamic programming.
    """
    count = (smoothed.shape[1] + 1) // 2
    if count < _FEWEST:
        return smoothed[:, ::2]
    columns = np.ascontiguousarray(smoothed.T, np.int32)  # each step goes over all rows
    left, right = columns[0::2], columns[1::2]
    about = np.rint(_solved(left, right)).astype(np.int32)
    cost = _AWAY + _CERTAIN * (about[0] + _OFF != left[0])
    came_from = np.zeros((count, 3, columns.shape[1]), np.int8)
    for i in range(1, count):
        before, here = (about[i - 1] + _OFF)[:, None], about[i] + _OFF
        broken = ((3 * before + here + 2) >> 2 != right[i - 1]).astype(np.int32)
        broken += (3 * here + before + 1) >> 2 != left[i]
        total = cost[:, None] + _BROKEN * broken
        came_from[i] = total.argmin(axis=0)
        cost = total.min(axis=0) + _AWAY
    if len(right) == count:
        cost = cost + _CERTAIN * (about[-1] + _OFF != right[-1])
    return _followed_back(about, came_from, cost)


def _solved(left: Int32, right: Int32) -> npt.NDArray[np.float64]:
    """(N, H) stored codes of least squares, the middle of what is rounded alike for its value."""
    count = len(left)
    before = 4 * left + 0.5  # 3 c[i] + c[i - 1]
    behind = 4 * right - 0.5  # 3 c[i] + c[i + 1]
    before[0] = 3 * left[0]
    if len(right) == count:
        behind[-1] = 3 * right[-1]
    sums = 3 * before
    sums[:-1] += before[1:]
    sums[: len(right)] += 3 * behind
    sums[1:] += behind[: count - 1]
    bands = np.full((3, count), 6.0)
    bands[1] = 20.0
    bands[1, (0, -1)] -= 1.0
    bands[1, len(right) :] -= 9.0
    return np.asarray(solve_banded((1, 1), bands, sums))


def _followed_back(
    about: Int32, came_from: npt.NDArray[np.int8], cost: Int32
) -> npt.NDArray[np.uint8]:
    best = cost.argmin(axis=0)
    stored = about.copy()
    for i in range(len(about) - 1, -1, -1):
        stored[i] += _OFF[best, 0]
        best = np.take_along_axis(came_from[i], best[None], axis=0)[0]
    return np.ascontiguousarray(np.clip(stored, 0, 255).T, np.uint8)
