"""The prior of the joint estimator: families of responses, and what evidence makes of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.files.smooth_arrays import smooth_array
from facecrf_ocio.files.stored_arrays import load_arrays
from facecrf_ocio.settings import PRIORS
from facecrf_ocio.values import Float, Index, frozen

FAMILIES = ("dorf", "camera", "phone")
"""Film and early cameras; digital cameras and raw converters; phones and webcams."""
_EVERYWHERE = slice(None)  # of a curve's samples


@dataclass(frozen=True, slots=True, eq=False)
class Message:
    """What a cue says of the coefficients: a Gaussian likelihood with independent deviations.

    Attributes
    ----------
    mean, precision
        (M,) in units of the prior's coefficients.
    """

    mean: Float
    precision: Float


@dataclass(frozen=True, slots=True, eq=False)
class Posterior:
    """A Gaussian mixture over the coefficients.

    Attributes
    ----------
    weights, means, covariances
        (K,), (K, M), (K, M, M).
    """

    weights: Float
    means: Float
    covariances: Float

    @property
    def mean(self) -> Float:
        """(M,) mean of the mixture: the coefficients with the least expected squared error."""
        return np.asarray(self.weights @ self.means)

    @property
    def covariance(self) -> Float:
        """(M, M) covariance of the mixture."""
        offset = self.means - self.mean
        within = np.einsum("k,kmn->mn", self.weights, self.covariances)
        return np.asarray(within + np.einsum("k,km,kn->mn", self.weights, offset, offset))

    def times(self, message: Message, precisions: _Precisions | None = None) -> Posterior:
        """After one more likelihood: a product of Gaussians, component by component.

        `precisions` are those of the covariances, where they are known.
        """
        precisions = precisions or _Precisions.of(self.covariances)
        before = _Components(self.weights, self.means, precisions)
        shares, means, covariances = before.times(message.mean[None], message.precision[None])
        return Posterior(shares[0], means[0], covariances[0])


@dataclass(frozen=True, slots=True, eq=False)
class _Precisions:
    """Inverses (K, M, M) of covariances, and the logarithms (K,) of their determinants."""

    inverses: Float
    logs: Float

    @classmethod
    def of(cls, covariances: Float) -> _Precisions:
        inverses = frozen(np.linalg.inv(covariances))
        return cls(inverses, frozen(np.linalg.slogdet(inverses)[1]))


@dataclass(frozen=True, slots=True, eq=False)
class _Components:
    """A Gaussian mixture by the precisions of its components."""

    weights: Float
    means: Float
    precisions: _Precisions

    def times(self, means: Float, precisions: Float) -> tuple[Float, Float, Float]:
        """Weights (C, K), means and covariances after each of C likelihoods, each (C, M).

        A message's own offset and determinant follow from the inverse that the product needs
        (Woodbury), so that each component is inverted once.
        """
        own = self.precisions.inverses
        after = own + diagonal(precisions)[:, None]
        covariances = np.linalg.inv(after)
        pull = (own @ self.means[..., None])[..., 0] + (precisions * means)[:, None]
        centers = (covariances @ pull[..., None])[..., 0]
        offset = self.means - means[:, None]
        pulled = precisions[:, None] * offset
        known = (covariances @ pulled[..., None])[..., 0]
        fit = ((offset - known) * pulled).sum(axis=-1)
        volume = np.linalg.slogdet(after)[1] - self.precisions.logs
        with np.errstate(divide="ignore"):
            logs = np.log(self.weights) - 0.5 * (fit + volume)
        shares = np.exp(logs - logs.max(axis=1, keepdims=True))
        return shares / shares.sum(axis=1, keepdims=True), centers, covariances


def diagonal(values: Float) -> Float:
    """(..., M, M) of values (..., M) on the diagonal."""
    return np.asarray(values[..., None] * np.eye(values.shape[-1]))


@dataclass(frozen=True, slots=True, eq=False)
class FamilyPrior:
    """Responses of several families as one Gaussian mixture over a dozen coefficients.

    The coefficients are those of the root of light: what is even there is nearly even in stops, so
    that shadows count as well as lights, and noise is summed to the root of light (`grain.py`).

    Attributes
    ----------
    grid
        (K,) uniform encoded values from 0 to 1.
    mean
        (K,) mean of the root of linear light.
    basis
        (M, K) its eigenvectors, scaled so that coefficients have unit variance.
    weights, means, covariances
        Of the mixture's components, (C,), (C, M), (C, M, M).
    family
        (C,) index into `FAMILIES` of each component.
    """

    grid: Float
    mean: Float
    basis: Float
    weights: Float
    means: Float
    covariances: Float
    family: Float

    def __post_init__(self) -> None:
        for name in ("grid", "mean", "basis", "weights", "means", "covariances", "family"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    def samples(self, coefficients: Float, where: slice | Index = _EVERYWHERE) -> Float:
        """Curves on the grid, (..., M) -> (..., K), or at some of it; not made monotone."""
        roots = np.maximum(self.roots(coefficients, where), 0.0)
        return np.asarray(np.square(roots, out=roots))

    def roots(self, coefficients: Float, where: slice | Index = _EVERYWHERE) -> Float:
        """Roots of linear light on the grid, (..., M) -> (..., K), or at some of it."""
        return np.asarray(self.mean[where] + coefficients @ self.basis[:, where])

    def weights_for(self, prior: str, leaning: float = 0.0, phone: float = 0.0) -> Float:
        """Weights of the components, (C,).

        Parameters
        ----------
        prior
            `dorf`, `modern`, or `auto` for both.
        leaning
            Log odds that the file's metadata add to `modern`, which is cameras and phones, where
            the prior is `auto`.
        phone
            Log odds that they add to phones against cameras among modern ones.

        Raises
        ------
        SettingsError
            If the prior is not known.
        """
        if prior not in PRIORS:
            raise SettingsError(f"no prior {prior!r}; known: {', '.join(PRIORS)}")
        modern, small = (1.0 / (1.0 + np.exp(-odds)) for odds in (leaning, phone))
        modern = {"auto": modern, "dorf": 0.0, "modern": 1.0}[prior]
        odds = np.array([1.0 - modern, modern * (1.0 - small), modern * small])
        weights = self.weights * odds[self.family.astype(np.intp)]
        return np.asarray(weights / weights.sum())

    def shares_of_families(self, weights: Float) -> Float:
        """(F,) how much of components' weights (C,) is each family's, as `FAMILIES` has them."""
        of_family = np.bincount(self.family.astype(np.intp), weights, len(FAMILIES))
        return np.asarray(of_family / weights.sum())

    def posterior(self, message: Message | None, weights: Float) -> Posterior:
        """What a likelihood leaves of the prior, whose components have these weights (C,)."""
        before = Posterior(weights, self.means, self.covariances)
        return before if message is None else before.times(message, _precisions(self))

    def posteriors(self, means: Float, precisions: Float, weights: Float) -> tuple[Float, Float]:
        """Mean (C, M) and covariance (C, M, M) of what each of C likelihoods leaves of the prior.

        As `posterior` gives them one by one, in a fraction of the time.
        """
        before = _Components(weights, self.means, _precisions(self))
        shares, centers, covariances = before.times(means, precisions)
        mean = (shares[..., None] * centers).sum(axis=1)
        offset = centers - mean[:, None]
        within = np.einsum("ck,ckmn->cmn", shares, covariances)
        return mean, within + np.einsum("ck,ckm,ckn->cmn", shares, offset, offset)

    def deviations(self, posterior: Posterior) -> Float:
        """(K,) standard deviation of the posterior's curves on the grid.

        Of a Gaussian root with mean m and variance v: its square has the variance
        4 m^2 v + 2 v^2.
        """
        variance = np.einsum("mk,mn,nk->k", self.basis, posterior.covariance, self.basis)
        variance = np.maximum(variance, 0.0)
        mean = self.roots(posterior.mean)
        return np.asarray(np.sqrt(4.0 * mean**2 * variance + 2.0 * variance**2))


@lru_cache(maxsize=4)  # a photo's cues ask some thirty times what each leaves of its prior
def _precisions(prior: FamilyPrior) -> _Precisions:
    return _Precisions.of(prior.covariances)


def prior_of(arrays: Mapping[str, Float]) -> FamilyPrior:
    """The prior in the arrays of a file of weights."""
    mean = smooth_array(arrays, "prior_mean")
    return FamilyPrior(
        np.linspace(0.0, 1.0, mean.size),
        mean,
        smooth_array(arrays, "prior_basis"),
        arrays["prior_weights"],
        arrays["prior_means"],
        from_triangles(arrays["prior_covariances"], arrays["prior_means"].shape[1]),
        arrays["prior_family"],
    )


def triangles(covariances: Float) -> Float:
    """Lower halves (K, M(M + 1) / 2) of symmetric matrices (K, M, M), as they are stored."""
    rows, columns = np.tril_indices(covariances.shape[-1])
    return np.asarray(covariances[:, rows, columns])


def from_triangles(halves: Float, size: int) -> Float:
    """(K, M, M) of what `triangles` made of them."""
    rows, columns = np.tril_indices(size)
    whole = np.empty((len(halves), size, size), halves.dtype)
    whole[:, rows, columns] = whole[:, columns, rows] = halves
    return whole


@cache
def shipped_prior() -> FamilyPrior:
    """The prior that ships, fitted to responses of film, digital cameras, phones and webcams."""
    return prior_of(load_arrays(Path(__file__).parent / "joint_model.npz"))
