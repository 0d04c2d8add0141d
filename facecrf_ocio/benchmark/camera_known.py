"""What a measured response of its camera adds to a photo, that measurement left out.

Each photo is taken with one measurement of a model, and the estimator is told another one, which
others made in another way. The weights are those that never saw the photo's curve, nor others of
the same maker in its file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from facecrf_ocio.benchmark.conditions import a_day
from facecrf_ocio.benchmark.folds import assign_folds
from facecrf_ocio.benchmark.images import LinearImage
from facecrf_ocio.benchmark.joint_folds import joint_model
from facecrf_ocio.benchmark.metrics import Score, score
from facecrf_ocio.benchmark.responses import Responses
from facecrf_ocio.benchmark.stress_camera import photograph
from facecrf_ocio.benchmark.virtual_camera import count_codes
from facecrf_ocio.cameras.known_cameras import POINTS, KnownCamera
from facecrf_ocio.joint import conclude, gather
from facecrf_ocio.values import Camera, Photo

ROWS = ("camera only named", "camera known, this measurement left out", "that measurement alone")
"""Of the table: by the photo, by both, by what is known of the camera."""

_FOLDS = 5  # of the weights that hold out makers
_MEGAPIXELS = 1.5  # at most, so that a run takes minutes
_SPREAD_STOPS = 0.07  # [stop] of a measurement, as stacks of one set have it


@dataclass(frozen=True, slots=True)
class KnownCase:
    """One measurement that takes a photo, and another one of the same model that is told."""

    model: str
    truth: tuple[int, int]
    told: tuple[int, int]


@dataclass(frozen=True, slots=True)
class KnownResult:
    """Errors of one photo, in the order of `ROWS`."""

    case: KnownCase
    scores: tuple[Score, ...]


def model_of(name: str) -> str:
    """What a response's name calls the model: its first word of letters and digits, or empty."""
    words = name.replace("(", " ").replace(":", " ").split()
    both = (w for w in words if any(c.isdigit() for c in w) and any(c.isalpha() for c in w))
    return next(both, "").upper()


def known_cases(files: Sequence[Responses], kind: str = "camera_jpeg") -> tuple[KnownCase, ...]:
    """Every measurement of a model of which there is another, and the next one of it."""
    models: dict[str, list[tuple[int, int]]] = {}
    for file, responses in enumerate(files):
        for row, name in enumerate(responses.names):
            if responses.kind(row) == kind and model_of(name):
                models.setdefault(model_of(name), []).append((file, row))
    return tuple(
        KnownCase(model, rows[n], rows[(n + 1) % len(rows)])
        for model, rows in sorted(models.items())
        if len(rows) > 1
        for n in range(len(rows))
    )


def measure_known(
    images: Sequence[LinearImage],
    files: Sequence[Responses],
    *,
    repeat: int = 1,
    seed: int = 0,
    progress: Callable[[int, int], None] = lambda *_: None,
) -> Iterator[KnownResult]:
    """Take a day's photos and estimate each with and without what is known of its camera."""
    cases = known_cases(files)
    folds = [assign_folds(one, _FOLDS) for one in files]
    for number in range(repeat * len(cases)):
        case = cases[number % len(cases)]
        file, row = case.truth
        model = joint_model(files[file], int(folds[file][row]))
        # An odd stride pairs every case with other faces in the next round.
        image = images[(7 * number + number // len(cases)) % len(images)]
        truth = np.repeat(files[file].inverse[row][1:2], 3, axis=0)
        photo = _photo(image, truth, np.random.default_rng([seed, number]), case.model)
        evidence = gather(photo, networks=model.networks)
        progress(number + 1, repeat * len(cases))
        if not evidence.messages:
            continue
        told = _entry(files[case.told[0]], case.told[1], case.model)
        by_photo = conclude([evidence], "auto", model, cameras=())
        by_both = conclude([evidence], "auto", model, cameras=(told,))
        counts = count_codes(photo)
        curves = ((by_photo.curve, by_photo.confidence), (by_both.curve, by_both.confidence))
        scores = [score(*one, truth, counts) for one in (*curves, (told.curve, None))]
        yield KnownResult(case, tuple(scores))


def known_markdown(results: Sequence[KnownResult]) -> str:
    """The table: errors over all photos."""
    models = sorted({one.case.model for one in results})
    lines = [
        f"{len(results)} photos of {len(models)} models ({', '.join(models)})",
        "",
        "| | RMSE, median | 95 % | stops, midtones | shadows | band holds |",
        "|---|---|---|---|---|---|",
    ]
    for place, name in enumerate(ROWS):
        scores = [one.scores[place] for one in results]
        rmse = np.array([100.0 * s.rmse for s in scores])
        covered = [s.band_stops for s in scores if s.band_stops is not None]
        holds = f"{100.0 * np.mean(covered):.0f} %" if covered else ""
        lines.append(
            f"| {name} | {np.median(rmse):.1f} | {np.quantile(rmse, 0.95):.1f} | "
            f"{np.median([s.mid for s in scores]):.3f} | "
            f"{np.median([s.shadows for s in scores]):.3f} | {holds} |"
        )
    return "\n".join(lines)


def _photo(
    image: LinearImage, truth: np.typing.NDArray[np.float64], drawn: np.random.Generator, model: str
) -> Photo:
    conditions = a_day(drawn)
    size = min(conditions.megapixels or _MEGAPIXELS, _MEGAPIXELS)
    scene = np.maximum(image.read().encoded, 0.0)
    codes = photograph(scene, truth, replace(conditions, megapixels=size), drawn)
    encoded = codes.astype(np.float32) / np.float32(255.0)
    return Photo(encoded, 8, camera=Camera("", model))


def _entry(responses: Responses, row: int, model: str) -> KnownCamera:
    at, grid = np.linspace(0.0, 1.0, POINTS), np.linspace(0.0, 1.0, responses.inverse.shape[2])
    green = tuple(np.interp(at, grid, responses.inverse[row][1]).tolist())  # as the photo is taken
    proof = responses.names[row]
    return KnownCamera("", model, "", "bracket", "B", _SPREAD_STOPS, proof, (green,) * 3)
