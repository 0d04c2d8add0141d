"""Neighboring pixels between which one pigment changes and the other does not (eq. 25)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.published.pigments import Pigments
from facecrf_ocio.settings import PublishedSettings
from facecrf_ocio.values import Bool, Index, frozen


@dataclass(frozen=True, slots=True, eq=False)
class PigmentGradients:
    """Neighboring skin pixels that differ in one pigment alone (eq. 25).

    Attributes
    ----------
    pairs
        (N, 2) indices of both pixels into the face's list of pixels.
    is_melanin
        (N,) True where melanin alone changes, False where hemoglobin alone does.
    """

    pairs: Index
    is_melanin: Bool

    def __post_init__(self) -> None:
        object.__setattr__(self, "pairs", frozen(self.pairs, np.intp))
        object.__setattr__(self, "is_melanin", frozen(self.is_melanin, bool))


def single_pigment_pairs(
    pigments: Pigments, neighbors: Index, diffuse: Bool, settings: PublishedSettings
) -> PigmentGradients:
    """Select the pairs in which one density changes much and the other hardly.

    Parameters
    ----------
    pigments
        Densities of all n skin pixels.
    neighbors
        (E, 2) pairs of skin pixels.
    diffuse
        (n,) pixels that may be used; both of a pair must be.
    """
    usable = neighbors[diffuse[neighbors].all(axis=1)]
    if not len(usable):
        return PigmentGradients(usable, np.zeros(0, dtype=bool))
    melanin = np.abs(pigments.melanin[usable[:, 1]] - pigments.melanin[usable[:, 0]])
    hemoglobin = np.abs(pigments.hemoglobin[usable[:, 1]] - pigments.hemoglobin[usable[:, 0]])
    limits = [settings.gradient_low, settings.gradient_high]
    low_melanin, high_melanin = np.quantile(melanin, limits)
    low_hemoglobin, high_hemoglobin = np.quantile(hemoglobin, limits)
    melanin_only = (melanin > high_melanin) & (hemoglobin < low_hemoglobin)
    hemoglobin_only = (melanin < low_melanin) & (hemoglobin > high_hemoglobin)
    chosen = melanin_only | hemoglobin_only
    return PigmentGradients(usable[chosen], melanin_only[chosen])
