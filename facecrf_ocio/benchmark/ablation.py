"""The literal method with some of its steps given their true answer."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from facecrf_ocio.benchmark.truth import KnownFace, onto, unit
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.no_face import lacking_faces
from facecrf_ocio.face.view import FaceView, cut_face
from facecrf_ocio.published.energy.empirical import Empirical
from facecrf_ocio.published.energy.monotonicity import Monotonicity
from facecrf_ocio.published.energy.pigment import PigmentPairs, PullBack, SkinPigment
from facecrf_ocio.published.face_estimator import AnalyzedFace, analyze_face, pigment_pairs
from facecrf_ocio.published.gradients import single_pigment_pairs
from facecrf_ocio.published.pigments import Pigments
from facecrf_ocio.published.solve import Weighted, solve
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import PublishedSettings
from facecrf_ocio.values import Float, InverseCRF, Photo

_WHOLLY_SKIN = 0.99  # of a pixel; what is less is at the edge of the mask
_ANY_HUE = 180.0  # [degree] half of a circle: the true mask is not narrowed by hue


@dataclass(frozen=True, slots=True)
class Ablation:
    """Which steps get their true answer, and lambda_p.

    Attributes
    ----------
    name
        As the table has it.
    mask, normals, pigments, shading
        Skin mask; normals of the decomposition; densities from which the single-pigment pairs are
        chosen; change of shading within the pairs.
    pigment_weight
        lambda_p of eq. 22, None for that of the settings.
    """

    name: str
    mask: bool = False
    normals: bool = False
    pigments: bool = False
    shading: bool = False
    pigment_weight: float | None = None


ABLATIONS = (  # lambda_p in decades on both sides of 3e4, the setting's
    Ablation("full method"),
    Ablation("true mask", mask=True),
    Ablation("true normals", normals=True),
    Ablation("true shading", shading=True),
    Ablation("true pigment map", pigments=True),
    Ablation("all four true", mask=True, normals=True, pigments=True, shading=True),
    *(Ablation(f"lambda_p = {w:g}", pigment_weight=w) for w in (3e1, 3e2, 3e3, 3e5, 3e6)),
)


@dataclass(frozen=True, slots=True, eq=False)
class Ablated:
    """What came of one ablation.

    Attributes
    ----------
    curve
        The estimate.
    pigment_energy
        E_p at the estimate, the true curve, the identity and the prior's mean.
    """

    curve: InverseCRF
    pigment_energy: tuple[float, float, float, float]


class KnownShading(SkinPigment):
    """E_p where the change of log shading within each pair is known instead of estimated."""

    def __init__(self, pairs: PigmentPairs, change: Float, size: int, balanced: bool) -> None:
        super().__init__(pairs, size, balanced=balanced)
        self._change = change

    def _log_ratios(self, samples: Float) -> tuple[Float, PullBack]:
        columns, back, _ = self._formula(samples, self._change)
        return columns, back


def ablate(
    ablation: Ablation,
    known: KnownFace,
    photo: Photo,
    truth: Float,
    model: ResponseModel,
    settings: PublishedSettings,
) -> Ablated | str:
    """Estimate the response of a photo of a known face; or say why that cannot be done.

    Parameters
    ----------
    truth
        (3, 1024) the true inverse response at uniform encoded values.
    """
    found = find_faces(photo.encoded, settings)
    if not found.faces:
        return lacking_faces(found, settings).reason
    view = cut_face(photo, found.faces[0], settings)
    analyzed = _analyze(ablation, known, view, settings)
    if analyzed is None:
        return "too little skin"
    counts = int(analyzed.gradients.is_melanin.sum()), int((~analyzed.gradients.is_melanin).sum())
    if min(counts) < settings.min_pairs:
        return f"too few single-pigment changes ({counts[0]}, {counts[1]})"
    term = _term(ablation, known, analyzed, model, settings)
    weight = settings.pigment_weight
    if ablation.pigment_weight is not None:
        weight = ablation.pigment_weight
    objective = (
        Weighted("empirical", 1.0, Empirical(model)),
        Weighted("monotonicity", settings.monotonicity_weight, Monotonicity()),
        Weighted("pigment", weight, term),
    )
    samples = model.samples(solve(model, objective, shared=settings.shared_curve).coefficients)
    grid = np.linspace(0.0, 1.0, truth.shape[1])
    true = np.array([np.interp(model.grid, grid, row) for row in truth])
    compared = (samples, true, np.tile(model.grid, (3, 1)), np.tile(model.mean, (3, 1)))
    found_, true_, identity, mean = (term.value_and_gradient(curve)[0] for curve in compared)
    return Ablated(model.inverse_crf(samples), (found_, true_, identity, mean))


def _analyze(
    ablation: Ablation, known: KnownFace, view: FaceView, settings: PublishedSettings
) -> AnalyzedFace | None:
    if ablation.mask:
        bare = onto(view, known.skin) > _WHOLLY_SKIN
        inside = np.isfinite(view.geometry.normals).all(axis=2)
        view = replace(view, geometry=replace(view.geometry, bare_skin=bare & inside))
        settings = replace(settings, hue_half_width=_ANY_HUE)
    if ablation.normals:
        true = unit(onto(view, known.normals))
        view = replace(view, geometry=replace(view.geometry, normals=true))
    analyzed = analyze_face(view, settings)
    if analyzed is None or not ablation.pigments:
        return analyzed
    skin = analyzed.mask.skin
    densities = Pigments(
        onto(view, known.melanin)[skin].astype(np.float64),
        onto(view, known.hemoglobin)[skin].astype(np.float64),
        analyzed.pigments.directions,
    )
    gradients = single_pigment_pairs(
        densities, analyzed.decomposition.neighbors, analyzed.mask.diffuse[skin], settings
    )
    return replace(analyzed, pigments=densities, gradients=gradients)


def _term(
    ablation: Ablation,
    known: KnownFace,
    analyzed: AnalyzedFace,
    model: ResponseModel,
    settings: PublishedSettings,
) -> SkinPigment:
    size, balanced = model.grid.size, settings.balance_channels
    if not ablation.shading:
        return SkinPigment(pigment_pairs(analyzed, shaded=True), size, balanced=balanced)
    shading = onto(analyzed.view, known.log_shading)[analyzed.mask.skin].astype(np.float64)
    pairs = analyzed.gradients.pairs
    change = (shading[pairs[:, 1]] - shading[pairs[:, 0]]).T
    return KnownShading(pigment_pairs(analyzed, shaded=False), change, size, balanced)
