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
from facecrf_ocio.pair.bracket_pixels import SmallBracket, small_bracket, with_stops
from facecrf_ocio.pair.calibrate_bracket import calibrate_bracket
from facecrf_ocio.pair.merge import refined_stops
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.record.demand import Demand, demand
from facecrf_ocio.values import Estimate, Photo

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
    bracket, estimate = _laid_over(series, task.estimate)
    estimate = demand(estimate, Demand(task.recipe.min_confidence, task.recipe.max_error))
    verdict = "" if estimate.confidence is None else str(estimate.confidence.verdict)
    result = Result(MERGED, verdict, estimate.estimator, estimate.reason, estimate.remedy)
    if estimate.found is None:
        return replace(result, outcome=NOT_MERGED), None
    path = task.place.inside(task.planned[0])
    make_folder(path.parent)
    how: dict[str, Any] = {"overwrite": task.overwrite, "compression": task.recipe.compression}
    file = write_merged(path, bracket, estimate, most_moved=_MOST_MOVED, **how)
    told = tuple(
        (round(stop, 4), round(share, 6))
        for stop, share in zip(file.stops.tolist(), file.moved, strict=True)
    )
    reason = "; ".join((result.reason, *file.notes))
    return replace(result, merged=told, reason=reason), path


def _laid_over(series: Series, given: Estimate | None) -> tuple[SmallBracket, Estimate]:
    """The photos with their exposures, and the curve given; without one, what the photos tell.

    They may tell more than what an archive keeps of each: here they are aligned, and flat patches
    are chosen.
    """
    stops, center_only = np.array(series.stops), series.center_only
    if given is None:
        solved = calibrate_bracket(_read(series), stops, center_only=center_only)
        estimate = solved.estimate
        if estimate.found is None and solved.solved.false is not None:
            estimate = replace(estimate, remedy="merge the others by `facecrf merge`")
        return with_stops(solved.bracket, solved.solved.refined), estimate
    bracket = small_bracket(_read(series), stops)
    refined = refined_stops(bracket, given.curve, center_only=center_only)
    return with_stops(bracket, refined), given


def _read(series: Series) -> Iterator[Photo]:
    for path, sha256 in zip(series.paths, series.sha256, strict=True):
        photo = read_photo(path)
        if photo.sha256 != sha256:
            raise PhotoError(path, "was changed while the run went on", "start again")
        yield photo
