"""Skin pigment prior E_p: gradients of one pigment are rank one (sec. 4.1, eq. 12-16)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from facecrf_ocio.published.energy.sampling import Sampling
from facecrf_ocio.values import Bool, Float

MIN_LINEAR = 1e-5  # light below this counts as this, so that its logarithm is finite
MIN_RATIO = 1e-2  # ratio of neighboring pixels' light, likewise

PullBack = Callable[[Float], Float]


@dataclass(frozen=True, slots=True, eq=False)
class PigmentPairs:
    """What E_p needs of the photo: pairs of pixels, and shading as a linear map of `log g`.

    Attributes
    ----------
    encoded
        (3, N, 2) encoded values of both pixels of each single-pigment pair, p then q.
    is_melanin
        (N,) True where melanin alone changes, False where hemoglobin alone does.
    nodes
        (J,) encoded values at which `log g` is taken for the shading.
    shading
        (3, N, J) weights that turn `log g` at the nodes into `d_q - d_p`, because the
        decomposition of eq. 27 is linear in `log g(I)`; None for `dD/D = 0`.
    """

    encoded: Float
    is_melanin: Bool
    nodes: Float
    shading: Float | None


class SkinPigment:
    """E_p of eq. 16: second over first singular value, summed over both pigments.

    Parameters
    ----------
    pairs
        Pairs of one photo, all faces together.
    size
        Number of samples K of the curves that will be asked about.
    first_order
        False: `log P = log g(I_q) - log g(I_p) - (d_q - d_p)`, which eq. 15 approximates.
        True: `P = g'(I) dI / g(I) - dD/D + 1` with forward differences, as eq. 12-15 print.
    balanced
        Scale each channel's row of the matrix to the same length first. A matrix of rank one keeps
        its rank, but a curve can no longer make the ratio small by being so steep in one channel
        that this row alone makes up the matrix: with noise, E_p as printed is smallest there.
    """

    def __init__(
        self,
        pairs: PigmentPairs,
        size: int,
        *,
        first_order: bool = False,
        balanced: bool = False,
    ) -> None:
        self._shading = pairs.shading
        self._groups = (pairs.is_melanin, ~pairs.is_melanin)
        self._pairs = Sampling.at(pairs.encoded, size)
        self._near = Sampling.at(pairs.encoded[:, :, 0], size)
        self._step = pairs.encoded[:, :, 1] - pairs.encoded[:, :, 0]
        self._nodes = Sampling.at(np.tile(pairs.nodes, (3, 1)), size)
        self._formula = self._first_order if first_order else self._exact
        self._ratio = balanced_ratio if balanced else singular_ratio

    def columns(self, samples: Float) -> Float:
        """The columns `log P` for curves (3, K), shape (3, N)."""
        return self._log_ratios(samples)[0]

    def value_and_gradient(self, samples: Float) -> tuple[float, Float]:
        """E_p and its gradient by the curves' samples; see `Term`."""
        columns, pull_back = self._log_ratios(samples)
        value, by_columns = 0.0, np.zeros_like(columns)
        for chosen in self._groups:
            ratio, by_columns[:, chosen] = self._ratio(columns[:, chosen])
            value += ratio
        return value, pull_back(by_columns)

    def _log_ratios(self, samples: Float) -> tuple[Float, PullBack]:
        """The columns (3, N), and the map from a gradient by them to one by the samples (3, K)."""
        if self._shading is None:
            columns, back, _ = self._formula(samples, np.zeros_like(self._step))
            return columns, back
        weights = self._shading
        log_linear, node_back = _log_linear(self._nodes, samples)
        change = (weights @ log_linear[:, :, None])[:, :, 0]
        columns, pair_back, by_change = self._formula(samples, change)

        def pull_back(by_columns: Float) -> Float:
            by_nodes = ((by_columns * by_change)[:, None, :] @ weights)[:, 0]
            return pair_back(by_columns) + node_back(by_nodes)

        return columns, pull_back

    def _exact(self, samples: Float, shading_change: Float) -> tuple[Float, PullBack, Float]:
        """The log albedo ratio itself, its map back to the samples, and its slope by shading."""
        log_linear, back = _log_linear(self._pairs, samples)
        columns = log_linear[:, :, 1] - log_linear[:, :, 0] - shading_change
        signs = np.array([-1.0, 1.0])
        return columns, lambda by: back(by[:, :, None] * signs), np.array(-1.0)

    def _first_order(self, samples: Float, shading_change: Float) -> tuple[Float, PullBack, Float]:
        """Eq. 15 as printed, its map back to the samples, and its slope by shading."""
        raw_linear = self._near.values(samples)
        linear = np.maximum(raw_linear, MIN_LINEAR)
        slope = self._near.slopes(samples)
        shading_ratio = np.exp(shading_change)
        raw = slope * self._step / linear - (shading_ratio - 1.0) + 1.0
        ratio = np.maximum(raw, MIN_RATIO)
        by_ratio = np.where(raw > MIN_RATIO, 1.0 / ratio, 0.0)

        def back(by_columns: Float) -> Float:
            by_slope = by_columns * by_ratio * self._step / linear
            by_linear = np.where(raw_linear > MIN_LINEAR, -by_slope * slope / linear, 0.0)
            return self._near.gradient(by_linear, by_slope)

        return np.log(ratio), back, -by_ratio * shading_ratio


def singular_ratio(columns: Float) -> tuple[float, Float]:
    """Second over first singular value of a matrix (3, n), and its gradient by the entries.

    From the 3 x 3 Gram matrix: its eigenvalues are the squared singular values, and
    `d s_i = u_i^T dM v_i` with `v_i = M^T u_i / s_i`.
    """
    squares, vectors = np.linalg.eigh(columns @ columns.T)
    first, second = np.sqrt(np.maximum(squares[[2, 1]], 1e-30))
    by_first = np.outer(vectors[:, 2], vectors[:, 2] @ columns) / first
    by_second = np.outer(vectors[:, 1], vectors[:, 1] @ columns) / second
    ratio = second / first
    return float(ratio), (by_second - ratio * by_first) / first


def balanced_ratio(columns: Float) -> tuple[float, Float]:
    """`singular_ratio` of a matrix (3, n) whose rows are scaled to unit root mean square."""
    size = columns.shape[1]
    lengths = np.sqrt((columns * columns).mean(axis=1, keepdims=True)) + 1e-12
    rows = columns / lengths
    ratio, by_rows = singular_ratio(rows)
    along = (rows * by_rows).sum(axis=1, keepdims=True) / size
    return ratio, (by_rows - rows * along) / lengths


def _log_linear(points: Sampling, samples: Float) -> tuple[Float, PullBack]:
    raw = points.values(samples)
    linear = np.maximum(raw, MIN_LINEAR)
    slope = np.where(raw > MIN_LINEAR, 1.0 / linear, 0.0)
    return np.log(linear), lambda by_log: points.gradient(by_log * slope)
