"""Points that are seen several times, each in a light of its own: what is left without it."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.values import Float, Index

_NO_WEIGHT = 1e-12  # of a point: one whose values are all set aside


def without_own_light(rows: Float, weights: Float, first: Index) -> Float:
    """Rows (V, U) less their weighted mean over each point, which takes out the point's own light.

    Rows of a point follow each other; `first` (P,) holds the place of its first.
    """
    sums = np.add.reduceat(rows * weights[:, None], first)
    total = np.maximum(np.add.reduceat(weights, first), _NO_WEIGHT)
    count = np.diff(first, append=len(rows))
    return np.asarray(rows - np.repeat(sums / total[:, None], count, axis=0))


def one_each(group: Index, count: int) -> Float:
    """(V, count) columns of one number a group: 1 where a value is of the group (V,), else 0."""
    columns: Float = np.zeros((len(group), count))
    columns[np.arange(len(group)), group] = 1.0
    return columns
