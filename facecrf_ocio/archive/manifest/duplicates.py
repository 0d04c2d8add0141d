"""Photos of the same bytes: the second gets the curve that the first got."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from facecrf_ocio.archive.manifest.database import DONE, STARTED, Manifest
from facecrf_ocio.archive.work.task import FAILED, WRITE, Result, Shot, Task
from facecrf_ocio.errors import LutError, OutputError
from facecrf_ocio.files.content import sha256_of
from facecrf_ocio.values import Estimate, Face, Outcome


def from_twin(
    manifest: Manifest, task: Task, fingerprint: str, recipe: str
) -> tuple[Task, Result | None] | None:
    """What is left to do for a photo of which another with the same bytes is known.

    Returns
    -------
    tuple or None
        The task to write the other's curve; and the result, if nothing is to be written. None if
        there is no such photo, or if what became of it is of no use.
    """
    rows = manifest.rows(
        "SELECT name, sha256, state, outcome, verdict, estimator, reason, remedy, make, model, "
        "serial, software, camera, taken, exposure_s, aperture, iso FROM photos "
        "WHERE fingerprint = ? AND recipe = ? AND state != ? AND name != ? ORDER BY name",
        *(fingerprint, recipe, STARTED, task.name),
    )
    if not fingerprint:
        return None
    own = ""
    for name, sha256, state, outcome, *rest in list(rows):
        if outcome == FAILED and not rest[8]:
            continue
        own = own or _hash(task.source)
        if sha256 != own:
            continue
        verdict, estimator, reason, remedy, make, model, serial, software, key, *shot = rest
        camera = (make, model, serial, software)
        if key:
            told = Shot(json.loads(key)[-1], *shot)
            gathered = manifest.gathered(name)
            return task, Result("", sha256=own, camera=camera, shot=told, gathered=gathered)
        if state != DONE:
            continue
        if not manifest.outputs(name):
            return task, Result(outcome, verdict, estimator, reason, remedy, own, camera)
        estimate = _estimate_of(manifest, task.folder, name)
        if estimate is not None:
            return replace(task, step=WRITE, sha256=own, estimate=estimate), None
    return None


def mark_duplicates(manifest: Manifest) -> None:
    """Record for every photo which one, first in the order of names, has the same bytes."""
    first = (
        "IFNULL((SELECT MIN(name) FROM photos AS other "
        "WHERE other.fingerprint = photos.fingerprint AND other.sha256 = photos.sha256 "
        "AND other.fingerprint != '' AND other.name < photos.name), '')"
    )
    with manifest.transaction():
        manifest.change(
            f"UPDATE photos SET duplicate_of = {first} "  # noqa: S608
            "WHERE fingerprint IN (SELECT fingerprint FROM photos WHERE fingerprint != '' "
            "GROUP BY fingerprint HAVING COUNT(*) > 1) OR duplicate_of != ''"
        )


def _hash(path: Path) -> str:
    try:
        return sha256_of(path)
    except OutputError:  # whoever works on it will tell
        return "unreadable"


def _estimate_of(manifest: Manifest, folder: Path, name: str) -> Estimate | None:
    """The estimate as its sidecar has it; None if that is not as it was written."""
    from facecrf_ocio.record.sidecar import SUFFIX, read_sidecar  # noqa: PLC0415 - heavy

    path = folder / f"{name}{SUFFIX}"
    recorded = {output.name: output.sha256 for output in manifest.outputs(name)}
    try:
        if recorded.get(f"{name}{SUFFIX}") != sha256_of(path):
            return None
        told = read_sidecar(path)
    except (OutputError, LutError):
        return None
    return Estimate(
        Outcome(told.outcome),
        told.estimator,
        told.reason,
        told.remedy,
        told.curve,
        told.confidence,
        told.coefficients,
        told.energy,
        tuple(Face(np.array(f.box_xy), np.empty((0, 3)), f.score) for f in told.faces),
        told.assumptions,
    )
