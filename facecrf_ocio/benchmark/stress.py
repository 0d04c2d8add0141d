"""`facecrf bench stress`: one set of faces and responses through all that photos go through."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.bench_processes import measure_tasks
from facecrf_ocio.benchmark.cases import common_conditions
from facecrf_ocio.benchmark.conditions import CELLS, Cell, Conditions
from facecrf_ocio.benchmark.folds import assign_folds, fit_held_out
from facecrf_ocio.benchmark.images import LinearImage
from facecrf_ocio.benchmark.joint_folds import FOLDS, joint_model
from facecrf_ocio.benchmark.responses import Responses, spread_rows
from facecrf_ocio.benchmark.store import Store
from facecrf_ocio.benchmark.stress_camera import Image, photograph
from facecrf_ocio.benchmark.stress_tables import stress_files
from facecrf_ocio.benchmark.virtual_camera import count_codes
from facecrf_ocio.benchmark.workbench import Asked, CaseResult, Subject, measure
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.response.model import ResponseModel, dorf_model
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Camera, Photo

ESTIMATORS = ("auto", "mean", "srgb")
# What EXIF says by kind of camera: cameras and phones name themselves, film and webcams do not.
_PHONE = Camera("samsung", "SM-G973F")


@dataclass(frozen=True, slots=True, eq=False)
class StressPlan:
    """What is measured.

    Attributes
    ----------
    title
        Of the table.
    images
        Linear images with faces. Where one's name ends in `_noisy` and a `_clean` one lies beside
        it, conditions with noise of their own take that.
    responses, rows
        Responses, and those of them to choose from.
    cells
        Rows of the table.
    count
        Photos of a cell with the weight 1.
    green
        Whether the green curve stands for all channels.
    seed
        Of choice, noise and draws.
    settings
        Of the estimator.
    """

    title: str
    images: tuple[LinearImage, ...]
    responses: Responses
    rows: tuple[int, ...]
    cells: tuple[Cell, ...] = CELLS
    count: int = 24
    green: bool = False
    seed: int = 0
    settings: Settings = field(default_factory=Settings)

    def tasks(self) -> Iterator[StressTask]:
        """Every photo, in the order of the results: the same pairs in all cells of one size."""
        for cell in self.cells:
            count = max(1, round(self.count * cell.weight))
            chosen = np.array(spread_rows(len(self.rows), limit=count))
            generator = np.random.default_rng([self.seed, count])
            rows = generator.permutation(np.resize(chosen, count))
            images = np.resize(generator.permutation(len(self.images)), count)
            for number in range(count):
                yield StressTask(cell.name, number, int(images[number]), self.rows[rows[number]])

    def keys(self) -> dict[StressTask, str]:
        """For each photo a digest of all that its results depend on."""
        common = json.dumps([*self._common(), self.responses.sha256], sort_keys=True)
        return {
            task: hashlib.sha256(
                json.dumps([common, self.images[task.image].sha256, asdict(task)]).encode()
            ).hexdigest()
            for task in self.tasks()
        }

    def description(self) -> dict[str, object]:
        """Everything needed to repeat the bench."""
        conditions, green, seed, settings = self._common()
        return {
            "title": self.title,
            **conditions,
            "settings": settings,
            "green": green,
            "seed": seed,
            "count": self.count,
            "cells": [cell.name for cell in self.cells],
            "images": {image.name: image.sha256 for image in self.images},
            "responses": {
                "file": self.responses.path.name,
                "sha256": self.responses.sha256,
                "rows": list(self.rows),
            },
        }

    def _common(self) -> tuple[dict[str, object], bool, int, dict[str, object]]:
        return common_conditions(), self.green, self.seed, asdict(self.settings)


@dataclass(frozen=True, slots=True)
class StressTask:
    """One photo: its cell, its number there, index of the image, row of the response."""

    cell: str
    number: int
    image: int
    row: int


class StressBench:
    """Takes the photos of a plan and shows them to the estimators."""

    def __init__(self, plan: StressPlan) -> None:
        self._plan = plan
        self._cells = {cell.name: cell for cell in plan.cells}
        self._fold_of = assign_folds(plan.responses, FOLDS)
        self._read = lru_cache(maxsize=32)(_read)
        self._prior = lru_cache(maxsize=None)(self._fit)
        inverse = plan.responses.inverse
        self._truth = np.repeat(inverse[:, 1:2], 3, axis=1) if plan.green else inverse

    def measure(self, task: StressTask) -> tuple[CaseResult, ...]:
        """Results of the default estimator, of the mean curve and of sRGB decoding."""
        photo = self.photograph(task)
        counts, fold = count_codes(photo), int(self._fold_of[task.row])
        responses = self._plan.responses
        subject = Subject.of(
            *(responses, task.row, self._truth[task.row]),
            protocol=task.cell,
            image=self._plan.images[task.image].name,
            fold=fold,
        )
        prior = self._prior(fold)
        models = {"auto": joint_model(responses, fold)}
        return tuple(
            measure(
                subject,
                photo,
                counts,
                Asked(name, self._plan.settings, models.get(name, prior), prior),
            )
            for name in ESTIMATORS
        )

    def photograph(self, task: StressTask) -> Photo:
        """The photo of a task."""
        plan, image = self._plan, self._plan.images[task.image]
        identity = f"{plan.seed} {task.cell} {task.number}".encode()
        seed = int.from_bytes(hashlib.sha256(identity).digest()[:16], "big")
        generator = np.random.default_rng(seed)
        conditions = self._cells[task.cell].draw(generator)
        scene = self._read(_source(image, conditions))
        codes = photograph(scene, self._truth[task.row], conditions, generator)
        encoded = codes.astype(np.float32) / np.float32(255.0)
        return Photo(encoded, 8, camera=_exif(plan.responses, task.row))

    def _fit(self, fold: int) -> ResponseModel:
        """Prior of the mean curve; the shipped one where the file has too few curves for one."""
        try:
            return fit_held_out(self._plan.responses, self._fold_of, fold)
        except SettingsError:
            return dorf_model()


def run_stress(
    plan: StressPlan,
    output: Path,
    *,
    jobs: int = 1,
    progress: Callable[[int, int], None] = lambda *_: None,
) -> tuple[str, tuple[Path, ...]]:
    """Measure what is not measured yet; returns the table and the files written.

    Parameters
    ----------
    plan
        What to measure.
    output
        Folder for `stress.jsonl`, which grows photo by photo and lets a later call go on, and for
        `stress.md`, `stress.csv` and `stress.json`.
    jobs
        Number of processes.
    progress
        Called with the number of finished photos and of all.

    Raises
    ------
    OutputError
        If the folder cannot be written to.
    """
    keys, store = plan.keys(), Store(output / "stress.jsonl", CaseResult)
    missing = [task for task, key in keys.items() if f"{key} srgb" not in store.results]
    done = len(keys) - len(missing)
    progress(done, len(keys))
    by_image = sorted(missing, key=lambda task: (task.image, task.cell, task.number))
    for task, results in measure_tasks(StressBench, plan, by_image, jobs):
        store.append({f"{keys[task]} {result.estimator}": result for result in results})
        done += 1
        progress(done, len(keys))
    ordered = [store.results[f"{key} {name}"] for key in keys.values() for name in ESTIMATORS]
    return stress_files(plan.title, plan.description(), ordered, output)


def choose_cells(names: str) -> tuple[Cell, ...]:
    """Cells by `all` or a list with commas, in the order of the table.

    Raises
    ------
    SettingsError
        If one is not known.
    """
    asked = {name.strip() for name in names.split(",") if name.strip()}
    known = [cell.name for cell in CELLS]
    if not asked or asked - {*known, "all"}:
        unknown = ", ".join(sorted(asked - {*known, "all"})) or "named"
        raise SettingsError(f"no cell {unknown}; known: all, {', '.join(known)}")
    return tuple(cell for cell in CELLS if cell.name in asked or "all" in asked)


def rows_of_kinds(responses: Responses, kinds: str) -> tuple[int, ...]:
    """Rows of a file whose kind is in a list with commas; all for `all`.

    Raises
    ------
    SettingsError
        If there are none.
    """
    asked = {kind.strip() for kind in kinds.split(",") if kind.strip()}
    count = len(responses.inverse)
    rows = tuple(r for r in range(count) if "all" in asked or responses.kind(r) in asked)
    if not rows:
        known = ", ".join(sorted(set(responses.kinds or ()))) or "none"
        raise SettingsError(f"{responses.path}: no response of kind {kinds}; it has: {known}")
    return rows


def _read(path: Path) -> Image:
    return np.maximum(LinearImage(path.name, path, "").read().encoded, 0.0)


def _source(image: LinearImage, conditions: Conditions) -> Path:
    """The scene's file: that without noise where the camera brings its own."""
    stem = image.path.stem
    clean = image.path.with_stem(f"{stem.removesuffix('_noisy')}_clean")
    own_grain = conditions.own_grain and stem.endswith("_noisy")
    return clean if own_grain and clean.is_file() else image.path


def _exif(responses: Responses, row: int) -> Camera:
    kind = responses.kind(row)
    if kind == "phone_isp":
        return _PHONE
    return Camera(responses.family(row), "digital camera") if kind == "camera_jpeg" else Camera()
