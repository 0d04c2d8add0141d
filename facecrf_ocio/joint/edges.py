"""Edges over a whole photo: in linear light a blur is symmetric about its middle.

After Lin and Zhang (CVPR 2005), with the place of the middle pixels between the two sides as the
statistic, by the levels of both. Sharpening and scaling after the curve move it too; beside what
`texture.py` tells of them, a network can learn how far.
"""

from __future__ import annotations

import numpy as np

from facecrf_ocio.joint.edge_counts import EDGE_LEVELS
from facecrf_ocio.joint.noise_counts import NoiseCounts
from facecrf_ocio.values import Float

_FEW = 30.0  # edges at which a place is trusted by half; chosen by judgment, and trained with
_DARK, _BRIGHT = np.triu_indices(EDGE_LEVELS, 1)  # every pair of levels once, the darker first


def edge_profile(counts: NoiseCounts) -> Float | None:
    """Where the middles of edges lie; None without any edge.

    Returns
    -------
    Float
        (2 (E + E + 2),) at two sizes, for E = 28 pairs of levels: how far the middle lies above
        halfway, as far as there are edges to tell; the trust in it; logarithm of the number of
        edges, and the spread of their middles.
    """
    found = []
    for size in counts.edges:
        number, total, squares = size[_DARK, _BRIGHT].T
        trust = number / (number + _FEW)
        place = (total / np.maximum(number, 1.0) - 0.5) * trust
        all_edges = max(float(number.sum()), 1.0)
        spread = float(squares.sum()) / all_edges - (float(total.sum()) / all_edges) ** 2
        found += [place, trust, [np.log(number.sum() + 1.0), np.sqrt(max(spread, 0.0))]]
    if not counts.edges[..., 0].any():
        return None
    return np.concatenate(found)
