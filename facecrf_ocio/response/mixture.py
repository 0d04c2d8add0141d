"""A Gaussian mixture over response coefficients: the empirical prior (sec. 4.3, eq. 20-21)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from facecrf_ocio.values import Float, frozen


@dataclass(frozen=True, slots=True, eq=False)
class Mixture:
    """Gaussian mixture with equal weights, as eq. 20 has it.

    Attributes
    ----------
    means
        (K, M).
    covariances
        (K, M, M), symmetric positive definite.
    """

    means: Float
    covariances: Float
    _precisions: Float = field(init=False, repr=False)
    _log_scales: Float = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "means", frozen(self.means))
        object.__setattr__(self, "covariances", frozen(self.covariances))
        _, log_determinants = np.linalg.slogdet(self.covariances)
        constant = self.means.shape[1] * np.log(2.0 * np.pi)
        object.__setattr__(self, "_precisions", frozen(np.linalg.inv(self.covariances)))
        object.__setattr__(self, "_log_scales", frozen(-0.5 * (log_determinants + constant)))

    def log_components(self, points: Float) -> Float:
        """Log density of each component, (..., M) -> (..., K)."""
        offset, pull = self._pulls(points)
        return np.asarray(self._log_scales + 0.5 * (offset * pull).sum(axis=-1))

    def log_density(self, points: Float) -> Float:
        """Log of eq. 20, (..., M) -> (...)."""
        return _log_mean_exp(self.log_components(points))

    def gradient(self, points: Float) -> Float:
        """Gradient of `log_density` by the point, (..., M) -> (..., M)."""
        logs = self.log_components(points)
        share = np.exp(logs - logs.max(axis=-1, keepdims=True))
        share /= share.sum(axis=-1, keepdims=True)
        return np.asarray((share[..., None] * self._pulls(points)[1]).sum(axis=-2))

    def _pulls(self, points: Float) -> tuple[Float, Float]:
        """Offsets of points (..., M) from means (..., C, M), and log densities' gradients there."""
        offset = points[..., None, :] - self.means
        return offset, -(self._precisions @ offset[..., None])[..., 0]


def fit_mixture(
    points: Float, components: int, *, floor: float = 1e-4, tolerance: float = 1e-13
) -> Mixture:
    """Fit a mixture with equal weights by expectation maximization.

    The start is deterministic (farthest points, then Lloyd's iterations in scaled coordinates),
    so that the result does not depend on a random generator or a library's version.

    Parameters
    ----------
    points
        (C, M).
    components
        Number of Gaussians.
    floor
        Added to each covariance, as a share of the points' variance in every dimension: a
        component must not collapse onto the curves of one film.
    tolerance
        Relative change of the mean log likelihood at which to stop.
    """
    ridge = floor * np.diag(points.var(axis=0))
    labels = _lloyd(points / points.std(axis=0), components)
    shares = np.eye(components)[labels]
    previous = -np.inf
    for _ in range(10_000):
        mixture = _maximize(points, shares, ridge)
        logs = mixture.log_components(points)
        likelihood = float(_log_mean_exp(logs).mean())
        if likelihood - previous < tolerance * abs(likelihood):
            break
        previous = likelihood
        shares = np.exp(logs - logs.max(axis=1, keepdims=True))
        shares /= shares.sum(axis=1, keepdims=True)
    return mixture


def _maximize(points: Float, shares: Float, ridge: Float) -> Mixture:
    mass = shares.sum(axis=0)
    means = (shares.T @ points) / mass[:, None]
    offset = points[None] - means[:, None]
    covariances = np.einsum("ck,kcm,kcn->kmn", shares, offset, offset) / mass[:, None, None]
    return Mixture(means, covariances + ridge)


def _lloyd(points: Float, components: int) -> np.ndarray:
    centers = points[[int(np.argmin((points**2).sum(axis=1)))]]
    while len(centers) < components:
        nearest = ((points[:, None] - centers) ** 2).sum(axis=2).min(axis=1)
        centers = np.vstack([centers, points[np.argmax(nearest)]])
    labels = np.zeros(len(points), dtype=np.intp)
    for _ in range(100):
        labels = ((points[:, None] - centers) ** 2).sum(axis=2).argmin(axis=1)
        moved = np.array([points[labels == k].mean(axis=0) for k in range(components)])
        if np.array_equal(moved, centers):
            break
        centers = moved
    return labels


def _log_mean_exp(logs: Float) -> Float:
    top = logs.max(axis=-1, keepdims=True)
    return np.asarray(top[..., 0] + np.log(np.exp(logs - top).mean(axis=-1)))
