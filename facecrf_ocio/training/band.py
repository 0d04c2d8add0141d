"""What the posterior says of its error, against heads and responses that weights never saw."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np

from facecrf_ocio.benchmark.folds import assign_folds
from facecrf_ocio.benchmark.joint_folds import FOLDS, held_out_joint
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.joint import JointModel, PhotoEvidence, conclude
from facecrf_ocio.joint.conclusion import families_of
from facecrf_ocio.joint.prior import FAMILIES
from facecrf_ocio.joint.statistics import counted_statistics
from facecrf_ocio.response.coverage import COVERAGE_BINS
from facecrf_ocio.response.stops import NINETY_PERCENT, stops_error, uniform
from facecrf_ocio.training.before_camera import read_head, read_surroundings
from facecrf_ocio.training.curves import Draw, fold_of_rows
from facecrf_ocio.training.plan import Data
from facecrf_ocio.training.simulate import Example, simulate
from facecrf_ocio.values import Confidence, Float, InverseCRF

COVERED = 0.9  # share of all codes: bands are told as 90 % bands everywhere
_HEAPS, _HEAPS_SEED = 8, 99  # others than those of training
_INSIDE = slice(32, -32)  # of 4096 codes: the ends are known


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """How far what the posterior says of itself is from what is true.

    Attributes
    ----------
    band_scale
        Factor on the deviation with which 90 % bands cover 90 % of all codes.
    stops_scale
        (F, 2) mean error in stops over the mean expected one, with that factor: over codes 64 to
        235, and 16 to 64; each photo counts by the share of a family in its posterior.
    of_photos
        (N,) deviations within which 90 % of each photo's codes lie.
    """

    band_scale: float
    stops_scale: Float
    of_photos: Float


def measure_band(data: Data, held_out: Path, photos: int, seed: int) -> Measured:
    """Measure on the heads `dev_*`, each response by the weights that never saw it.

    Responses are measured ones, none between them: those that training invents beside them are
    stranger than any camera's.
    """
    cv2.setNumThreads(1)
    heads = [read_head(path, noisy=False) for path in data.development_heads()]
    around = read_surroundings(data.validation_scenes(), _HEAPS, _HEAPS_SEED)
    names = _Names(data)
    taken = [
        _Taken(_evidence(example, model), model, example.drawn.inverse)
        for example in simulate(heads, around, data.curves(), photos, [seed], measured=1.0)
        for model in [held_out_joint(held_out, names.of(example.drawn))]
    ]
    found = [photo.distances() for photo in taken]
    scale = float(np.quantile(np.concatenate(found), COVERED)) / NINETY_PERCENT
    errors = np.array([photo.errors(scale) for photo in taken])
    families = np.array([photo.families() for photo in taken])
    distances = np.array([np.quantile(one, COVERED) for one in found])
    return Measured(scale, _scales(errors[:, 0], errors[:, 1], families), distances)


def _scales(errors: Float, expected: Float, families: Float) -> Float:
    """(F, M) mean of errors (N, M) over that of expected ones, by each family's shares (N, F)."""
    return np.asarray((families.T @ errors) / (families.T @ expected))


class _Names:
    """Which weights have not seen a response."""

    def __init__(self, data: Data) -> None:
        self._film = fold_of_rows(len(data.curves().dorf))
        self._digital = [
            f"{file}{fold}"
            for file, path in data.digital.items()
            for fold in assign_folds(read_responses(path), FOLDS)
        ]

    def of(self, drawn: Draw) -> str:
        if drawn.family == 0:
            return f"dorf{self._film[drawn.row]}"
        return self._digital[drawn.row]


@dataclass(frozen=True, slots=True, eq=False)
class _Taken:
    """One photo, the weights without its response, and that."""

    evidence: PhotoEvidence
    model: JointModel
    inverse: Float

    def distances(self) -> Float:
        """Absolute errors at all codes, in deviations of the posterior as it is."""
        curve, confidence = self._concluded(1.0)
        truth = np.interp(curve.encoded, np.linspace(0.0, 1.0, self.inverse.size), self.inverse)
        deviation = np.maximum(confidence.sigma[0], 1e-6)
        return np.asarray((np.abs(curve.linear[0] - truth) / deviation)[_INSIDE])

    def errors(self, band_scale: float) -> Float:
        """(2, 2) errors in stops and the expected ones, over the tones and over the shadows."""
        curve, confidence = self._concluded(band_scale)
        true = stops_error(uniform(curve)[0], self.inverse)
        told = confidence.in_stops
        assert told is not None  # noqa: S101 - `joint` always tells it
        return np.array([[true.mid, true.shadows], [told.mid, told.shadows]])

    def families(self) -> Float:
        """(F,) shares of the families in the posterior."""
        return families_of(self.evidence, self.model)

    def _concluded(self, band_scale: float) -> tuple[InverseCRF, Confidence]:
        model = replace(self.model, band_scale=band_scale, stops_scale=np.ones((len(FAMILIES), 2)))
        found = conclude([self.evidence], "auto", model)
        assert found.confidence is not None  # noqa: S101 - `joint` always tells it
        return found.curve, found.confidence


def _evidence(example: Example, model: JointModel) -> PhotoEvidence:
    by_cue = {**counted_statistics(example.photo, example.skin), **example.of_face}
    return PhotoEvidence(
        model.networks.messages(by_cue),
        np.ones((3, COVERAGE_BINS)),
        stretch=model.networks.stretch(by_cue),
    )
