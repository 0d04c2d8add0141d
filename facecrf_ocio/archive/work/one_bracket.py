"""The work on one bracket: its photos read, laid over each other, and merged by a curve."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from facecrf_ocio.archive.task import MERGED, NOT_MERGED, Result, Series, Task
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.folders import make_folder
from facecrf_ocio.image.merged_exr import write_merged
from facecrf_ocio.pair.calibrate_bracket import calibrate_bracket
from facecrf_ocio.pair.merge_exposures import merge_exposures
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.record.demand import Demand, demand
from facecrf_ocio.values import Photo

_BY_HAND = "merge the others by `facecrf merge`"
_MOST_MOVED = 0.5  # of a photo's pixels: those that show one scene agree in most of it


def merged(task: Task) -> tuple[Result, Path | None]:
    """Merge a bracket; what came of it, and the EXR if one was written.

    Raises
    ------
    PhotoError
        If a photo cannot be read, was changed, or does not belong to the others.
    OutputError
        If the EXR cannot be written.
    """
    series = task.series
    if series is None:
        raise ValueError(f"{task.name} has nothing to be merged")
    solved = calibrate_bracket(
        _read(series), np.array(series.stops), center_only=series.center_only
    )
    # The photos may tell more than what an archive keeps of each: here they are aligned, and flat
    # patches are chosen.
    estimate = task.estimate or solved.estimate
    estimate = demand(estimate, Demand(task.recipe.min_confidence, task.recipe.max_error))
    verdict = "" if estimate.confidence is None else str(estimate.confidence.verdict)
    result = Result(MERGED, verdict, estimate.estimator, estimate.reason, estimate.remedy)
    if estimate.found is None:
        remedy = _BY_HAND if solved.solved.false else result.remedy
        return replace(result, outcome=NOT_MERGED, remedy=remedy), None
    exposures = merge_exposures(solved, estimate.found)
    wrong = exposures.false or solved.wrong_order
    if wrong:
        return replace(result, outcome=NOT_MERGED, reason=wrong, remedy=_BY_HAND), None
    path = task.place.inside(task.planned[0])
    make_folder(path.parent)
    how: dict[str, Any] = {"overwrite": task.overwrite, "compression": task.recipe.compression}
    file = write_merged(path, exposures.bracket, estimate, most_moved=_MOST_MOVED, **how)
    told = tuple(
        (round(stop, 4), round(share, 6))
        for stop, share in zip(file.stops.tolist(), file.moved, strict=True)
    )
    reason = "; ".join((result.reason, *file.notes))
    return replace(result, merged=told, reason=reason), path


def _read(series: Series) -> Iterator[Photo]:
    for path, sha256 in zip(series.paths, series.sha256, strict=True):
        photo = read_photo(path)
        if photo.sha256 != sha256:
            raise PhotoError(path, "was changed while the run went on", "start again")
        yield photo
