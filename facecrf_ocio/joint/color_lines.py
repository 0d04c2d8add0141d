"""The bend of the response at each level, from the lines that colors take across soft edges.

In linear light a blend of two colors lies on the line between them, whatever blurs the edge and
however far; in encoded values the line is bent, by as much as the response is. After Lin et al.
(CVPR 2004), in closed form: `soft_edges.py` has the equations.
"""

from __future__ import annotations

import numpy as np

from facecrf_ocio.joint.soft_edges import SOFT_LEVELS
from facecrf_ocio.values import Float

_MIDDLES = (np.arange(SOFT_LEVELS) + 0.5) / SOFT_LEVELS  # [1] of each level
_USUAL = 1.2 / _MIDDLES  # g'' / g' of light as a power of 2.2
# What the squares of x sum up to where a bend is trusted by half; chosen by judgment.
_FEW = 3e-3
_SMALLEST = 1e-4  # squared difference of places, of rounding alone


def bend_profile(*counts: Float) -> Float:
    """How far the response bends otherwise than usual at each of eight levels, and the trust in it.

    Parameters
    ----------
    counts
        Each (4, 8, 11) as `SoftEdges.lines` has them.

    Returns
    -------
    Float
        Of each count and size, and then of all together, 18 numbers: at each level e the bend
        `e g'' / g'` less that of a power of 2.2, zero where nothing tells; the trust in it; the
        logarithm of the number of edges; and that of the mean square that is left.
    """
    every = np.concatenate(counts)
    return np.concatenate([_profile(size) for size in (*every, every.sum(axis=0))])


def _profile(lines: Float) -> Float:
    """The 18 numbers of one size, from its counts (8, 11)."""
    matrix, right = lines[:, :SOFT_LEVELS], lines[:, SOFT_LEVELS]
    edges, squares = 0.5 * lines[:, SOFT_LEVELS + 1 :].sum(axis=0)  # each stands at two levels
    offset = np.linalg.solve(matrix + _FEW * np.eye(SOFT_LEVELS), right - matrix @ _USUAL)
    bend = _USUAL + offset
    left = max(float(squares - 2.0 * bend @ right + bend @ matrix @ bend), 0.0)
    trust = np.diag(matrix) / (np.diag(matrix) + _FEW)
    told = [np.log(edges + 1.0), np.log(left / max(edges, 1.0) + _SMALLEST)]
    return np.concatenate([offset * _MIDDLES, trust, told])
