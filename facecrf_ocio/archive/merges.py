"""After the photos of a run: each bracket among them merged to one image, beside its curve.

An image is made again if its photos, their curve, the recipe or the file itself changed.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from facecrf_ocio import __version__
from facecrf_ocio.archive.cameras.bracket import BracketPhoto, stops_of
from facecrf_ocio.archive.cameras.camera_group import exposures
from facecrf_ocio.archive.cameras.waiting import Desk
from facecrf_ocio.archive.in_the_way import Alike, in_the_way
from facecrf_ocio.archive.job import BRACKET, Event, Job
from facecrf_ocio.archive.manifest.camera_rows import camera_keys
from facecrf_ocio.archive.manifest.damage import understanding
from facecrf_ocio.archive.manifest.database import Manifest
from facecrf_ocio.archive.manifest.keys import key_of
from facecrf_ocio.archive.manifest.merge_rows import (
    BracketNamed,
    MergeRow,
    brackets_of,
    forget_merge,
    former_merge,
    merge_begins,
    merge_ends,
    merged_file,
    merges_without_bracket,
)
from facecrf_ocio.archive.place import MOUNT, Place, source_identity
from facecrf_ocio.archive.task import FAILED, MERGE, MERGED, NOT_MERGED, Result, Series, Task
from facecrf_ocio.archive.unchanged import Unchanged
from facecrf_ocio.archive.work.processes import Workers
from facecrf_ocio.errors import OutputError, PhotoError
from facecrf_ocio.pair.bracket_curve import MIN_STOPS
from facecrf_ocio.values import Estimate

_BY_HAND = "merge it by hand: facecrf merge"


Tell = Callable[[Event], None]
Told = tuple[tuple[float, float], ...]


def merge_brackets(job: Job, place: Place, manifest: Manifest, tell: Tell) -> None:
    """Merge the brackets whose image is not there, or is not what it would be now.

    Raises
    ------
    OutputError
        If the disk is full, or the folder is not the one it was.
    PhotoError
        If the source vanishes meanwhile.
    """
    digest = job.recipe.sha256(__version__)
    with Workers(job.jobs, job.limits) as workers:
        merging = _Merging(job, place, manifest, workers, tell)
        for key in camera_keys(manifest, digest):
            with understanding(manifest.path):
                merging.camera(key, digest)
        merging.finish()


@dataclass(frozen=True, slots=True)
class _Wanted:
    """A bracket that is to be merged, or why not."""

    bracket: BracketNamed
    members: tuple[BracketPhoto, ...]
    basis: str

    def exposures(self, told: Told) -> Iterator[tuple[str, str, float, float]]:
        """Names and hashes of the photos, with what came of each."""
        for one, (stops, moved) in zip(self.members, told, strict=True):
            yield one.name, one.sha256, stops, moved


class _Merging:
    def __init__(
        self,
        job: Job,
        place: Place,
        manifest: Manifest,
        workers: Workers,
        tell: Tell,
    ) -> None:
        self.job, self.place, self.manifest = job, place, manifest
        self.workers, self.tell = workers, tell
        self.identity = source_identity(job.source)
        self.unchanged = Unchanged(manifest, place)
        self.alike: Alike = place.alike()
        self.pending: dict[str, _Wanted] = {}

    def camera(self, key: str, digest: str) -> None:
        """Merge the brackets of one camera."""
        like = Task(self.job.source, "", self.place, self.job.recipe)
        desk = Desk(self.manifest, key, like, digest)
        for bracket in brackets_of(self.manifest, key):
            members = tuple(exposures(self.manifest, key, digest, bracket.name))
            wanted = _Wanted(bracket, members, _basis(digest, bracket, members))
            if not self._is_done(wanted):
                self._begin(wanted, desk)

    def _is_done(self, wanted: _Wanted) -> bool:
        """Whether what is to be done came of the bracket before."""
        name = wanted.bracket.name
        basis, outcome = former_merge(self.manifest, name)
        if basis != wanted.basis or (outcome == FAILED and self.job.retry):
            return False
        file = merged_file(self.manifest, name)
        there = [one for one in self.manifest.outputs(name) if one.name == file]
        if outcome == MERGED and not (there and self.unchanged.is_output(there[0])):
            return False
        self.tell(Event(name, Result(outcome), fresh=False, step=BRACKET))
        return True

    def _begin(self, wanted: _Wanted, desk: Desk) -> None:
        name = wanted.bracket.name
        span = wanted.bracket.stops
        short = span < MIN_STOPS
        task = Task(
            self.job.source / name,
            name,
            self.place,
            self.job.recipe,
            overwrite=self.job.overwrite,
            step=MERGE,
            estimate=None if short else self._curve(wanted.bracket, desk),
            series=_series(self.job, wanted.members),
        )
        problem = in_the_way(self.manifest, task, self.alike)
        if problem is not None:
            self.tell(Event(name, problem, fresh=True, step=BRACKET))
        elif short:
            reason = f"its exposures span {span:.1f} stops, fewer than {MIN_STOPS:g}"
            self._record(task, wanted, Result(NOT_MERGED, reason=reason, remedy=_BY_HAND))
        else:
            self._submit(task, wanted)

    def _submit(self, task: Task, wanted: _Wanted) -> None:
        (planned,) = task.planned
        free = None if os.path.lexists(self.place.inside(planned)) else planned
        with self.manifest.transaction():
            merge_begins(self.manifest, task.name, free)
        self.pending[task.name] = wanted
        self.workers.submit(replace(task, overwrite=True))
        while self.workers.busy >= self.workers.capacity:
            self._collect()

    def _curve(self, bracket: BracketNamed, desk: Desk) -> Estimate | None:
        """The curve that the bracket's photos get; None if its photos are to be asked again."""
        return desk.bracket_curve(bracket.name) if bracket.used else desk.camera_curve()

    def finish(self) -> None:
        """Wait for what is still being merged, and remove images of what is no bracket any more."""
        while self.workers.busy:
            self._collect()
        self.unchanged.record()
        for name in merges_without_bracket(self.manifest):
            file = merged_file(self.manifest, name)
            self.place.remove([file] if file else [])
            with self.manifest.transaction():
                forget_merge(self.manifest, name, file)

    def _collect(self) -> None:
        for task, result in self.workers.results():
            if result.stop:
                raise OutputError(result.stop)
            if result.outcome == FAILED and source_identity(self.job.source) != self.identity:
                raise PhotoError(self.job.source, "is no longer the folder it was", MOUNT)
            self._record(task, self.pending.pop(task.name), result)

    def _record(self, task: Task, wanted: _Wanted, result: Result) -> None:
        former = merged_file(self.manifest, task.name)
        if former and not result.outputs:
            self.place.remove([former])
        row = MergeRow(
            task.name,
            wanted.basis if result.lasting else "",
            result.outcome,
            result.reason,
            result.remedy,
            tuple(wanted.exposures(result.merged)) if result.merged else (),
        )
        with self.manifest.transaction():
            forget_merge(self.manifest, task.name, former or task.planned[0])
            merge_ends(self.manifest, row, result.outputs)
        self.tell(Event(task.name, result, fresh=True, step=BRACKET))


def _series(job: Job, members: tuple[BracketPhoto, ...]) -> Series:
    return Series(
        tuple(job.source / one.name for one in members),
        tuple(one.sha256 for one in members),
        tuple(stops_of(members).tolist()),
        len({one.shot.aperture for one in members}) > 1,
    )


def _basis(digest: str, bracket: BracketNamed, members: tuple[BracketPhoto, ...]) -> str:
    """Hash of all that an image depends on."""
    photos = [[key_of(one.name), one.sha256] for one in members]
    said = json.dumps([digest, bracket.used, bracket.curve_sha256, photos])
    return hashlib.sha256(said.encode()).hexdigest()
