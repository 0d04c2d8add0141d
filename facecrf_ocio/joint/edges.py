"""Edges over a whole photo: in linear light a blur is symmetric about its middle.

After Lin and Zhang (CVPR 2005), with the place of the middle pixels between the two sides as the
statistic, by the levels of both. Sharpening and scaling after the curve move it too; beside what
`texture.py` tells of them, a network can learn how far.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from facecrf_ocio.joint.edge_counts import EDGE_LEVELS
from facecrf_ocio.joint.noise_counts import NoiseCounts
from facecrf_ocio.joint.soft_edges import SOFT_LEVELS
from facecrf_ocio.values import Float

# Edges at which a place is trusted by half, of all and of soft ones; chosen by judgment, and
# trained with.
_FEW, _FEW_SOFT = 30.0, 20.0
# Every pair of levels once, the darker first.
_LEVELS, _SOFT = (np.triu_indices(count, 1) for count in (EDGE_LEVELS, SOFT_LEVELS))


def edge_profile(counts: NoiseCounts) -> Float | None:
    """Where the middles of edges lie; None without any edge.

    Returns
    -------
    Float
        (2 (E + E + 2),) at two sizes, for E = 28 pairs of levels: how far the middle lies above
        halfway, as far as there are edges to tell; the trust in it; logarithm of the number of
        edges, and the spread of their middles.
    """
    found: list[npt.ArrayLike] = []
    for size in counts.edges:
        number, total, squares = size[_LEVELS].T
        place, trust = _places(number, total, _FEW)
        all_edges = max(float(number.sum()), 1.0)
        spread = float(squares.sum()) / all_edges - (float(total.sum()) / all_edges) ** 2
        found += [place, trust, [np.log(number.sum() + 1.0), np.sqrt(max(spread, 0.0))]]
    if not counts.edges[..., 0].any():
        return None
    return np.concatenate(found)


def soft_edge_profile(*counts: Float) -> Float:
    """Where the middles of soft edges lie, one after another by what was counted and by size.

    Parameters
    ----------
    counts
        Each as `SoftEdges.middles` has them.

    Returns
    -------
    Float
        Of each count and size 2 E + 1 numbers for E = 28 pairs of levels: how far the middle lies
        above halfway, as far as there are edges to tell; the trust in it; and the logarithm of the
        number of edges.
    """
    found: list[npt.ArrayLike] = []
    for size in np.concatenate(counts):
        number, total, _ = size[_SOFT].T
        place, trust = _places(number, total, _FEW_SOFT)
        found += [place, trust, [np.log(number.sum() + 1.0)]]
    return np.concatenate(found)


def _places(number: Float, total: Float, few: float) -> tuple[Float, Float]:
    """How far middles lie above halfway, by trust, and the trust, of each pair of levels (E,)."""
    trust = number / (number + few)
    return (total / np.maximum(number, 1.0) - 0.5) * trust, trust
