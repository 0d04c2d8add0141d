"""The photos whose evidence is known and whose curve is decided: what is left is to write."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache

from facecrf_ocio.archive.cameras.camera_group import (
    bracket_estimate,
    conclude_camera,
    exposures,
    member_estimate,
    solve,
)
from facecrf_ocio.archive.cameras.told import told_before
from facecrf_ocio.archive.manifest.camera_rows import Member, camera_keys, waiting_members
from facecrf_ocio.archive.manifest.damage import understanding
from facecrf_ocio.archive.manifest.database import Manifest
from facecrf_ocio.archive.task import WRITE, Result, Task
from facecrf_ocio.values import Estimate, Outcome


def waiting(manifest: Manifest, like: Task, digest: str) -> Iterator[tuple[Task, Result | None]]:
    """Yield what is to be written, camera by camera.

    Parameters
    ----------
    manifest
        Settled.
    like
        A task with the roots and the recipe of all; `source` is the root of the photos.
    digest
        Hash of the recipe.

    Yields
    ------
    tuple
        The task; and its result, if there is nothing to write and so nothing to do.
    """
    for key in camera_keys(manifest, digest):
        desk = Desk(manifest, key, like, digest)
        for member in waiting_members(manifest, key, digest):
            with understanding(manifest.path):
                filled = desk.filled(member)
            yield filled


class Desk:
    """The curves of one camera, each concluded once and only if it is needed."""

    def __init__(self, manifest: Manifest, key: str, like: Task, digest: str) -> None:
        self.manifest, self.key, self.like, self.digest = manifest, key, like, digest
        self.camera_curve = lru_cache(maxsize=1)(self._conclude)
        self.bracket_curve = lru_cache(maxsize=4)(self._solve)

    def filled(self, member: Member) -> tuple[Task, Result | None]:
        """The task to write a photo's curve; and its result, if there is nothing to do."""
        task = replace(
            self.like,
            source=self.like.source / member.name,
            name=member.name,
            step=WRITE,
            sha256=member.sha256,
        )
        gathered = self.manifest.gathered(member.name)
        evidence = told_before(gathered)
        if member.curve == "bracket":
            faces = () if evidence.face is None else (evidence.face,)
            return replace(
                task, estimate=replace(self.bracket_curve(member.bracket), faces=faces)
            ), None
        if member.curve == "camera":
            camera = self.camera_curve()
            if camera is None:
                raise ValueError(f"no photo of {self.key} says anything")
            return replace(task, estimate=member_estimate(camera, evidence)), None
        recipe = task.recipe
        if not evidence.messages and recipe.estimator == "auto" and recipe.fallback == "none":
            said = evidence.lacking, evidence.remedy
            return task, Result(str(Outcome.NOT_CALIBRATED), "", "joint", *said)
        return replace(task, gathered=gathered), None

    def _conclude(self) -> Estimate | None:
        recipe = self.like.recipe
        return conclude_camera(self.manifest, self.key, self.digest, recipe).estimate

    def _solve(self, bracket: str) -> Estimate:
        members = tuple(exposures(self.manifest, self.key, self.digest, bracket))
        estimate = bracket_estimate(members, solve(members), self.camera_curve())
        if estimate is None:
            raise ValueError(f"the bracket {bracket} has no curve")
        return estimate
