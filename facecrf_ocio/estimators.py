"""The estimators: one row each, which with its own file is all that a new one needs.

A row names its function by its place, as entry points do, so that the command can list the
estimators without importing what they need.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Estimator:
    """One estimator.

    Attributes
    ----------
    name
        What users call it by.
    does
        What it looks at; with the name at most 46 characters, which a terminal's line has left for
        the help of `--estimator`.
    explained
        What it rests on, as `facecrf explain estimators` tells it.
    function
        `module:name` of what it does, a `published.answer.PublishedEstimator` or a
        `response.fixed.FixedCurve`; empty for `joint`, which `calibrate` follows itself.
    reasons
        What is known of how far to trust it, in sentences that stand in every estimate.
    band_scale
        Factor on the prior's standard deviation that makes its band: its mean error on the rendered
        development heads over that of the mean curve, where that is larger than the prior's spread
        allows for.
    needs_face
        Whether a photo without a face tells it nothing.
    """

    name: str
    does: str
    explained: str
    function: str = ""
    reasons: tuple[str, ...] = ()
    band_scale: float = 1.0
    needs_face: bool = False

    def load(self) -> Callable[..., Any]:
        """Import the function."""
        return pkgutil.resolve_name(f"facecrf_ocio.{self.function}")  # type: ignore[no-any-return]


_NO_EXPONENT = (
    "the exponent of the curve rests on the prior: the estimator does not see it",
    "on test faces the estimator was seldom nearer to the truth than the mean curve",
)
_FAR_OFF = ("on test faces the estimator was two to three times as far off as the mean curve",)

# The default, followed in `calibrate.py`.
JOINT = (
    Estimator(
        "auto",
        "joint, or a refusal without evidence",
        "recommended: `joint`, but a photo without a face is refused",
        needs_face=True,
    ),
    Estimator(
        "joint",
        "every cue of a face against the prior",
        "every cue of the photo, weighed against a prior of film and digital responses",
        needs_face=True,
    ),
)

# The paper's method and its rivals.
PUBLISHED = (
    Estimator(
        "face",
        "the paper's method: pigments of skin",
        "the paper's method: skin's pigments, shading removed with the face's geometry",
        "published.face_estimator:face_answer",
        _NO_EXPONENT,
        needs_face=True,
    ),
    Estimator(
        "face-unshaded",
        "the same, shading ignored",
        "the paper's variant that takes shading for constant between neighbors",
        "published.face_estimator:face_unshaded_answer",
        _NO_EXPONENT,
        needs_face=True,
    ),
    Estimator(
        "edge",
        "color blends at edges (EdgeCRF)",
        "colors that blend across an edge lie on a line in linear light; needs no face",
        "published.edge:edge_answer",
        _FAR_OFF,
        band_scale=2.3,
    ),
    Estimator(
        "geometry-invariant",
        "planes of light (GICRF)",
        "second derivatives where light is a plane; needs smooth ramps",
        "published.geometry_invariant:geometry_invariant_answer",
        ("noisy test faces showed this estimator too little for a measurement of its error",),
    ),
    Estimator(
        "intensity-similarity",
        "noise of flats (ISCRF)",
        "noise of uniform regions is symmetric in linear light",
        "published.intensity_similarity:intensity_similarity_answer",
        ("on test faces the estimator was as far off as the mean curve",),
    ),
    Estimator(
        "rank",
        "color blends at edges (RankCRF)",
        "blends of two colors have low rank in linear light; needs no face",
        "published.rank:rank_answer",
        _FAR_OFF,
        band_scale=3.3,
    ),
)

# Curves that do not look at the photo: what every estimate must beat.
FIXED = (
    Estimator(
        "mean",
        "fixed, the mean of film responses",
        "what cameras do on average, without looking at the photo",
        "response.fixed:mean_curve",
    ),
    Estimator(
        "srgb",
        "fixed, sRGB decoding",
        "the standard's curve, without looking at the photo",
        "response.fixed:srgb_curve",
    ),
    Estimator(
        "gamma22",
        "fixed, a power of 2.2",
        "a power of 2.2, without looking at the photo",
        "response.fixed:gamma22_curve",
    ),
    Estimator(
        "identity",
        "fixed, no change",
        "the code values as they are",
        "response.fixed:identity_curve",
    ),
)

ESTIMATORS = {row.name: row for row in (*JOINT, *PUBLISHED, *FIXED)}

ESTIMATOR_NAMES = tuple(ESTIMATORS)
JOINT_NAMES = tuple(row.name for row in JOINT)
FIXED_CURVES = tuple(row.name for row in FIXED)
FALLBACKS = ("none", "mean", "srgb")
