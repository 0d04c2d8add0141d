"""Pigment separation: two directions of log albedo by independent components (sec. 5.1, eq. 24)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.values import Bool, Float, Index, frozen

ANGLES = 36  # of 2.5 degrees, then
FINER = 5  # steps of half a degree to either side of the best
GAUSSIAN_LOG_COSH = 0.3745672  # mean of log cosh of a standard normal variable
# Both pigments raise log R/G and lower log B/G, melanin by the ratio 0.6, hemoglobin by 3 or more;
# this direction lies between them.
REDDENING = np.array([np.sin(np.radians(50.0)), np.cos(np.radians(50.0))])


@dataclass(frozen=True, slots=True, eq=False)
class Pigments:
    """Pigment densities of the skin and the directions that name them (eq. 24).

    Attributes
    ----------
    melanin, hemoglobin
        (N,) relative optical density of each skin pixel, in units of `directions`.
    directions
        (2, 3) unit vectors in log RGB, melanin first, pointing toward *less* light (negative
        for absorption).
    """

    melanin: Float
    hemoglobin: Float
    directions: Float

    def __post_init__(self) -> None:
        for name in ("melanin", "hemoglobin", "directions"):
            object.__setattr__(self, name, frozen(getattr(self, name)))


def separate_pigments(log_albedo: Float, diffuse: Bool, neighbors: Index) -> Pigments:
    """Find the two pigment directions and the densities of every pixel.

    The paper runs ICA on log pseudo-albedo. What the decomposition leaves of shading there is
    achromatic and less Gaussian than the pigments, and as near to melanin in direction (20 degrees)
    as hemoglobin is: ICA then takes it for a pigment. So ICA sees only the two log chromaticities,
    in which shading vanishes, and each source's achromatic part is found by regression over
    neighboring pixels, between which shading hardly changes. (Tsumura et al. 2003, the paper's
    ref. 34, likewise set shading aside before ICA.) The densities solve eq. 24, its right-hand side
    read as a logarithm, with the achromatic residue as a third unknown.

    Parameters
    ----------
    log_albedo
        (n, 3) log pseudo-albedo of skin pixels.
    diffuse
        (n,) the pixels from which to learn.
    neighbors
        (E, 2) pairs of neighboring pixels.
    """
    green = log_albedo[:, 1]
    chromaticity = np.stack([log_albedo[:, 0] - green, green - log_albedo[:, 2]], axis=1)
    mixing = _independent_directions(chromaticity[diffuse])
    sources = np.linalg.solve(mixing.T, chromaticity.T).T
    p, q = neighbors[diffuse[neighbors].all(axis=1)].T
    achromatic, *_ = np.linalg.lstsq(sources[q] - sources[p], green[q] - green[p], rcond=None)
    directions = np.stack(
        [achromatic + mixing[:, 0], achromatic, achromatic - mixing[:, 1]], axis=1
    )
    lengths = np.linalg.norm(directions, axis=1)
    densities = (sources * lengths).T
    return Pigments(densities[0], densities[1], directions / lengths[:, None])


def _independent_directions(chromaticity: Float) -> Float:
    """Rows: change of log R/G and log G/B with melanin, then with hemoglobin.

    Of two whitened variables, independent components are known up to one rotation: the angle of
    greatest non-Gaussianity (the log cosh contrast of FastICA) is found by trying them all.
    Hemoglobin is the component that changes R/G more, relative to B/G: over the measured spectra
    of pigments, cameras and lights this order never changes.
    """
    centered = chromaticity - chromaticity.mean(axis=0)
    variances, axes = np.linalg.eigh(centered.T @ centered / len(centered))
    spreads = np.sqrt(np.maximum(variances, 1e-12))
    angle = _least_gaussian_angle(centered @ (axes / spreads))
    rotation = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    mixing = rotation @ (axes * spreads).T
    mixing *= np.where(mixing @ REDDENING < 0.0, -1.0, 1.0)[:, None]
    return np.asarray(mixing[np.argsort(np.arctan2(mixing[:, 0], mixing[:, 1]))])


def _least_gaussian_angle(white: Float) -> float:
    """Rotation [rad] below a right angle that maximizes both components' negentropy."""
    step = np.pi / 2.0 / ANGLES
    coarse = _best_angle(white, np.arange(ANGLES) * step)
    return _best_angle(white, coarse + np.linspace(-step, step, 2 * FINER + 1))


def _best_angle(white: Float, angles: Float) -> float:
    return float(angles[np.argmax([_contrast(white, angle) for angle in angles])])


def _contrast(white: Float, angle: float) -> float:
    """Sum over both rotated components of (E log cosh - that of a Gaussian) squared."""
    first = np.cos(angle) * white[:, 0] + np.sin(angle) * white[:, 1]
    second = np.cos(angle) * white[:, 1] - np.sin(angle) * white[:, 0]
    # log cosh s, written so that large values do not overflow
    means = [
        (np.abs(s) + np.log1p(np.exp(-2.0 * np.abs(s)))).mean() - np.log(2.0)
        for s in (first, second)
    ]
    return float(sum((mean - GAUSSIAN_LOG_COSH) ** 2 for mean in means))
