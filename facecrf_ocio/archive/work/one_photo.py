"""The work on one photo: read, estimate, write. `process` is the entry point of every scheduler.

Where photos of a camera share a curve, the work is done in two steps: one gathers what the photo
says, the other writes the curve that all of them gave.
"""

from __future__ import annotations

import errno
import hashlib
import time
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

from facecrf_ocio.archive.cameras.told import face_json, told_before
from facecrf_ocio.archive.report.record_summary import summary_of
from facecrf_ocio.archive.task import (
    FAILED,
    GATHER,
    MERGE,
    Gathered,
    Output,
    Result,
    Task,
    Timing,
)
from facecrf_ocio.archive.thumbnail import thumbnail_of
from facecrf_ocio.calibrate import assumed, calibrate
from facecrf_ocio.cameras.known_cameras import own_cameras_are
from facecrf_ocio.errors import (
    OVERWRITE,
    ExistsError,
    FaceCRFError,
    OutputError,
    PhotoError,
    reason_of,
)
from facecrf_ocio.files.folders import make_folder
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.image.exposure import find_exposure
from facecrf_ocio.image.linearize import write_linear
from facecrf_ocio.joint import gather
from facecrf_ocio.pair.code_samples import take_samples
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.photo.shot import read_shot
from facecrf_ocio.record.demand import Demand, demand
from facecrf_ocio.record.output_names import EXR, RECORD, output_path
from facecrf_ocio.record.outputs import require_outputs_free, write_outputs
from facecrf_ocio.values import Estimate, Photo

# What is wrong with the disk, and not with the photo: every other photo would fail alike.
_DISK = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO)
# What a disk or a network does once and then not again.
_PASSING = (
    *(errno.EIO, errno.ESTALE, errno.ETIMEDOUT, errno.EAGAIN, errno.EINTR, errno.ENOTCONN),
    *(errno.ENETDOWN, errno.ENETUNREACH, errno.EHOSTDOWN, errno.EHOSTUNREACH),
    *(errno.ECONNRESET, errno.ECONNABORTED),
)
_PAUSE = 1.0  # [s] before what may have passed is tried once more
_AGAIN = "check the disk or the network, and start again"


def process(task: Task) -> Result:
    """Read, calibrate and write one photo.

    Never raises: what is wrong with the photo, or with a library that reads it, is a `Result` whose
    outcome is `failed`. What may have passed after a second is tried once more. The same photo and
    recipe give the same bytes, whenever and wherever this runs on a processor that can do the same.
    """
    with own_cameras_are(task.cameras):
        result = _attempt(task)
        if result.lasting:
            return result
        time.sleep(_PAUSE)
        return _attempt(task)


def _attempt(task: Task) -> Result:
    sha256 = ""
    try:
        if task.step == MERGE:
            return _merge(task)
        start = perf_counter()
        photo = read_photo(task.source)
        read = perf_counter()
        sha256 = photo.sha256 or ""
        if task.sha256 not in ("", sha256):
            raise PhotoError(photo.path, "was changed while the run went on", "start again")
        if task.step == GATHER and _is_poolable(photo):
            result = _gather(task, photo)
            return replace(result, timing=Timing(read - start, perf_counter() - read))
        result, estimate = _estimate(task, photo)
        done = perf_counter() if task.estimate is None else read
        names, notes = ((), ()) if estimate.found is None else _write(task, photo, estimate)
        summary = summary_of(estimate, _luts(names)) if names else ""
        reason = "; ".join((result.reason, *notes))
        thumbnail = thumbnail_of(photo, estimate)
        result = replace(result, reason=reason, thumbnail=thumbnail, summary=summary)
        outputs = tuple(_described(task.place.folder, path) for path in names)
    except Exception as error:  # whatever a library or we raise costs this photo, not the run
        return replace(failure_of(error), sha256=sha256)
    timing = Timing(read - start, done - read, perf_counter() - done)
    return replace(result, outputs=outputs, timing=timing)


def _merge(task: Task) -> Result:
    from facecrf_ocio.archive.work.one_bracket import merged  # noqa: PLC0415 - few runs merge

    result, path = merged(task)
    outputs = () if path is None else (_described(task.place.folder, path),)
    return replace(result, outputs=outputs)


def _is_poolable(photo: Photo) -> bool:
    """Whether a photo has a curve, and a camera to share it with: an edited one has its own."""
    return _has_camera(photo) and not photo.edits


def _has_camera(photo: Photo) -> bool:
    return not photo.scene_linear and bool(photo.camera.make or photo.camera.model)


def _gather(task: Task, photo: Photo) -> Result:
    evidence = gather(photo, task.recipe.settings)
    shot = read_shot(task.source)
    # What bends curves to scenes is a setting of the picture as well: with it on and off, photos of
    # a camera share no curve.
    style = "; ".join(filter(None, (shot.style, *photo.adapted)))
    return Result(
        "",
        sha256=photo.sha256 or "",
        camera=_camera(photo),
        shot=replace(shot, style=style),
        gathered=Gathered(evidence.to_json(), face_json(evidence), take_samples(photo.pixels)),
        thumbnail=thumbnail_of(photo, None),
    )


def _estimate(task: Task, photo: Photo) -> tuple[Result, Estimate]:
    least = Demand(task.recipe.min_confidence, task.recipe.max_error)
    estimate = demand(_found(task, photo), least)
    result = Result(
        str(estimate.outcome),
        "" if estimate.confidence is None else str(estimate.confidence.verdict),
        estimate.estimator,
        _reason(task, photo, estimate),
        estimate.remedy,
        photo.sha256 or "",
        _camera(photo),
    )
    return result, estimate


def _reason(task: Task, photo: Photo, estimate: Estimate) -> str:
    """The estimate's, and why a photo does not share its camera's curve."""
    if not task.recipe.pool or not photo.edits or not _has_camera(photo):
        return estimate.reason
    return f"{estimate.reason}; apart from its camera's other photos: {', '.join(photo.edits)}"


def _found(task: Task, photo: Photo) -> Estimate:
    if task.estimate is None:
        recipe = task.recipe
        return calibrate(
            photo,
            estimator=recipe.estimator,
            fallback=recipe.fallback,
            prior=recipe.prior,
            settings=recipe.settings,
            evidence=None if task.gathered is None else told_before(task.gathered),
        )
    if task.estimate.assumptions:
        return task.estimate
    return assumed(task.estimate, photo)


def _camera(photo: Photo) -> tuple[str, str, str, str]:
    camera = photo.camera
    return camera.make, camera.model, camera.serial, camera.software


def _write(
    task: Task, photo: Photo, estimate: Estimate
) -> tuple[tuple[Path, ...], tuple[str, ...]]:
    """Write all files of a photo: their paths, and what its EXR does not hold."""
    recipe, name = task.recipe, Path(task.name).name
    # First, since it is no photo's half result.
    own = task.estimate is None and task.gathered is None  # else its faces may be other photos'
    faces = estimate.faces if own else ()
    exposure = find_exposure(recipe.exposure, photo, estimate.curve, faces) if recipe.exr else None
    folder = task.place.inside(task.name).parent
    make_folder(folder)
    how: dict[str, Any] = {"overwrite": task.overwrite, "name": name}
    exr = None
    if exposure is not None:
        # Before the record, which tells what it does not hold.
        require_outputs_free(task.source, folder, recipe.formats, **how)
        path = output_path(folder, task.name, EXR)
        of_exr: dict[str, Any] = {"exposure": exposure, "compression": recipe.compression}
        exr = write_linear(path, photo, estimate, overwrite=task.overwrite, **of_exr)
        photo = photo.but(notes=(*photo.notes, *exr.notes))
    written = write_outputs(photo, estimate, recipe.settings, folder, recipe.formats, **how)
    return (written, ()) if exr is None else ((*written, exr.path), exr.notes)


def _luts(written: tuple[Path, ...]) -> tuple[str, ...]:
    return tuple(path.name for path in written if not path.name.endswith((RECORD, EXR)))


def _described(folder: Path, path: Path) -> Output:
    content = path.read_bytes()
    name = path.relative_to(folder).as_posix()
    digest = hashlib.sha256(content).hexdigest()
    return Output(name, len(content), digest, path.stat().st_mtime_ns)


def failure_of(error: Exception) -> Result:
    """What an error is to the run: this photo's failure, or the end of it all."""
    cause = error if isinstance(error, OSError) else error.__cause__
    number = cause.errno if isinstance(cause, OSError) else None
    lasting = number not in _PASSING
    if isinstance(error, MemoryError):
        return Result(FAILED, reason="not enough memory", remedy="use a smaller version of it")
    if isinstance(error, PhotoError):
        remedy = error.remedy if lasting else _AGAIN
        return Result(FAILED, reason=plain_text(error.problem), remedy=remedy, lasting=lasting)
    if isinstance(error, OSError):
        reason, remedy = f"cannot be used: {reason_of(error)}", "" if lasting else _AGAIN
        return Result(FAILED, reason=plain_text(reason), remedy=remedy, lasting=lasting)
    if not isinstance(error, FaceCRFError):
        reason = f"unexpected {type(error).__name__}: {plain_text(error)}"
        return Result(FAILED, reason=reason, remedy="please report this")
    if isinstance(error, ExistsError):
        reason = f"{error.target}: {error.problem}"
        return Result(FAILED, reason=plain_text(reason), remedy=OVERWRITE, lasting=lasting)
    reason = plain_text(str(error))
    # What keeps an output from being written is not the photo's, and may be gone the next time.
    place = isinstance(error, OutputError)
    stop = reason if place and number in _DISK else ""
    return Result(FAILED, reason=reason, stop=stop, lasting=lasting and not place)
