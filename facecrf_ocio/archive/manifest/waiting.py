"""The photos whose evidence is known and whose curve is decided: what is left is to write."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from facecrf_ocio.archive.cameras.camera_group import (
    bracket_estimate,
    conclude_camera,
    exposures,
    member_estimate,
    solve,
)
from facecrf_ocio.archive.manifest.database import GATHERED, WRITING, Manifest
from facecrf_ocio.archive.manifest.told import told_before
from facecrf_ocio.archive.work.task import WRITE, Recipe, Result, Task
from facecrf_ocio.values import Estimate, Outcome

_PAGE = 250


def waiting(
    manifest: Manifest, source: Path, folder: Path, recipe: Recipe, digest: str
) -> Iterator[tuple[Task, Result | None]]:
    """Yield what is to be written, camera by camera.

    Parameters
    ----------
    manifest
        Settled.
    source, folder
        Roots of the photos and of the outputs.
    recipe, digest
        How to treat each photo, and the hash of that.

    Yields
    ------
    tuple
        The task; and its result, if there is nothing to write and so nothing to do.
    """
    keys = [key for (key,) in manifest.rows("SELECT key FROM cameras ORDER BY key")]
    for key in keys:
        desk = _Desk(manifest, key, recipe, digest)
        last: str | None = ""
        while last is not None:
            page, last = _page(manifest, key, digest, last)
            for name, sha256, curve, bracket in page:
                task = Task(source / name, name, folder, recipe, True, WRITE, sha256)
                yield desk.filled(task, curve, bracket)


def _page(
    manifest: Manifest, key: str, digest: str, last: str
) -> tuple[list[tuple[str, str, str, str]], str | None]:
    rows = list(
        manifest.rows(
            "SELECT name, sha256, curve, bracket FROM photos WHERE camera = ? AND recipe = ? "
            "AND state IN (?, ?) AND name > ? ORDER BY name LIMIT ?",
            *(key, digest, GATHERED, WRITING, last, _PAGE),
        )
    )
    return [(*row,) for row in rows], rows[-1][0] if len(rows) == _PAGE else None


class _Desk:
    """The curves of one camera, each concluded once and only if it is needed."""

    def __init__(self, manifest: Manifest, key: str, recipe: Recipe, digest: str) -> None:
        self.manifest, self.key, self.recipe, self.digest = manifest, key, recipe, digest
        self._camera = lru_cache(maxsize=1)(self._conclude)
        self._bracket = lru_cache(maxsize=4)(self._solve)

    def filled(self, task: Task, curve: str, bracket: str) -> tuple[Task, Result | None]:
        gathered = self.manifest.gathered(task.name)
        evidence = told_before(gathered)
        if curve == "bracket":
            faces = () if evidence.face is None else (evidence.face,)
            return replace(task, estimate=replace(self._bracket(bracket), faces=faces)), None
        if curve == "camera":
            camera = self._camera()
            if camera is None:
                raise ValueError(f"no photo of {self.key} says anything")
            return replace(task, estimate=member_estimate(camera, evidence)), None
        recipe = self.recipe
        if not evidence.messages and recipe.estimator == "auto" and recipe.fallback == "none":
            said = evidence.lacking, evidence.remedy
            return task, Result(str(Outcome.NOT_CALIBRATED), "", "joint", *said)
        return replace(task, gathered=gathered), None

    def _conclude(self) -> Estimate | None:
        return conclude_camera(self.manifest, self.key, self.digest, self.recipe.prior).estimate

    def _solve(self, bracket: str) -> Estimate:
        members = tuple(exposures(self.manifest, self.key, self.digest, bracket))
        estimate = bracket_estimate(members, solve(members), self._camera())
        if estimate is None:
            raise ValueError(f"the bracket {bracket} has no curve")
        return estimate
