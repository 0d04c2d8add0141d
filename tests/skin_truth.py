"""Synthetic faces as the cue sees them, beside the truth on the same grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np

from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.geometry import FaceGeometry
from facecrf_ocio.face.view import FaceView, cut_face
from facecrf_ocio.published.energy.pigment import PigmentPairs, SkinPigment
from facecrf_ocio.published.face_estimator import AnalyzedFace, analyze_face, pigment_pairs
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import (
    SyntheticFace,
    SyntheticSpec,
    gamma_curve,
    photograph,
    render_face,
)
from facecrf_ocio.values import Face

SETTINGS = Settings()
SIZE = 1024
GRID = np.linspace(0.0, 1.0, SIZE)

# Ideal skin (the paper's model holds exactly) of several people, poses and tones.
SPECS = tuple(
    SyntheticSpec(seed=seed, yaw=yaw, tone=tone, ideal=True)
    for seed, (yaw, tone) in enumerate(
        [(0.0, 0.2), (20.0, 0.5), (-15.0, 0.3), (10.0, 0.8), (5.0, 0.0), (-8.0, 0.6)]
    )
)


@dataclass(frozen=True)
class Seen:
    """One analyzed face and the truth at the pixels of its working grid.

    `melanin`, `hemoglobin`, `skin` (share of each pixel) and `normals` have the shape of
    `analyzed.view.encoded`.
    """

    truth: SyntheticFace
    analyzed: AnalyzedFace
    melanin: np.ndarray
    hemoglobin: np.ndarray
    skin: np.ndarray
    normals: np.ndarray

    def at_skin(self, image: np.ndarray) -> np.ndarray:
        return image[self.analyzed.mask.skin]

    def single_pigment_share(self) -> float:
        """Share of the pairs in which the own pigment truly changes over 3 times the other."""
        gradients = self.analyzed.gradients
        p, q = gradients.pairs.T
        melanin, hemoglobin = (
            np.abs(self.at_skin(density)[q] - self.at_skin(density)[p])
            for density in (self.melanin, self.hemoglobin)
        )
        return float(
            np.where(
                gradients.is_melanin, melanin > 3 * hemoglobin, hemoglobin > 3 * melanin
            ).mean()
        )

    def direction_errors(self) -> np.ndarray:
        """(2,) degrees between found and true pigment directions, melanin first."""
        cosine = (unit(self.truth.directions) * self.analyzed.pigments.directions).sum(axis=1)
        return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


@cache
def see(spec: SyntheticSpec, exponent: float = 2.2, bits: int = 8) -> Seen:
    """Photograph a face, detect it, analyze it, and carry the truth to its grid."""
    truth = render_face(spec)
    photo = photograph(truth, gamma_curve(exponent), bits)
    (face,) = find_faces(photo.encoded, SETTINGS).faces
    view = cut_face(photo, face, SETTINGS)
    analyzed = analyze_face(view, SETTINGS)
    assert analyzed is not None
    return Seen(truth, analyzed, *(_onto(view, image) for image in _truths(truth)))


def see_with_true_geometry(truth: SyntheticFace, exponent: float = 2.2, bits: int = 16) -> Seen:
    """The same with the true normals and bare skin, at the size of the photo."""
    photo = photograph(truth, gamma_curve(exponent), bits)
    facing = np.nan_to_num(truth.normals[..., 2]) > 0.25
    geometry = FaceGeometry(
        np.zeros((1, 3)), np.zeros((1, 3), np.int32), truth.normals, truth.skin & facing
    )
    view = FaceView(
        Face(np.zeros(4), np.zeros((478, 3)), 1.0), photo.encoded, geometry, photo.encoded
    )
    analyzed = analyze_face(view, SETTINGS)
    assert analyzed is not None
    return Seen(truth, analyzed, *_truths(truth))


def pigment_energy(
    analyzed: AnalyzedFace, samples: np.ndarray, *, shaded: bool = True, first_order: bool = False
) -> float:
    """E_p at curves (3, K); `shaded=False` for `dD/D = 0`, `first_order=True` for eq. 15."""
    term = SkinPigment(gathered(analyzed, shaded=shaded), samples.shape[1], first_order=first_order)
    return term.value_and_gradient(samples)[0]


@cache
def gathered(analyzed: AnalyzedFace, *, shaded: bool) -> PigmentPairs:
    return pigment_pairs(analyzed, shaded=shaded)


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _truths(truth: SyntheticFace) -> tuple[np.ndarray, ...]:
    return truth.melanin, truth.hemoglobin, truth.skin.astype(np.float32), truth.normals


def _onto(view: FaceView, image: np.ndarray) -> np.ndarray:
    """The same cut and scale as `cut_face`, found from the mesh it laid over the cut."""
    first, last = view.geometry.vertices[[0, 10], :2], view.face.landmarks_xyz[[0, 10], :2]
    scale = np.linalg.norm(first[1] - first[0]) / np.linalg.norm(last[1] - last[0])
    left, top = np.rint(last[0] - first[0] / scale).astype(int)
    height, width = view.encoded.shape[:2]
    cut = np.nan_to_num(image)[
        top : top + round(height / scale), left : left + round(width / scale)
    ]
    return cv2.resize(
        np.ascontiguousarray(cut, dtype=np.float32), (width, height), interpolation=cv2.INTER_AREA
    )
