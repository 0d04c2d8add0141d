"""A run over an archive: what is to be done, handing it out, and recording what came of it."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from facecrf_ocio import __version__
from facecrf_ocio.archive.manifest.database import (
    DONE,
    GATHERED,
    STARTED,
    UNSEEN,
    WRITING,
    Known,
    Manifest,
    Stamp,
)
from facecrf_ocio.archive.manifest.duplicates import from_twin, mark_duplicates
from facecrf_ocio.archive.walk import name_of
from facecrf_ocio.archive.work.processes import Limits, Pool
from facecrf_ocio.archive.work.status import status_of
from facecrf_ocio.archive.work.task import FAILED, GATHER, WHOLE, Recipe, Result, Task
from facecrf_ocio.errors import OutputError, PhotoError, reason_of
from facecrf_ocio.files.content import fingerprint_of, sha256_of
from facecrf_ocio.files.folders import make_folder

if TYPE_CHECKING:
    from facecrf_ocio.archive.work.dask_cluster import Cluster, ClusterPool

LOCK = "facecrf-manifest.lock"
TEMPORARY = ".facecrf-*"
REOPENED = "reopened"
_MOUNT = "mount it, or check the name, and start again"


@dataclass(frozen=True, slots=True)
class Job:
    """What is asked of a run.

    Attributes
    ----------
    source, folder
        Root of the photos, and of the outputs.
    recipe
        How to treat each photo.
    jobs, limits
        Number of worker processes, and what one photo may cost.
    overwrite
        Replace files that are not outputs of this archive.
    retry
        Try photos again that failed before, though nothing changed.
    cluster
        Work there instead of in processes of this machine; `jobs` is without effect then.
    """

    source: Path
    folder: Path
    recipe: Recipe
    jobs: int = 1
    limits: Limits = field(default_factory=Limits)
    overwrite: bool = False
    retry: bool = False
    cluster: Cluster | None = None


@dataclass(frozen=True, slots=True)
class Event:
    """Something came of a photo.

    Attributes
    ----------
    name, result
        The photo, and what came of it.
    fresh
        False if it was done by an earlier run.
    step
        `DONE`: it is accounted for. `GATHERED`: its evidence is known. `REOPENED`: it was accounted
        for, with this result, and is now written again with another curve of its camera.
    """

    name: str
    result: Result
    fresh: bool
    step: str = DONE


@dataclass(frozen=True, slots=True)
class _Pending:
    stamp: Stamp
    fingerprint: str


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
    identity = _identity(job.source)
    make_folder(job.folder)
    with _alone(job.folder):
        manifest = Manifest(job.folder)
        try:
            _require_same_source(manifest, job.source)
            _clear_leftovers(manifest, job.folder)
            with _pool(job) as pool:
                _Run(job, manifest, pool, identity, tell).through(photos)
            if job.cluster is not None:
                _clear_lost_workers(job.folder)
        finally:
            manifest.close()


def _pool(job: Job) -> Pool | ClusterPool:
    if job.cluster is None:
        return Pool(job.jobs, job.limits)
    from facecrf_ocio.archive.work.dask_cluster import ClusterPool  # noqa: PLC0415 - heavy

    return ClusterPool(job.cluster, job.limits, job.folder)


class _Run:
    def __init__(
        self,
        job: Job,
        manifest: Manifest,
        pool: Pool | ClusterPool,
        identity: tuple[int, int],
        tell: Callable[[Event], None],
    ) -> None:
        self.job, self.manifest, self.pool, self.tell = job, manifest, pool, tell
        self.identity = identity
        self.recipe = job.recipe.sha256(__version__)
        self.step = GATHER if job.recipe.pool else WHOLE
        self.pending: dict[str, _Pending] = {}

    def through(self, photos: Iterable[Path]) -> None:
        seen = False
        self.manifest.forget_unseen()
        for task in self._to_do(photos):
            seen = True
            self._submit(task)
        self._collect_all()
        if not seen:
            self._require_source()
        mark_duplicates(self.manifest)
        if self.job.recipe.pool:
            self._write_waiting()

    def _submit(self, task: Task) -> None:
        self.pool.submit(task)
        while self.pool.busy >= self.pool.capacity:
            self._collect()

    def _collect_all(self) -> None:
        while self.pool.busy:
            self._collect()

    def _write_waiting(self) -> None:
        # Only here, because they bring OpenCV and the networks into this process.
        from facecrf_ocio.archive.cameras.settle import settle  # noqa: PLC0415
        from facecrf_ocio.archive.manifest.waiting import waiting  # noqa: PLC0415

        def reopened(name: str, result: Result) -> None:
            self.tell(Event(name, result, fresh=False, step=REOPENED))

        job = self.job
        settle(self.manifest, self.recipe, job.recipe.prior, reopened)
        for task, result in waiting(self.manifest, job.source, job.folder, job.recipe, self.recipe):
            if result is not None:
                self._record_written(task, result)
            elif os.path.lexists(task.source):
                with self.manifest.transaction():
                    self.manifest.change(
                        "UPDATE photos SET state = ? WHERE name = ?", WRITING, task.name
                    )
                self._submit(task)
            else:
                self._require_source()
        self._collect_all()

    def _to_do(self, photos: Iterable[Path]) -> Iterator[Task]:
        count = 0
        for path in photos:
            count += 1
            task = self._decide(path)
            if task is not None:
                yield task
        if count == 0 and len(self.manifest):
            raise PhotoError(
                self.job.source, "holds no photo, though the manifest lists some", _MOUNT
            )

    def _decide(self, path: Path) -> Task | None:
        """Return what is to be done with a photo, None if nothing is."""
        name = name_of(path, self.job.source)
        try:
            status = status_of(path)
        except PhotoError as error:
            self._list_unseen(name, str(error))
            return None
        stamp = Stamp(status.st_size, status.st_mtime_ns, self.recipe)
        known = self.manifest.known(name)
        if known is not None and self._is_touched(known, stamp, path):
            with self.manifest.transaction():
                self.manifest.touch(name, stamp)
            known = replace(known, stamp=stamp)
        if known is not None and self._is_done(known, stamp):
            self.tell(Event(name, Result(known.outcome, known.verdict), fresh=False))
            return None
        if known is not None and self._is_gathered(known, stamp):
            self.tell(Event(name, Result(""), fresh=False, step=GATHERED))
            return None
        return self._begin(path, name, stamp, known)

    def _list_unseen(self, name: str, problem: str) -> None:
        """List what cannot be looked at; what is known of it from before stays as it is."""
        self._require_source()
        if self.manifest.known(name) is not None:
            return
        result = Result(FAILED, reason=problem)
        with self.manifest.transaction():
            self.manifest.finish(name, Stamp(UNSEEN, 0, self.recipe), result)
        self.tell(Event(name, result, fresh=True))

    def _begin(self, path: Path, name: str, stamp: Stamp, known: Known | None) -> Task | None:
        """Mark a photo as begun, and return what a worker is to do with it."""
        task = Task(path, name, self.job.folder, self.job.recipe, True, self.step)
        taken = None if self.job.overwrite else self._taken(task, known)
        fingerprint = fingerprint_of(path)
        self._wait_for_twin(fingerprint)
        self.pending[name] = _Pending(stamp, fingerprint)
        if taken is not None:
            problem = f"{taken}: exists already; pass --overwrite to replace it"
            self._record(task, Result(FAILED, reason=problem))
            return None
        with self.manifest.transaction():
            self.manifest.start(name, stamp)
        twin = from_twin(self.manifest, task, fingerprint, self.recipe)
        if twin is None:
            return task
        task, result = twin
        if result is not None:
            self._record(task, result)
            return None
        return task

    def _wait_for_twin(self, fingerprint: str) -> None:
        """Let a photo be finished that probably has the same bytes as the next one."""
        while fingerprint and any(p.fingerprint == fingerprint for p in self.pending.values()):
            self._collect()

    def _is_gathered(self, known: Known, stamp: Stamp) -> bool:
        return known.state in (GATHERED, WRITING) and known.stamp == stamp

    def _is_touched(self, known: Known, stamp: Stamp, path: Path) -> bool:
        """Whether a photo has another time, but the bytes that it had."""
        if known.state == STARTED or known.stamp == stamp or not known.sha256:
            return False
        if replace(known.stamp, mtime_ns=stamp.mtime_ns) != stamp:
            return False
        try:
            return sha256_of(path) == known.sha256
        except OutputError:
            return False

    def _is_done(self, known: Known, stamp: Stamp) -> bool:
        again = self.job.retry and known.outcome == FAILED
        return known.state == DONE and known.stamp == stamp and not again

    def _taken(self, task: Task, known: Known | None) -> Path | None:
        """Return a file in the way that is not this archive's own."""
        if known is not None and known.state != DONE:
            return None
        for planned in task.planned:
            path = task.folder / planned
            if os.path.lexists(path) and not self.manifest.has_output(planned):
                return path
        return None

    def _collect(self) -> None:
        for task, result in self.pool.results():
            if result.stop:
                raise OutputError(result.stop)
            if result.outcome == FAILED:
                self._require_source()
                if not os.path.lexists(task.source):  # its folder may be what was unmounted
                    with self.manifest.transaction():
                        self.manifest.forget(task.name)
                    self.pending.pop(task.name, None)
                    continue
                _remove(task.folder, task.planned)
            if task.name in self.pending:
                self._record(task, result)
            else:
                self._record_written(task, result)

    def _record(self, task: Task, result: Result) -> None:
        """Record what came of a photo that was looked at."""
        pending = self.pending.pop(task.name)
        if result.gathered is not None:
            key = json.dumps([*result.camera, result.shot.style], ensure_ascii=False)
            with self.manifest.transaction():
                self.manifest.gather(task.name, pending.stamp, result, pending.fingerprint, key)
            self.tell(Event(task.name, result, fresh=True, step=GATHERED))
            return
        self._remove_former(task, result)
        with self.manifest.transaction():
            self.manifest.finish(task.name, pending.stamp, result, pending.fingerprint)
        self.tell(Event(task.name, replace(result, outputs=()), fresh=True))

    def _record_written(self, task: Task, result: Result) -> None:
        """Record that a photo got the curve that was decided."""
        self._remove_former(task, result)
        with self.manifest.transaction():
            self.manifest.written(task.name, result)
        self.tell(Event(task.name, replace(result, outputs=()), fresh=True))

    def _remove_former(self, task: Task, result: Result) -> None:
        # Before the row, so that a run that is cut here finds them in its own unfinished row.
        own = {output.name for output in result.outputs}
        former = {output.name for output in self.manifest.outputs(task.name)}
        _remove(task.folder, former - own)

    def _require_source(self) -> None:
        if _identity(self.job.source) != self.identity:
            raise PhotoError(self.job.source, "is no longer the folder it was", _MOUNT)


def require_apart(source: Path, folder: Path) -> None:
    """Raise OutputError if outputs would lie among the photos, or photos among the outputs."""
    here, there = source.resolve(), folder.resolve()
    if here == there or here in there.parents or there in here.parents:
        raise OutputError(
            f"{folder}: lies inside of {source}, or around it; write to a folder of its own"
        )


def _identity(source: Path) -> tuple[int, int]:
    """Device and inode of a folder: another file system mounted, or none, has others."""
    try:
        status = source.stat()
    except OSError:
        raise PhotoError(source, "is not there", _MOUNT) from None
    if not source.is_dir():
        raise PhotoError(source, "is not a folder", "name the folder of the photos")
    return status.st_dev, status.st_ino


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Keep other runs out of a folder; the lock ends with the process, however that ends."""
    try:
        file = (folder / LOCK).open("a")
    except OSError as error:
        reason = reason_of(error)
        problem = f"{folder}: cannot be written: {reason}; choose a folder you may write to"
        raise OutputError(problem) from error
    with file as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise OutputError(f"{folder}: another run is at work there; wait for it") from None
        yield


def _require_same_source(manifest: Manifest, source: Path) -> None:
    """Names are relative to the source, so two sources in one folder would be confused."""
    here, there = os.fsencode(source.resolve()).decode("utf-8", "backslashreplace"), "source"
    former = manifest.about(there)
    if former is not None and former != here:
        raise OutputError(f"{manifest.path}: is of the photos in {former}; write elsewhere")
    manifest.note(there, here)


def _clear_leftovers(manifest: Manifest, folder: Path) -> None:
    """Remove temporary files of a run that was killed."""
    for place in {(folder / name).parent for name in manifest.started()}:
        for leftover in place.glob(TEMPORARY):
            leftover.unlink(missing_ok=True)


def _clear_lost_workers(folder: Path) -> None:
    """Remove temporary files of cluster workers that were lost; their photos were done again."""
    for leftover in folder.rglob(TEMPORARY):
        leftover.unlink(missing_ok=True)


def _remove(folder: Path, names: Iterable[str]) -> None:
    for name in names:
        with suppress(OSError):
            (folder / name).unlink()
