"""Geometry-guided intrinsic decomposition into albedo and shading (sec. 5.2, eq. 26-28)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import scipy

from facecrf_ocio.settings import PublishedSettings
from facecrf_ocio.values import Bool, Float, Index

GAUGE = 1e-7  # weight that pins the constant which eq. 27 leaves open; too small to move the rest
COLUMNS_AT_ONCE = 16  # three times as fast per column as one, or as a hundred, at a time


@dataclass(frozen=True, slots=True, eq=False)
class Decomposition:
    """The linear map from log radiance `r` to log shading `d` that minimizes eq. 27.

    The weights come from the encoded photo and the mesh, not from the candidate curve: so the map
    is the same for every curve, and is factorized once. Each channel is decomposed by the same
    map; where albedo is `rho_m log sigma_m + rho_h log sigma_h`, what the map takes for shading is
    then filtered the same way in every channel, and single-pigment gradients stay rank one.

    Attributes
    ----------
    neighbors
        (E, 2) 4-connected pairs of pixels.
    same_albedo
        Weighted graph Laplacian of the pairs with close chromaticity (n, n).
    factors
        Factorization of the system matrix of eq. 28, unknowns are pixels then normal directions.
    """

    neighbors: Index
    same_albedo: scipy.sparse.csc_matrix
    factors: scipy.sparse.linalg.SuperLU

    def shading(self, log_radiance: Float) -> Float:
        """Log shading of log radiance (n,) or (n, C), up to a constant."""
        return self._solve(self.same_albedo @ log_radiance)

    def shading_change_weights(self, pairs: Index) -> Float:
        """Weights (n, N) that turn log radiance into `d_q - d_p` of pairs (N, 2): the adjoint."""
        count = len(pairs)
        columns = np.zeros((self.same_albedo.shape[0], count))
        np.add.at(columns, (pairs[:, 1], np.arange(count)), 1.0)
        np.add.at(columns, (pairs[:, 0], np.arange(count)), -1.0)
        return np.asarray(self.same_albedo @ self._solve(columns))

    def _solve(self, right_sides: Float) -> Float:
        size = self.same_albedo.shape[0]
        columns = right_sides.reshape(size, -1)
        padded = np.zeros((self.factors.shape[0], columns.shape[1]), order="F")
        padded[:size] = columns
        solved = [
            self.factors.solve(padded[:, start : start + COLUMNS_AT_ONCE])[:size]
            for start in range(0, columns.shape[1], COLUMNS_AT_ONCE)
        ]
        return np.concatenate(solved, axis=1).reshape(right_sides.shape)


def prepare_decomposition(
    encoded: npt.NDArray[np.float32],
    normals: npt.NDArray[np.float32],
    skin: Bool,
    settings: PublishedSettings,
) -> Decomposition:
    """Build and factorize the quadratic form of eq. 27 over the skin pixels.

    The non-local term, "all pairs of pixels with the same normal direction", is written with
    extra unknowns, the shading at the nodes of a grid over the directions: each pixel is tied to
    what its normal reads there. Over the n pixels of one direction, the squared differences of all
    pairs are n times the squared distances from their mean; interpolating between the nodes
    does the same without steps at the borders of directions.

    Parameters
    ----------
    encoded
        (H, W, 3) float32 in [0, 1].
    normals
        (H, W, 3) unit normals.
    skin
        (H, W) the pixels to decompose, numbered in row-major order.
    """
    pixels = encoded[skin].astype(np.float64)
    directions = normals[skin].astype(np.float64)
    neighbors = _neighbors(skin)
    close_albedo = settings.albedo_weight * (
        _distance(pixels / pixels.sum(axis=1, keepdims=True), neighbors)
        < settings.chromaticity_threshold
    )
    close_normal = settings.shading_weight * (
        _distance(directions, neighbors) < 2.0 * np.sin(np.radians(settings.normal_threshold) / 2.0)
    )
    size = len(pixels)
    ties = _direction_ties(directions, settings.normal_threshold)
    same_albedo = _laplacian(neighbors, close_albedo, size)
    local = same_albedo + _laplacian(neighbors, close_normal, size)
    tied = settings.nonlocal_weight * ties
    system = scipy.sparse.block_array(
        [
            [local + settings.nonlocal_weight * scipy.sparse.eye_array(size), -tied],
            [-tied.T, ties.T @ tied],
        ]
    ) + GAUGE * scipy.sparse.eye_array(size + ties.shape[1])
    # A symmetric positive definite matrix needs no pivoting, and keeps its sparsity without.
    factors = scipy.sparse.linalg.splu(
        scipy.sparse.csc_matrix(system),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return Decomposition(neighbors, same_albedo, factors)


def _neighbors(skin: Bool) -> Index:
    number = np.full(skin.shape, -1, dtype=np.intp)
    number[skin] = np.arange(int(skin.sum()))
    beside = np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)
    below = np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1)
    pairs = np.concatenate([beside, below])
    return pairs[(pairs >= 0).all(axis=1)]


def _distance(points: Float, pairs: Index) -> Float:
    return np.asarray(np.linalg.norm(points[pairs[:, 1]] - points[pairs[:, 0]], axis=1))


def _direction_ties(directions: Float, spacing: float) -> scipy.sparse.csc_matrix:
    """Bilinear weights (n, nodes) of a grid over the hemisphere, its center `spacing` degrees."""
    position = directions[:, :2] / np.sin(np.radians(spacing))
    corner = np.floor(position).astype(np.intp)
    x, y = (position - corner).T
    nodes, weights = [], []
    for right, up in ((0, 0), (1, 0), (0, 1), (1, 1)):
        nodes.append((corner[:, 0] + right) * 4096 + corner[:, 1] + up)
        weights.append((x if right else 1.0 - x) * (y if up else 1.0 - y))
    _, columns = np.unique(np.concatenate(nodes), return_inverse=True)
    rows = np.tile(np.arange(len(directions)), 4)
    return scipy.sparse.csc_matrix((np.concatenate(weights), (rows, columns.ravel())))


def _laplacian(pairs: Index, weights: Float, size: int) -> scipy.sparse.csc_matrix:
    p, q = pairs.T
    rows = np.concatenate([p, q, p, q])
    columns = np.concatenate([p, q, q, p])
    values = np.concatenate([weights, weights, -weights, -weights])
    return scipy.sparse.csc_matrix((values, (rows, columns)), shape=(size, size))
