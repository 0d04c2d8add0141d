"""Rank energy of color blends: condition numbers of edge matrices (Lee et al., PAMI 2013)."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.published.energy.color_blend import EdgeBlends, SampledBlends
from facecrf_ocio.values import Float


class BlendRank:
    """Sum over edge patches of the condition number `kappa_2 = sigma_2 / sigma_1`.

    The matrix of a patch has the columns `g(Mp) - g(M1)` and `g(M2) - g(M1)`. A blend is
    `g(Mp) = a g(M1) + (1 - a) g(M2)`, so with one region subtracted the columns are multiples of
    one vector and the rank is 1. Without subtraction the rank is 2: only a bend of the blend out
    of the plane through black would count, and a bend inside of that plane would cost nothing.

    A ratio of singular values does not change when all three curves are flattened together,
    which keeps this energy from the trivial solutions that a distance rewards.

    Parameters
    ----------
    edge_blends
        Edge colors of one photo.
    size
        Number of samples K of the curves that will be asked about.
    softness
        Singular value (linear light) below which it is rounded off: its gradient has a corner
        at 0, which is where the solution lies. One step of 8 bits.
    """

    def __init__(
        self, edge_blends: EdgeBlends, size: int, *, softness: float = 1.0 / 255.0
    ) -> None:
        self._edges = SampledBlends(edge_blends, size)
        self._softness = softness

    def condition_numbers(self, samples: Float) -> Float:
        """`kappa_2` of each patch (P,) for curves (3, K)."""
        first, second, _ = self._singular(*self._columns(samples))
        return np.asarray(second / first)

    def value_and_gradient(self, samples: Float) -> tuple[float, Float]:
        """Sum of the condition numbers and its gradient by the curves' samples; see `Term`."""
        edges = self._edges
        columns, across = self._columns(samples)
        first, second, vectors = self._singular(columns, across)
        ratio = second / first
        # With d sigma_i = u_i^T dA A^T u_i / sigma_i, the gradient by A is a 3 x 3 matrix times A.
        weights = np.stack([-ratio / first**2, 1.0 / (first * second)], axis=1)
        leading = vectors[:, :, [2, 1]]
        operator = (leading * weights[:, None, :]) @ leading.transpose(0, 2, 1)
        by_columns = np.einsum("tij,jt->it", operator[edges.patch], columns)
        by_across = np.einsum("pij,jp->ip", operator, across)
        by_first = -by_across - edges.sum_of_patches(by_columns)
        by_regions = np.stack([by_first, by_across], axis=2)
        gradient = edges.regions.gradient(by_regions) + edges.blends.gradient(by_columns)
        return float(ratio.sum()), gradient

    def _columns(self, samples: Float) -> tuple[Float, Float]:
        """Columns of all patches: `g(Mp) - g(M1)` (3, T) and `g(M2) - g(M1)` (3, P)."""
        regions = self._edges.regions.values(samples)
        columns = self._edges.blends.values(samples) - regions[:, self._edges.patch, 0]
        return columns, regions[:, :, 1] - regions[:, :, 0]

    def _singular(self, columns: Float, across: Float) -> tuple[Float, Float, Float]:
        """First two singular values (P,), rounded at 0, and left vectors (P, 3, 3) ascending."""
        products = columns[:, None] * columns[None]
        gram = self._edges.sum_of_patches(products, axis=2) + across[:, None] * across[None]
        squares, vectors = np.linalg.eigh(gram.transpose(2, 0, 1))
        rounded = np.sqrt(np.maximum(squares[:, 1:], 0.0) + self._softness**2)
        return rounded[:, 1], rounded[:, 0], vectors
