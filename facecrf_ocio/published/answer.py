"""What a published estimator may answer when it is shown a photo."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from facecrf_ocio.published.solve import Weighted
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import PublishedSettings
from facecrf_ocio.values import Face, Float, Lacking, Photo


@dataclass(frozen=True, slots=True, eq=False)
class EnergyTerms:
    """Terms of an objective over curves, still to be minimized together with the prior.

    Attributes
    ----------
    terms
        Energy terms with their weights; those of the prior are not among them.
    encoded
        (N, 3) encoded values that the terms rest on.
    summary
        What was found, in one sentence.
    faces
        The faces used, if any.
    """

    terms: tuple[Weighted, ...]
    encoded: Float
    summary: str
    faces: tuple[Face, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class FittedCurve:
    """Curves from a method that has its own parametrization and solver.

    Attributes
    ----------
    samples
        (3, K) on the response model's grid.
    encoded, summary
        As in `EnergyTerms`.
    """

    samples: Float
    encoded: Float
    summary: str


Answer = EnergyTerms | FittedCurve | Lacking
PublishedEstimator = Callable[[Photo, ResponseModel, PublishedSettings], Answer]
