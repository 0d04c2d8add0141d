"""A run over an archive: what is to be done, handing it out, and recording what came of it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from facecrf_ocio import __version__
from facecrf_ocio.archive.cameras.registry import reopen_measured
from facecrf_ocio.archive.in_the_way import Alike, in_the_way
from facecrf_ocio.archive.job import REOPENED, Event, Job
from facecrf_ocio.archive.manifest.database import DONE, GATHERED, WRITING, Manifest, Stamp
from facecrf_ocio.archive.manifest.twin_rows import mark_duplicates
from facecrf_ocio.archive.place import MOUNT, Place, alone, require_apart, source_identity
from facecrf_ocio.archive.recording import Begun, Recording
from facecrf_ocio.archive.task import FAILED, GATHER, WHOLE, Result, Task
from facecrf_ocio.archive.twins import from_twin
from facecrf_ocio.archive.unchanged import Unchanged
from facecrf_ocio.archive.walk import as_utf8, name_of
from facecrf_ocio.archive.work.hired import AnyWorkers, workers_of
from facecrf_ocio.archive.work.status import status_of
from facecrf_ocio.errors import OutputError, PhotoError
from facecrf_ocio.estimators import JOINT_NAMES
from facecrf_ocio.files.content import fingerprint_of
from facecrf_ocio.files.folders import make_folder, real_path


def run(job: Job, photos: Iterable[Path], tell: Callable[[Event], None]) -> None:
    """Do all that is not done yet.

    Raises
    ------
    OutputError
        If the folders lie inside each other, another run is at work there, the disk is full, or
        the manifest is another archive's. What is done stays done; start again to go on.
    PhotoError
        If the source vanishes while the run goes on, or is empty though it was not.
    ClusterError
        If the cluster cannot be reached, is not set up for the work, or was lost.
    """
    require_apart(job.source, job.folder)
    identity = source_identity(job.source)
    make_folder(job.folder)
    with alone(job.folder):
        place = Place.of(job.folder)
        manifest = Manifest(job.folder)
        try:
            _require_same_source(manifest, job.source)
            place.clear(manifest.started())
            with workers_of(job) as workers:
                recipe = job.recipe.sha256(__version__), job.recipe.to_json()
                manifest.note_run(*recipe, workers.processors())
                if job.recipe.estimator in JOINT_NAMES and not job.again:
                    reopen_measured(manifest)
                _Run(job, place, manifest, workers, identity, tell).through(photos)
            if job.recipe.merge:
                _merge_brackets(job, place, manifest, tell)
            if job.cluster is not None:
                place.clear_all()
        finally:
            manifest.close()


def _merge_brackets(
    job: Job, place: Place, manifest: Manifest, tell: Callable[[Event], None]
) -> None:
    from facecrf_ocio.archive.merges import merge_brackets  # noqa: PLC0415 - brings OpenCV

    merge_brackets(job, place, manifest, tell)


class _Run:
    def __init__(
        self,
        job: Job,
        place: Place,
        manifest: Manifest,
        workers: AnyWorkers,
        identity: tuple[int, int],
        tell: Callable[[Event], None],
    ) -> None:
        self.job, self.place, self.manifest = job, place, manifest
        self.workers, self.identity, self.tell = workers, identity, tell
        self.recipe_sha256 = job.recipe.sha256(__version__)
        self.step = GATHER if job.recipe.pool else WHOLE
        self.unchanged = Unchanged(manifest, place)
        self.alike: Alike = place.alike()
        self.pending: dict[str, Begun] = {}
        self.recording = Recording(place, manifest, self.recipe_sha256, tell)

    def through(self, photos: Iterable[Path]) -> None:
        seen = False
        if not self.job.again:
            self.manifest.forget_unseen()
        for task in self._to_do(photos):
            seen = True
            self._submit(task)
        self._collect_all()
        self.unchanged.record()
        if not seen:
            self._require_source()
        mark_duplicates(self.manifest)
        if self.job.recipe.pool:
            self._write_waiting()

    def _submit(self, task: Task) -> None:
        self.workers.submit(task)
        while self.workers.busy >= self.workers.capacity:
            self._collect()

    def _collect_all(self) -> None:
        while self.workers.busy:
            self._collect()

    def _to_do(self, photos: Iterable[Path]) -> Iterator[Task]:
        count = 0
        for path in photos:
            count += 1
            task = self._decide(path)
            if task is not None:
                yield task
        if count == 0 and len(self.manifest):
            raise PhotoError(
                self.job.source, "holds no photo, though the manifest lists some", MOUNT
            )

    def _decide(self, path: Path) -> Task | None:
        """Return what is to be done with a photo, None if nothing is."""
        name = name_of(path, self.job.source)
        try:
            status = status_of(path)
        except PhotoError as error:
            self._require_source()
            self.recording.unseen(name, Result(FAILED, reason=error.problem, remedy=error.remedy))
            return None
        stamp = Stamp(status.st_size, status.st_mtime_ns, self.recipe_sha256, status.st_ctime_ns)
        known = self.manifest.known(name)
        if known is None or not self.unchanged.is_photo(name, known, stamp, path):
            return self._begin(path, name, stamp)
        again = name in self.job.again or (self.job.retry and known.outcome == FAILED)
        if known.state == DONE and not again and self.unchanged.are_outputs(name):
            self.tell(Event(name, Result(known.outcome, known.verdict), fresh=False))
            return None
        if known.state in (GATHERED, WRITING):
            self.tell(Event(name, Result(""), fresh=False, step=GATHERED))
            return None
        return self._begin(path, name, stamp)

    def _begin(self, path: Path, name: str, stamp: Stamp) -> Task | None:
        """Mark a photo as begun, and return what a worker is to do with it."""
        recipe, overwrite = self.job.recipe, self.job.overwrite
        task = Task(path, name, self.place, recipe, overwrite=overwrite, step=self.step)
        problem = in_the_way(self.manifest, task, self.alike)
        if problem is not None:
            self.recording.hindered(task, problem)
            return None
        task = replace(task, overwrite=True)  # what is there is the archive's own, or given up
        fingerprint = fingerprint_of(path)
        self._wait_for_twin(fingerprint)
        self.pending[name] = Begun(stamp, fingerprint)
        with self.manifest.transaction():
            self.manifest.start(name, stamp, self._free(task))
        return self._from_twin(task, fingerprint)

    def _free(self, task: Task) -> list[str]:
        """Outputs that are not there yet: what a killed worker leaves of them is the archive's."""
        paths = task.place.all_inside(task.planned)
        named = zip(task.planned, paths, strict=True)
        return [name for name, path in named if not os.path.lexists(path)]

    def _from_twin(self, task: Task, fingerprint: str) -> Task | None:
        twin = from_twin(self.manifest, task, fingerprint, self.recipe_sha256)
        if twin is None:
            return task
        task, result = twin
        if result is None:
            return task
        self.recording.looked_at(task, self.pending.pop(task.name), result)
        return None

    def _wait_for_twin(self, fingerprint: str) -> None:
        """Let a photo be finished that probably has the same bytes as the next one."""
        while fingerprint and any(p.fingerprint == fingerprint for p in self.pending.values()):
            self._collect()

    def _write_waiting(self) -> None:
        # Only here, because they bring OpenCV and the networks into this process.
        from facecrf_ocio.archive.cameras.settle import settle  # noqa: PLC0415
        from facecrf_ocio.archive.cameras.waiting import waiting  # noqa: PLC0415

        def reopened(name: str, result: Result) -> None:
            self.tell(Event(name, result, fresh=False, step=REOPENED))

        job = self.job
        settle(self.manifest, self.recipe_sha256, job.recipe, reopened)
        like = Task(job.source, "", self.place, job.recipe, overwrite=job.overwrite)
        for task, result in waiting(self.manifest, like, self.recipe_sha256):
            if result is not None:
                self.recording.written(task, result)
            else:
                self._write_one(task)
        self._collect_all()

    def _write_one(self, task: Task) -> None:
        problem = in_the_way(self.manifest, task, self.alike)
        if problem is not None:
            self.tell(Event(task.name, problem, fresh=True))
        elif os.path.lexists(task.source):
            with self.manifest.transaction():
                self.manifest.writing(task.name, self._free(task))
            self._submit(replace(task, overwrite=True))
        else:
            self._require_source()

    def _collect(self) -> None:
        for task, result in self.workers.results():
            if result.stop:
                raise OutputError(result.stop)
            if result.outcome == FAILED:
                self._require_source()
                if not os.path.lexists(task.source):  # its folder may be what was unmounted
                    self._forget(task)
                    continue
            if task.name in self.pending:
                self.recording.looked_at(task, self.pending.pop(task.name), result)
            else:
                self.recording.written(task, result)

    def _forget(self, task: Task) -> None:
        with self.manifest.transaction():
            self.manifest.forget(task.name)
        self.pending.pop(task.name, None)

    def _require_source(self) -> None:
        if source_identity(self.job.source) != self.identity:
            raise PhotoError(self.job.source, "is no longer the folder it was", MOUNT)


def _require_same_source(manifest: Manifest, source: Path) -> None:
    """Names are relative to the source, so two sources in one folder would be confused."""
    here, there = as_utf8(str(real_path(source))), "source"
    former = manifest.about(there)
    if former is not None and former != here:
        raise OutputError(f"{manifest.path}: is of the photos in {former}; write elsewhere")
    manifest.note(there, here)
