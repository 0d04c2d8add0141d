"""Photos of the same bytes: the second gets the curve that the first got."""

from __future__ import annotations

from dataclasses import replace

from facecrf_ocio.archive.manifest.database import DONE, Manifest
from facecrf_ocio.archive.manifest.twin_rows import twins_of
from facecrf_ocio.archive.task import FAILED, WRITE, Result, Task
from facecrf_ocio.errors import LutError, OutputError
from facecrf_ocio.files.content import sha256_of, sha256_or_unreadable
from facecrf_ocio.record.output_names import RECORD, output_name
from facecrf_ocio.values import Estimate


def from_twin(
    manifest: Manifest, task: Task, fingerprint: str, recipe_sha256: str
) -> tuple[Task, Result | None] | None:
    """What is left to do for a photo of which another with the same bytes is known.

    Returns
    -------
    tuple or None
        The task to write the other's curve; and the result, if nothing is to be written. None if
        there is no such photo, or if what became of it is of no use.
    """
    own = ""
    for twin in twins_of(manifest, task.name, fingerprint, recipe_sha256) if fingerprint else ():
        told = twin.result
        if told.outcome == FAILED and not twin.key:
            continue
        own = own or sha256_or_unreadable(task.source)
        if told.sha256 != own:
            continue
        if twin.key:
            gathered = manifest.gathered(twin.name)
            return task, Result(
                "", sha256=own, camera=told.camera, shot=told.shot, gathered=gathered
            )
        if twin.state != DONE:
            continue
        if not manifest.outputs(twin.name):
            return task, told
        estimate = _estimate_of(manifest, task, twin.name)
        if estimate is not None:
            return replace(task, step=WRITE, sha256=own, estimate=estimate), None
    return None


def _estimate_of(manifest: Manifest, task: Task, name: str) -> Estimate | None:
    """The estimate as its record has it; None if that is not as it was written."""
    from facecrf_ocio.record.calibration_record import read_record  # noqa: PLC0415 - heavy

    recorded = {output.name: output.sha256 for output in manifest.outputs(name)}
    try:
        record = output_name(name, RECORD)
        path = task.place.inside(record)
        if recorded.get(record) != sha256_of(path):
            return None
        return read_record(path).estimate
    except (OutputError, LutError):
        return None
