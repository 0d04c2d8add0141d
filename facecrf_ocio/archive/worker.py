"""The work on one photo: read, estimate, write. `process` is the entry point of every scheduler."""

from __future__ import annotations

import errno
import hashlib
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import cv2

from facecrf_ocio.archive.task import FAILED, Output, Result, Task, Timing
from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.confidence import demand
from facecrf_ocio.errors import FaceCRFError, OutputError
from facecrf_ocio.export import write_outputs
from facecrf_ocio.linearize import write_linear
from facecrf_ocio.read import read_photo
from facecrf_ocio.values import Estimate, Photo

# What is wrong with the disk, and not with the photo: every other photo would fail alike.
_DISK = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO)


def warm_up() -> None:
    """Set up a process that will work on many photos."""
    cv2.setNumThreads(1)


def process(task: Task) -> Result:
    """Read, calibrate and write one photo.

    Never raises for what is wrong with the photo: that is a `Result` whose outcome is `failed`.
    The same photo and recipe give the same bytes, whenever and wherever this runs.
    """
    start = perf_counter()
    try:
        photo = read_photo(task.source)
    except (FaceCRFError, MemoryError, OSError) as error:
        return _failure(error)
    read = perf_counter()
    try:
        result, estimate = _estimate(task, photo)
        done = perf_counter()
        names = () if estimate.found is None else _write(task, photo, estimate)
        outputs = tuple(_described(task.folder, path) for path in names)
    except (FaceCRFError, MemoryError, OSError) as error:
        return replace(_failure(error), sha256=photo.sha256 or "")
    except Exception as error:  # a fault of ours costs this photo, and not the run
        reason = f"unexpected {type(error).__name__}: {error}"
        return Result(FAILED, reason=reason, sha256=photo.sha256 or "")
    timing = Timing(read - start, done - read, perf_counter() - done)
    return replace(result, outputs=outputs, timing=timing)


def _estimate(task: Task, photo: Photo) -> tuple[Result, Estimate]:
    recipe, camera = task.recipe, photo.camera
    estimate = calibrate(
        photo,
        estimator=recipe.estimator,
        fallback=recipe.fallback,
        prior=recipe.prior,
        settings=recipe.settings,
    )
    estimate = demand(estimate, recipe.min_confidence)
    result = Result(
        str(estimate.outcome),
        "" if estimate.confidence is None else str(estimate.confidence.verdict),
        estimate.estimator,
        estimate.reason,
        estimate.remedy,
        photo.sha256 or "",
        (camera.make, camera.model, camera.serial, camera.software),
    )
    return result, estimate


def _write(task: Task, photo: Photo, estimate: Estimate) -> tuple[Path, ...]:
    recipe, name = task.recipe, Path(task.name).name
    written = write_outputs(
        photo,
        estimate,
        recipe.settings,
        task.target,
        recipe.formats,
        overwrite=task.overwrite,
        stem=name,
    )
    if recipe.exr:
        exr = task.target / f"{name}.exr"
        written += (write_linear(exr, photo, estimate, overwrite=task.overwrite),)
    return written


def _described(folder: Path, path: Path) -> Output:
    content = path.read_bytes()
    name = path.relative_to(folder).as_posix()
    return Output(name, len(content), hashlib.sha256(content).hexdigest())


def _failure(error: Exception) -> Result:
    if isinstance(error, MemoryError):
        return Result(FAILED, reason="not enough memory", remedy="use a smaller version of it")
    cause = error.__cause__ if isinstance(error, OutputError) else None
    number = cause.errno if isinstance(cause, OSError) else None
    return Result(FAILED, reason=str(error), stop=str(error) if number in _DISK else "")
