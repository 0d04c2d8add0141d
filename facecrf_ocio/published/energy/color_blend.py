"""Color-blend energy: across an edge, linear colors lie on a segment (Lin et al., CVPR 2004)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.published.energy.sampling import Sampling
from facecrf_ocio.values import Float, Index

# [linear^2] keeps a division finite where a curve makes both regions alike.
MIN_LENGTH_SQUARED = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class EdgeBlends:
    """Colors measured at edges between two uniform regions.

    Attributes
    ----------
    regions
        (3, P, 2) encoded mean colors of both regions of each edge patch, `M1` and `M2`.
    blends
        (3, T) encoded colors of edge pixels, `Mp`, patch after patch.
    patch
        (T,) index of the patch of each edge pixel, ascending; every patch has one at least.
    """

    regions: Float
    blends: Float
    patch: Index


class SampledBlends:
    """Edge colors of one photo as curves of K samples give them in linear light.

    Attributes
    ----------
    patch
        (T,) as in `EdgeBlends`.
    regions, blends
        What makes of curves (3, K) the linear colors of `EdgeBlends`, and of gradients by these
        those by the samples.
    """

    def __init__(self, edge_blends: EdgeBlends, size: int) -> None:
        self.patch = edge_blends.patch
        self.regions = Sampling.at(edge_blends.regions, size)
        self.blends = Sampling.at(edge_blends.blends, size)
        self._starts = np.searchsorted(self.patch, np.arange(edge_blends.regions.shape[1]))

    def sum_of_patches(self, of_pixels: Float, axis: int = 1) -> Float:
        """Sums over each patch: the axis of T edge pixels becomes one of P patches."""
        return np.asarray(np.add.reduceat(of_pixels, self._starts, axis=axis))


class ColorBlend:
    """D(g; Omega): distances of linear edge colors from the line through both region colors.

    `D = sum |(g(M1) - g(M2)) x (g(M1) - g(Mp))| / |g(M1) - g(M2)|` over all edge pixels.

    Parameters
    ----------
    edge_blends
        Edge colors of one photo.
    size
        Number of samples K of the curves that will be asked about.
    softness
        Distance (linear light) below which the norm turns into a parabola: it has a corner at
        0, which is where the solution lies.
    """

    def __init__(self, edge_blends: EdgeBlends, size: int, *, softness: float = 1e-3) -> None:
        self._edges = SampledBlends(edge_blends, size)
        self._softness = softness

    def value_and_gradient(self, samples: Float) -> tuple[float, Float]:
        """D of the three curves and its gradient by their samples; see `Term`."""
        edges = self._edges
        regions = edges.regions.values(samples)[:, edges.patch]
        along = regions[:, :, 1] - regions[:, :, 0]
        across = edges.blends.values(samples) - regions[:, :, 0]
        normal = _cross(along, across)
        length_squared = np.maximum((along**2).sum(axis=0), MIN_LENGTH_SQUARED)
        squared = (normal**2).sum(axis=0) / length_squared
        distance = np.sqrt(squared + self._softness**2)
        scale = 1.0 / (length_squared * distance)
        by_along = (_cross(across, normal) - squared * along) * scale
        by_across = _cross(normal, along) * scale
        by_ends = np.stack([-by_along - by_across, by_along], axis=2)
        by_regions = edges.sum_of_patches(by_ends)
        gradient = edges.regions.gradient(by_regions) + edges.blends.gradient(by_across)
        return float((distance - self._softness).sum()), gradient


def _cross(a: Float, b: Float) -> Float:
    """Cross product of vectors (3, T); numpy's own is ten times slower in this layout."""
    return np.stack(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )
