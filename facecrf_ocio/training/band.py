"""How much too narrow the posterior is, on heads and responses that weights never saw."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from facecrf_ocio.benchmark.folds import assign_folds
from facecrf_ocio.benchmark.joint_folds import FOLDS, held_out_joint
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.joint import JointModel, PhotoEvidence, conclude
from facecrf_ocio.joint.statistics import counted_statistics
from facecrf_ocio.response.coverage import COVERAGE_BINS
from facecrf_ocio.training.before_camera import read_head, read_surroundings
from facecrf_ocio.training.curves import NO_ROW, Draw, fold_of_rows
from facecrf_ocio.training.plan import STACKS, Data
from facecrf_ocio.training.simulate import Example, simulate
from facecrf_ocio.values import Float

COVERED = 0.9  # share of all codes: bands are told as 90 % bands everywhere
_NORMAL = 1.645  # deviations within which nine of ten normal errors lie
_HEAPS, _HEAPS_SEED = 8, 99  # others than those of training
_INSIDE = slice(32, -32)  # of 4096 codes: the ends are known


def measure_band(data: Data, held_out: Path, photos: int, seed: int) -> tuple[float, Float]:
    """Factor on the deviation with which 90 % bands cover 90 % of all codes, and all distances.

    Photos of the heads `dev_*` through responses, each judged by the weights without its response.

    Returns
    -------
    scale, distances
        And (N,) of each photo, the deviations within which 90 % of its codes lie.
    """
    cv2.setNumThreads(1)
    heads = [read_head(path, noisy=False) for path in data.development_heads()]
    around = read_surroundings(data.validation_scenes(), _HEAPS, _HEAPS_SEED)
    names = _Names(data)
    found = []
    for example in simulate(heads, around, data.curves(), photos, [seed]):
        if example.drawn.row != NO_ROW:
            model = held_out_joint(held_out, names.of(example.drawn))
            found.append(_distances(example, model))
    every = np.concatenate(found)
    scale = float(np.quantile(every, COVERED)) / _NORMAL
    return scale, np.array([np.quantile(one, COVERED) for one in found])


class _Names:
    """Which weights have not seen a response."""

    def __init__(self, data: Data) -> None:
        self._film = fold_of_rows(len(data.curves().dorf))
        self._published = assign_folds(read_responses(data.modern), FOLDS)

    def of(self, drawn: Draw) -> str:
        if drawn.family == 0:
            return f"dorf{self._film[drawn.row]}"
        if drawn.row >= len(self._published):
            return STACKS
        return f"modern{self._published[drawn.row]}"


def _distances(example: Example, model: JointModel) -> Float:
    """Absolute errors at all codes, in deviations of the posterior as it is."""
    by_cue = {**counted_statistics(example.photo, example.skin), **example.of_face}
    evidence = PhotoEvidence(
        model.networks.messages(by_cue),
        np.ones((3, COVERAGE_BINS)),
        stretch=model.networks.stretch(by_cue),
    )
    found = conclude([evidence], "auto", model)
    if found.confidence is None:
        return np.empty(0)
    truth = np.interp(found.curve.encoded, np.linspace(0.0, 1.0, 1024), example.drawn.inverse)
    deviation = np.maximum(found.confidence.sigma[0] / model.band_scale, 1e-6)
    return np.asarray((np.abs(found.curve.linear[0] - truth) / deviation)[_INSIDE])
