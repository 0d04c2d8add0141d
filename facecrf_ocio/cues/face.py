"""The face cue: from a photo to its single-pigment pairs, with or without shading (sec. 4-5)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np
import numpy.typing as npt
import scipy

from facecrf_ocio.cues.evidence import Answer, Cue, Evidence, Lacking
from facecrf_ocio.energy.pigment import PigmentEvidence, SkinPigment
from facecrf_ocio.face.detect import FoundFaces, find_faces
from facecrf_ocio.face.geometry import face_geometry
from facecrf_ocio.pixels import in_8_bits
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.settings import Settings
from facecrf_ocio.skin.gradients import single_pigment_pairs
from facecrf_ocio.skin.intrinsic import Decomposition, prepare_decomposition
from facecrf_ocio.skin.mask import SkinMask, find_skin
from facecrf_ocio.skin.pigments import separate_pigments
from facecrf_ocio.solve import Weighted
from facecrf_ocio.values import Face, FaceGeometry, Float, Photo, PigmentGradients, Pigments

NODE_SPACING = 1.0 / 255.0
MIN_SKIN_PIXELS = 400


@dataclass(frozen=True, slots=True, eq=False)
class FaceView:
    """One face cut out of the photo and scaled to the working size.

    Attributes
    ----------
    face
        As detected, in photo pixels.
    encoded
        (H, W, 3) float32 in [0, 1].
    geometry
        The mesh on this grid.
    native
        (h, w, 3) float32, the same cut as stored in the photo.
    """

    face: Face
    encoded: npt.NDArray[np.float32]
    geometry: FaceGeometry
    native: npt.NDArray[np.float32]


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


def face_cue(*, shaded: bool) -> Cue:
    """The estimators `face` (shaded) and `face-unshaded` (`dD/D = 0`)."""
    return partial(_gather, shaded=shaded)


def _gather(photo: Photo, model: ResponseModel, settings: Settings, *, shaded: bool) -> Answer:
    if photo.grayscale and photo.encoded.min() == photo.encoded.max():
        return Lacking("all pixels have one color", "use a photo with a face")
    if photo.grayscale:
        return Lacking(
            "the photo is grayscale, and pigments show only in color",
            "use a color version, or --fallback mean",
        )
    found = find_faces(photo.encoded, settings)
    if not found.faces:
        return lacking_faces(found, settings)
    analyzed = [analyze_face(cut_face(photo, face, settings), settings) for face in found.faces]
    usable = [face for face in analyzed if face is not None]
    evidence = [pigment_evidence(face, shaded=shaded) for face in usable]
    joined = _join(evidence)
    counts = [int(joined.is_melanin.sum()), int((~joined.is_melanin).sum())] if joined else [0, 0]
    if joined is None or min(counts) < settings.min_pairs:
        return Lacking(
            f"the skin shows too few single-pigment changes ({counts[0]} of melanin and "
            f"{counts[1]} of hemoglobin, {settings.min_pairs} of each are needed)",
            "use a larger, evenly lit, unretouched face, or --fallback mean",
        )
    return Evidence(
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
        summary=f"{_faces(len(usable))}, {counts[0]} melanin and {counts[1]} hemoglobin pairs",
        faces=tuple(face.view.face for face in usable),
    )


def cut_face(photo: Photo, face: Face, settings: Settings, *, to_8_bits: bool = False) -> FaceView:
    """Cut a face out, scale it down to the working size, and lay its mesh over it.

    With `to_8_bits` it is rounded to 8 bits before it is scaled; `native` is not.
    """
    height, width = photo.encoded.shape[:2]
    points = face.landmarks_xyz[:, :2]
    margin = 0.05 * face.box_xy[2]
    left, top = np.maximum(np.floor(points.min(axis=0) - margin), 0).astype(int)
    right, bottom = np.ceil(points.max(axis=0) + margin).astype(int)
    cut = photo.encoded[top : min(bottom, height), left : min(right, width)]
    face_width = float(np.ptp(points[:, 0]))
    scale = min(1.0, settings.face_width / face_width)
    size = (max(1, round(cut.shape[1] * scale)), max(1, round(cut.shape[0] * scale)))
    # Channel by channel: a large face, rounded, would be a tenth of what a worker may take.
    encoded = cv2.merge([_scaled(cut[..., c], size, to_8_bits=to_8_bits) for c in range(3)])
    geometry = face_geometry(
        face, (size[1], size[0]), origin=(float(left), float(top)), scale=scale
    )
    return FaceView(face, np.asarray(encoded, np.float32), geometry, cut)


def _scaled(
    channel: npt.NDArray[np.float32], size: tuple[int, int], *, to_8_bits: bool
) -> npt.NDArray[np.float32]:
    channel = in_8_bits(channel) if to_8_bits else np.ascontiguousarray(channel)
    if channel.shape == size[::-1]:
        return channel
    return np.asarray(cv2.resize(channel, size, interpolation=cv2.INTER_AREA), np.float32)


def analyze_face(view: FaceView, settings: Settings) -> AnalyzedFace | None:
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


def pigment_evidence(analyzed: AnalyzedFace, *, shaded: bool) -> PigmentEvidence:
    """Reduce a face to what E_p needs: its pairs, and their shading as a map of `log g`."""
    pixels = analyzed.view.encoded[analyzed.mask.skin].astype(np.float64)
    gradients = analyzed.gradients
    encoded = pixels[gradients.pairs].transpose(2, 0, 1)
    nodes = np.arange(0.0, 1.0 + NODE_SPACING / 2, NODE_SPACING)
    if not shaded:
        return PigmentEvidence(encoded, gradients.is_melanin, nodes, None)
    weights = analyzed.decomposition.shading_change_weights(gradients.pairs)
    shading = np.stack([_onto_nodes(weights, pixels[:, c], nodes) for c in range(3)])
    return PigmentEvidence(encoded, gradients.is_melanin, nodes, shading)


def _onto_nodes(weights: Float, encoded: Float, nodes: Float) -> Float:
    """Gather weights (n, N) of pixels on the nodes around their encoded values, (N, J)."""
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


def _join(evidence: list[PigmentEvidence]) -> PigmentEvidence | None:
    """All faces together: one camera, and the same two pigments under the same light."""
    if not evidence:
        return None
    shading = [e.shading for e in evidence if e.shading is not None]
    return PigmentEvidence(
        np.concatenate([e.encoded for e in evidence], axis=1),
        np.concatenate([e.is_melanin for e in evidence]),
        evidence[0].nodes,
        np.concatenate(shading, axis=1) if shading else None,
    )


def _faces(count: int) -> str:
    return "1 face" if count == 1 else f"{count} faces"


def lacking_faces(found: FoundFaces, settings: Settings) -> Lacking:
    """Why no face of a photo can be used."""
    if found.too_small:
        return Lacking(
            f"{_faces(found.too_small)} found, narrower than {settings.min_face_width} px",
            "use a larger version of the photo, or --fallback mean",
        )
    return Lacking("no face found", "use a photo with a face, or --fallback mean")
