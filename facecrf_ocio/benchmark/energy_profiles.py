"""What the paper's figures show, computed: energy profiles, and curves beside the truth."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.errors import NotCalibratedError
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.view import cut_face
from facecrf_ocio.published.energy.empirical import Empirical
from facecrf_ocio.published.energy.monotonicity import Monotonicity
from facecrf_ocio.published.energy.pigment import SkinPigment
from facecrf_ocio.published.face_estimator import AnalyzedFace, analyze_face, pigment_pairs
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import SyntheticFace, SyntheticSpec, encode, gamma_curve, render_face
from facecrf_ocio.values import Estimate, Float, Photo

BITS = 16
"""Of the photos of the energy profiles, which in the paper are not rounded to 8 bits."""


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """E_p over candidate curves, for photos that differ in one thing.

    Attributes
    ----------
    photos
        (P,) what differs: the encoding gamma, or the strength of the highlights.
    candidates
        (C,) gamma of the candidates.
    truth
        (P,) the candidate that is right.
    pigment, printed, total
        (C, P) E_p of exact log ratios, E_p of the first-order ratios that eq. 15 prints, and E of
        eq. 22 with the exact one; NaN where the photo gave no evidence.
    """

    photos: Float
    candidates: Float
    truth: Float
    pigment: Float
    printed: Float
    total: Float


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """One photo, its true inverse response (3, K) on a uniform grid, and every estimate of it."""

    name: str
    photo: Photo
    truth: Float
    estimates: tuple[Estimate, ...]


def gamma_profile(model: ResponseModel, settings: Settings, count: int = 15) -> Profile:
    """Fig. 2: I = R^gamma of an ideal synthetic face, against candidates g = I^(1 / gamma)."""
    face = render_face(SyntheticSpec(seed=1, ideal=True))
    gammas = np.linspace(0.3, 1.0, count)
    photos = [_photo(face.linear, 1.0 / gamma) for gamma in gammas]
    return _profile(photos, gammas, gammas, gammas, 1.0 / gammas, model, settings)


def highlight_profile(model: ResponseModel, settings: Settings, count: int = 11) -> Profile:
    """Fig. 3: R_d + alpha (R - R_d) through gamma 1 / 2.2, against g = I^gamma."""
    face = render_face(SyntheticSpec(seed=1, full_well=0.0))
    strengths = np.linspace(0.0, 1.0, count)
    diffuse = face.albedo * face.shading
    photos = [_photo(diffuse + a * face.specular, 2.2) for a in strengths]
    candidates = np.linspace(1.0, 3.0, 21)
    truth = np.full(count, 2.2)
    return _profile(photos, strengths, candidates, truth, candidates, model, settings)


def analyzed_example(settings: Settings) -> tuple[SyntheticFace, AnalyzedFace]:
    """Fig. 4: a synthetic face with highlights and noise, through gamma 1 / 2.2, in 8 bits."""
    face = render_face(SyntheticSpec(seed=1))
    photo = Photo(encode(face.linear, gamma_curve(2.2)), bit_depth=8)
    analyzed = _analyzed(photo, settings)
    if analyzed is None:
        raise NotCalibratedError("no face found on the synthetic portrait; please report this")
    return face, analyzed


def compare(
    name: str,
    photo: Photo,
    truth: Float,
    estimators: Iterable[str],
    settings: Settings,
) -> Comparison:
    """Fig. 7 and 8: every estimator, as it ships, on one photo of which the response is known."""
    estimates = tuple(
        replace(calibrate(photo, estimator=e, settings=settings), estimator=e) for e in estimators
    )
    return Comparison(name, photo, truth, estimates)


def _photo(linear: Float, exponent: float) -> Photo:
    return Photo(encode(np.clip(linear, 0, 1), gamma_curve(exponent), BITS), bit_depth=BITS)


def _analyzed(photo: Photo, settings: Settings) -> AnalyzedFace | None:
    found = find_faces(photo.encoded, settings)
    if not found.faces:
        return None
    return analyze_face(cut_face(photo, found.faces[0], settings), settings)


def _profile(
    photos: list[Photo],
    places: Float,
    candidates: Float,
    truth: Float,
    exponents: Float,
    model: ResponseModel,
    settings: Settings,
) -> Profile:
    pigment = np.full((candidates.size, len(photos)), np.nan)
    printed = np.full_like(pigment, np.nan)
    prior = np.empty(candidates.size)
    curves = [np.tile(model.grid**exponent, (3, 1)) for exponent in exponents]
    terms = Empirical(model), Monotonicity()
    for row, curve in enumerate(curves):
        empirical, falling = (term.value_and_gradient(curve)[0] for term in terms)
        prior[row] = empirical + settings.monotonicity_weight * falling
    for column, photo in enumerate(photos):
        analyzed = _analyzed(photo, settings)
        if analyzed is None or len(set(analyzed.gradients.is_melanin.tolist())) < 2:
            continue
        pairs = pigment_pairs(analyzed, shaded=True)
        exact = SkinPigment(pairs, model.grid.size, balanced=settings.balance_channels)
        first = SkinPigment(pairs, model.grid.size, first_order=True)
        pigment[:, column] = [exact.value_and_gradient(curve)[0] for curve in curves]
        printed[:, column] = [first.value_and_gradient(curve)[0] for curve in curves]
    total = settings.pigment_weight * pigment + prior[:, None]
    return Profile(places, candidates, truth, pigment, printed, total)
