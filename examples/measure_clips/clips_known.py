"""The curve of a clip beside those of its frames, and drift that is there."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cache, lru_cache
from pathlib import Path
from time import monotonic

import numpy as np
from clip_tables import ClipResult, clip_files
from virtual_clip import EVEN, STEPS, Take, drifted, take_clip

import facecrf_ocio.clip
from facecrf_ocio.benchmark.cases import code_digest
from facecrf_ocio.benchmark.folds import assign_folds
from facecrf_ocio.benchmark.images import LinearImage
from facecrf_ocio.benchmark.joint_folds import FOLDS, joint_model
from facecrf_ocio.benchmark.metrics import Score, score
from facecrf_ocio.benchmark.responses import Responses, spread_rows
from facecrf_ocio.benchmark.store import Store
from facecrf_ocio.benchmark.virtual_camera import count_codes
from facecrf_ocio.clip.calibrate_clip import calibrate_clip
from facecrf_ocio.clip.clip_estimate import ClipEstimate
from facecrf_ocio.clip.clip_source import open_clip
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model, inverse_crf
from facecrf_ocio.values import CHANNELS, Confidence, Float, InverseCRF

_GREEN = 1  # the channel whose curve stands for all: in measured responses it is the surest
_FRAMES = 6  # that a clip's curve comes from; twelve, the default, tell hardly more
_4K = 8.3  # megapixels; a clip takes minutes
_DRIFT = 0.03  # RMSE between both ends of a clip that drifts


@dataclass(frozen=True, slots=True)
class Cell:
    """One row of the table."""

    name: str
    take: Take


# Bit rates of phones and cameras; exposures that move as between window and room; and, for drift,
# a camera that meters anew and one that does not.
CELLS = (
    Cell("PNG, exposure moves 1.5 stops", Take(None, 1.5, lossless=True)),
    Cell("JPEG, exposure moves 1.5 stops", Take(None, 1.5)),
    Cell("JPEG with exposures, 1.5 stops", Take(None, 1.5, told=True)),
    Cell("50 Mbit/s, exposure moves 1.5 stops", Take(50.0, 1.5)),
    Cell("10 Mbit/s, exposure moves 1.5 stops", Take(10.0, 1.5)),
    Cell("2 Mbit/s, exposure moves 1.5 stops", Take(2.0, 1.5)),
    Cell("10 Mbit/s, exposure fixed", Take(10.0)),
    Cell("10 Mbit/s, 1.5 stops in steps", Take(10.0, 1.5, course=STEPS)),
    Cell("10 Mbit/s, 1.5 stops evenly", Take(10.0, 1.5, course=EVEN)),
    Cell("10 Mbit/s, 1.5 stops, curve drifts", Take(10.0, 1.5, _DRIFT)),
    Cell("10 Mbit/s, fixed, curve drifts", Take(10.0, 0.0, _DRIFT)),
    Cell("4K of 100 Mbit/s, 1.5 stops", Take(100.0, 1.5, megapixels=_4K)),
)


@dataclass(frozen=True, slots=True, eq=False)
class ClipPlan:
    """What is measured.

    Attributes
    ----------
    images
        Linear images with faces.
    responses
        Of which the green curve stands for all channels.
    count
        Clips of a cell.
    seed
        Of paths, exposures, noise and choices.
    cells
        Rows of the table.
    """

    images: tuple[LinearImage, ...]
    responses: Responses
    count: int = 10
    seed: int = 0
    cells: tuple[Cell, ...] = CELLS

    def tasks(self) -> Iterator[ClipTask]:
        """Every clip; the same faces and responses in all cells."""
        generator = np.random.default_rng(self.seed)
        total = len(self.responses.inverse)
        rows = generator.permutation(np.resize(spread_rows(total, limit=self.count), self.count))
        images = np.resize(generator.permutation(len(self.images)), self.count)
        # One of each row, and then the next: a run that is broken off has as many of each.
        for number in range(self.count):
            for cell in self.cells:
                yield ClipTask(cell, number, int(images[number]), int(rows[number]))

    def key(self, task: ClipTask) -> str:
        """Digest of all that a result depends on."""
        parts = [asdict(task), self.seed, self.responses.sha256, code_digest(), _clip_digest()]
        text = json.dumps([*parts, self.images[task.image].sha256], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class ClipTask:
    """One clip: its cell, its number there, index of the image, row of the response."""

    cell: Cell
    number: int
    image: int
    row: int


def run_clips(
    plan: ClipPlan,
    output: Path,
    *,
    minutes: float = np.inf,
    progress: Callable[[int, int], None] = lambda *_: None,
) -> tuple[str, tuple[Path, ...]]:
    """Measure what is not measured yet; returns the table and the files written.

    After `minutes` no more clips are begun, and the table is of those there are.

    Raises
    ------
    OutputError
        If the folder cannot be written to.
    """
    store = Store(output / "clips.jsonl", ClipResult)
    keys = {plan.key(task): task for task in plan.tasks()}
    read = lru_cache(maxsize=4)(LinearImage.read)
    fold_of = assign_folds(plan.responses, FOLDS)
    ends = monotonic() + 60.0 * minutes
    for done, (key, task) in enumerate(keys.items()):
        progress(done, len(keys))
        if monotonic() > ends and store.results:
            break
        if key not in store.results:
            fold = int(fold_of[task.row])
            store.append({key: _measure(plan, task, fold, read(plan.images[task.image]).encoded)})
    else:
        progress(len(keys), len(keys))
    return clip_files([store.results[key] for key in keys if key in store.results], output)


@cache
def _clip_digest() -> str:
    """Of the code of clips, which no other bench depends on."""
    files = sorted(Path(facecrf_ocio.clip.__file__).parent.glob("*.py"))
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def choose_cells(names: str) -> tuple[Cell, ...]:
    """Cells whose names contain one of a list with semicolons, in the order of the table.

    Raises
    ------
    SettingsError
        If there are none.
    """
    asked = [name.strip() for name in names.split(";") if name.strip()]
    chosen = tuple(c for c in CELLS if names == "all" or any(name in c.name for name in asked))
    if not chosen:
        raise SettingsError(f"no row {names!r}; known: {'; '.join(c.name for c in CELLS)}")
    return chosen


def _measure(plan: ClipPlan, task: ClipTask, fold: int, scene: Float) -> ClipResult:
    take, generator = task.cell.take, np.random.default_rng([plan.seed, task.number, task.row])
    first = plan.responses.inverse[task.row, _GREEN]
    last = drifted(first, _other(plan.responses, task.row, generator), take.drift)
    truth = np.tile((first + last) / 2.0, (len(CHANNELS), 1))
    with tempfile.TemporaryDirectory() as folder:
        path = take_clip(scene.astype(np.float32), (first, last), take, generator, Path(folder))
        clip = open_clip(path)
        found = calibrate_clip(clip, frames=_FRAMES, model=joint_model(plan.responses, fold))
        counts = count_codes(clip.first([len(clip.times) // 2]))
    return _result(plan, task, found, truth, counts)


def _other(responses: Responses, row: int, generator: np.random.Generator) -> Float:
    """A curve to drift toward: any that lies far enough for the way to be no extrapolation."""
    green = responses.inverse[:, _GREEN]
    apart = np.sqrt(((green - green[row]) ** 2).mean(axis=1))
    return np.asarray(green[generator.choice(np.flatnonzero(apart > 2.0 * _DRIFT))])


def _result(
    plan: ClipPlan,
    task: ClipTask,
    found: ClipEstimate,
    truth: Float,
    counts: np.typing.NDArray[np.int64],
) -> ClipResult:
    def scored(curve: InverseCRF, confidence: Confidence | None = None) -> Score:
        return score(curve, confidence, truth, counts)

    def blind(name: str) -> Score:
        grid = np.linspace(0.0, 1.0, truth.shape[1])
        return scored(
            inverse_crf(grid, np.tile(fixed_curve(name, grid, dorf_model()), (len(CHANNELS), 1)))
        )

    clip = scored(found.estimate.curve, found.estimate.confidence)
    frames = [scored(one.curve, one.confidence) for one in found.alone]
    bias = [one.curve.linear[_GREEN] for one in found.alone]
    at = found.estimate.curve.encoded
    true = np.interp(at, np.linspace(0.0, 1.0, truth.shape[1]), truth[_GREEN])
    errors = np.array(bias) - true if bias else np.zeros((0, at.size))
    mean, srgb = blind("mean"), blind("srgb")
    return ClipResult(
        task.cell.name,
        plan.images[task.image].name,
        plan.responses.names[task.row],
        len(frames),
        clip.mid,
        clip.rmse,
        _mean([one.mid for one in frames]),
        _mean([one.rmse for one in frames]),
        mean.mid,
        mean.rmse,
        srgb.mid,
        srgb.rmse,
        clip.band_coverage,
        clip.band_stops,
        _mean([one.band_coverage or 0.0 for one in frames]),
        found.drift.stops,
        found.drift.error,
        found.drift.is_sure,
        task.cell.take.drift,
        *_alike(errors),
        float((errors**2).mean()) if bias else 0.0,
        found.exposure_stops,
        found.noise_told,
    )


def _alike(errors: Float) -> tuple[float, float]:
    """Mean product of the errors (J, K) of frames next to each other, and far from each other.

    Far is more than half the clip; errors are those of the curves, linear light.
    """
    count = len(errors)
    apart = np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    products = errors @ errors.T / max(errors.shape[1], 1)
    pairs = (products[apart == 1], products[apart > count / 2.0])
    near, far = (float(one.mean()) if one.size else 0.0 for one in pairs)
    return near, far


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if values else float("nan")
