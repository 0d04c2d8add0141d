"""Numbers and files that the shipped weights were made with, and what the bench holds out."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from facecrf_ocio.benchmark.chart_cameras import CHART_CAMERAS
from facecrf_ocio.benchmark.folds import assign_folds
from facecrf_ocio.benchmark.joint_folds import FOLDS
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.training.curves import CurveSource, read_curves, rows_outside
from facecrf_ocio.training.parts import Examples

PARTS = 288  # of 72 photos; twice as many examples lowered the error by two or three hundredths
PARTS_FROM_CAMERAS = 208  # the first ones; those of the others are hardly processed
SEED = 1  # any; the band is measured with another
EPOCHS = 14  # 1,400 steps; more passes lowered the error of no photo but those trained on
MEMBERS = 2  # networks a cue, which are averaged; a third takes 1 % of the error, and 250 kB
AGREEMENT = 0.5  # weight of how far estimates of two versions of a portrait are apart
LIKELY_TRUTHS = 0.5  # weight of what estimates of portraits are worth for truths like cameras'
PORTRAITS_SEED = 4  # any; of the known curves that portraits are sent through
WRONG_SEED = 1  # any; of what is made of portraits that are made wrong
HELD_OUT_MEMBERS = 1  # the bench needs twenty, each fitted anew
BAND_PHOTOS = 600  # that the band is measured with: 50 of each head `dev_*`
BAND_SEED = 2  # any but that of training
_FILES = ("dorf", "modern", "stacks", "charts")  # as `benchmark.joint_folds` names them
_DORF_ROWS = 201  # responses in Columbia's file
_VALIDATION_SCENES = 3  # the first pictures of surroundings are kept for looking at the results


@dataclass(frozen=True, slots=True)
class Data:
    """Where the data are.

    Attributes
    ----------
    root
        Folder with `crf`, `faces/rendered/img` and `scenes`.
    charts
        Responses measured by charts.
    """

    root: Path
    charts: Path = CHART_CAMERAS

    @property
    def dorf(self) -> Path:
        """Columbia's responses."""
        return self.root / "crf" / "dorf_201_curves.mat"

    @property
    def digital(self) -> dict[str, Path]:
        """Responses of digital cameras: published, solved from exposure stacks, by charts."""
        folder = self.root / "crf"
        published, solved = folder / "modern_dev.npz", folder / "modern_stacks.npz"
        return {"modern": published, "stacks": solved, "charts": self.charts}

    def heads(self) -> list[Path]:
        """Rendered heads to train with; those named `dev_*` are for validation."""
        return sorted((self.root / "faces" / "rendered" / "img").glob("train_*_noisy.exr"))

    def development_heads(self) -> list[Path]:
        """Rendered heads that weights never see."""
        return sorted((self.root / "faces" / "rendered" / "img").glob("dev_*_clean.exr"))

    def validation_scenes(self) -> list[Path]:
        """Real linear pictures that are in no photo of the training."""
        return sorted((self.root / "scenes").glob("*.png"))[:_VALIDATION_SCENES]

    def scenes(self) -> list[Path]:
        """Real linear pictures around them."""
        return sorted((self.root / "scenes").glob("*.png"))[_VALIDATION_SCENES:]

    def digests(self) -> dict[str, str]:
        """SHA-256 of each file of responses, and of all heads and of all scenes together."""
        groups = {path.name: [path] for path in (self.dorf, *self.digital.values())}
        groups |= {"heads": self.heads(), "scenes": self.scenes()}
        return {
            name: hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()
            for name, paths in groups.items()
        }

    def curves(self) -> CurveSource:
        """All responses, the digital ones in the order of `digital`."""
        return read_curves(self.dorf, *self.digital.values())


def held_out_names() -> tuple[str, ...]:
    """Of the weights that the bench needs."""
    return tuple(f"{file}{fold}" for file in _FILES for fold in range(FOLDS))


def left_out(name: str, examples: Examples, data: Data) -> npt.NDArray[np.bool_]:
    """Which examples hold a response, alone or mixed, that weights of this name must not see.

    A maker is held out of all files of digital cameras.
    """
    if name.startswith("dorf"):
        rows = np.flatnonzero(~rows_outside(int(name[4:]), _DORF_ROWS))
        family = 0
    else:
        rows, family = _modern_rows(name, data), 1
    touched = np.isin(examples.row, rows) | np.isin(examples.mixed_with, rows)
    return np.asarray((examples.family == family) & touched)


def makers_left_out(name: str, data: Data) -> tuple[str, ...]:
    """Makers whose responses weights of this name must not see."""
    file, fold = name[:-1], int(name[-1])
    if file == "dorf":
        return ()
    responses = read_responses(data.digital[file])
    of_fold = np.array(responses.families)[assign_folds(responses, FOLDS) == fold]
    return tuple(sorted(set(of_fold.tolist())))


@cache
def _modern_rows(name: str, data: Data) -> npt.NDArray[np.intp]:
    return np.flatnonzero(np.isin(data.curves().maker, makers_left_out(name, data)))
