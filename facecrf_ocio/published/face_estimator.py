"""The paper's method: from a photo to its single-pigment pairs, shaded or not (sec. 4-5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.no_face import lacking_faces
from facecrf_ocio.face.skin_mask import SkinMask, find_skin
from facecrf_ocio.face.view import MIN_SKIN_PIXELS, FaceView, cut_face
from facecrf_ocio.files.plain_text import counted
from facecrf_ocio.published.answer import Answer, EnergyTerms
from facecrf_ocio.published.energy.pigment import PigmentPairs, SkinPigment
from facecrf_ocio.published.gradients import PigmentGradients, single_pigment_pairs
from facecrf_ocio.published.intrinsic import Decomposition, prepare_decomposition
from facecrf_ocio.published.pigments import Pigments, separate_pigments
from facecrf_ocio.published.solve import Weighted
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import PublishedSettings
from facecrf_ocio.values import (
    Float,
    Lacking,
    Photo,
)

NODE_SPACING = 1.0 / 255.0  # [encoded] of the nodes of `log g`: one 8-bit code


@dataclass(frozen=True, slots=True, eq=False)
class AnalyzedFace:
    """Every intermediate result of one face, in the order in which they are found.

    The skin pixels of `mask.skin`, in row-major order, number the rows of `pigments` and the
    indices of `gradients`.
    """

    view: FaceView
    mask: SkinMask
    decomposition: Decomposition
    pigments: Pigments
    gradients: PigmentGradients


def face_answer(photo: Photo, model: ResponseModel, settings: PublishedSettings) -> Answer:
    """Single-pigment changes of albedo, shading removed; the estimator `face`."""
    return _answer(photo, model, settings, shaded=True)


def face_unshaded_answer(photo: Photo, model: ResponseModel, settings: PublishedSettings) -> Answer:
    """The same without shading, `dD/D = 0`; the estimator `face-unshaded`."""
    return _answer(photo, model, settings, shaded=False)


def _answer(
    photo: Photo, model: ResponseModel, settings: PublishedSettings, *, shaded: bool
) -> Answer:
    if photo.grayscale and photo.encoded.min() == photo.encoded.max():
        return Lacking("all pixels have one color", "use a photo with a face")
    if photo.grayscale:
        return Lacking(
            "the photo is grayscale, and pigments show only in color",
            "use a color version",
        )
    found = find_faces(photo.encoded, settings)
    if not found.faces:
        return lacking_faces(found, settings)
    analyzed = [analyze_face(cut_face(photo, face, settings), settings) for face in found.faces]
    usable = [face for face in analyzed if face is not None]
    joined = _join([pigment_pairs(face, shaded=shaded) for face in usable])
    counts = [int(joined.is_melanin.sum()), int((~joined.is_melanin).sum())] if joined else [0, 0]
    if joined is None or min(counts) < settings.min_pairs:
        return Lacking(
            f"the skin shows too few single-pigment changes ({counts[0]} of melanin and "
            f"{counts[1]} of hemoglobin, {settings.min_pairs} of each are needed)",
            "use a larger, evenly lit, unretouched face",
        )
    return EnergyTerms(
        terms=(
            Weighted(
                "pigment",
                settings.pigment_weight,
                SkinPigment(
                    joined,
                    model.grid.size,
                    first_order=settings.first_order,
                    balanced=settings.balance_channels,
                ),
            ),
        ),
        encoded=joined.encoded.reshape(3, -1).T,
        summary=f"{counted(len(usable), 'face')}, "
        f"{counts[0]} melanin and {counts[1]} hemoglobin pairs",
        faces=tuple(face.view.face for face in usable),
    )


def analyze_face(view: FaceView, settings: PublishedSettings) -> AnalyzedFace | None:
    """From skin mask to single-pigment pairs; None where there is too little skin."""
    mask = find_skin(view.encoded, view.geometry.bare_skin, settings)
    if int(mask.diffuse.sum()) < MIN_SKIN_PIXELS:
        return None
    decomposition = prepare_decomposition(view.encoded, view.geometry.normals, mask.skin, settings)
    log_encoded = np.log(view.encoded[mask.skin].astype(np.float64))
    log_pseudo_albedo = log_encoded - decomposition.shading(log_encoded)
    diffuse = mask.diffuse[mask.skin]
    pigments = separate_pigments(log_pseudo_albedo, diffuse, decomposition.neighbors)
    gradients = single_pigment_pairs(pigments, decomposition.neighbors, diffuse, settings)
    return AnalyzedFace(view, mask, decomposition, pigments, gradients)


def pigment_pairs(analyzed: AnalyzedFace, *, shaded: bool) -> PigmentPairs:
    """Reduce a face to what E_p needs: its pairs, and their shading as a map of `log g`."""
    pixels = analyzed.view.encoded[analyzed.mask.skin].astype(np.float64)
    gradients = analyzed.gradients
    encoded = pixels[gradients.pairs].transpose(2, 0, 1)
    nodes = np.arange(0.0, 1.0 + NODE_SPACING / 2, NODE_SPACING)
    if not shaded:
        return PigmentPairs(encoded, gradients.is_melanin, nodes, None)
    weights = analyzed.decomposition.shading_change_weights(gradients.pairs)
    shading = np.stack([_onto_nodes(weights, pixels[:, c], nodes) for c in range(3)])
    return PigmentPairs(encoded, gradients.is_melanin, nodes, shading)


def _onto_nodes(weights: Float, encoded: Float, nodes: Float) -> Float:
    """Sum weights (n, N) of pixels on the nodes around their encoded values, (N, J)."""
    position = encoded / NODE_SPACING
    lower = np.clip(position.astype(np.intp), 0, nodes.size - 2)
    fraction = position - lower
    pixel = np.arange(len(encoded))
    interpolation = scipy.sparse.csc_matrix(
        (
            np.concatenate([1.0 - fraction, fraction]),
            (np.concatenate([lower, lower + 1]), np.concatenate([pixel, pixel])),
        ),
        shape=(nodes.size, len(encoded)),
    )
    return np.ascontiguousarray((interpolation @ weights).T)


def _join(faces: list[PigmentPairs]) -> PigmentPairs | None:
    """All faces together: one camera, and the same two pigments under the same light."""
    if not faces:
        return None
    shading = [e.shading for e in faces if e.shading is not None]
    return PigmentPairs(
        np.concatenate([e.encoded for e in faces], axis=1),
        np.concatenate([e.is_melanin for e in faces]),
        faces[0].nodes,
        np.concatenate(shading, axis=1) if shading else None,
    )
