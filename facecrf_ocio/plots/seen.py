"""Curves drawn whole, and dashed where nothing in the photo tells of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from scipy.ndimage import maximum_filter1d

from facecrf_ocio.values import Bool, Estimate, Float

_LEAST = 0.01  # of the evidence where it is densest: below, a code counts as not seen
_NEAR = 32  # part of all codes within which evidence counts, eight of 8 bits
DASHED = (0, (3.0, 1.6))  # line widths drawn and left out, told from dots at a glance
UNSEEN = "dashed: codes without evidence"


def seen_codes(estimate: Estimate, channel: int) -> Bool:
    """(K,) which codes of an estimate's curve the photo has evidence for; all of a fixed curve."""
    told, curve = estimate.confidence, estimate.curve
    if told is None or not told.coverage[channel].any():
        return np.ones(curve.encoded.size, bool)
    shared = bool((curve.linear == curve.linear[0]).all())
    near = told.coverage.max(axis=0) if shared else told.coverage[channel]
    return np.asarray(maximum_filter1d(near, curve.encoded.size // _NEAR) >= _LEAST)


def draw_seen(axes: Axes, x: Float, y: Float, seen: Bool, **line: Any) -> None:
    """Draw y over x, (N,), solid where seen and dashed elsewhere; `line` is as `plot` takes it."""
    axes.plot(x, np.where(seen, y, np.nan), **line)
    # The next point on either side belongs to both, so that they meet.
    ends = np.convolve(seen, [1, 1, 1], mode="same") < 3
    axes.plot(x, np.where(ends, y, np.nan), **{**line, "linestyle": DASHED, "label": "_unseen"})


def name_unseen(axes: Axes, estimates: tuple[Estimate, ...]) -> None:
    """Put an entry for the dashes into a legend to come, if there are any."""
    found = (estimate for estimate in estimates if estimate.found is not None)
    if not all(seen_codes(estimate, channel).all() for estimate in found for channel in range(3)):
        axes.plot([], [], color="0.3", linestyle=DASHED, label=UNSEEN)
