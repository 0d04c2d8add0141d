"""Photos worked on by an existing Dask cluster; to `run.py` workers like those of this machine.

The cluster gets a bounded number of photos at a time. A worker that is lost costs nothing: Dask
gives its photos to others, and as outputs appear whole or not at all and are the same bytes
wherever they are made, it does not matter how far the lost one got.
"""

from __future__ import annotations

import os
import queue
from collections import deque
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

from facecrf_ocio import __version__
from facecrf_ocio.archive.task import FAILED, Result, Task
from facecrf_ocio.archive.work.cluster import (
    LARGEST,
    Cluster,
    connect,
    require_equal_workers,
    unlike,
)
from facecrf_ocio.archive.work.delivered import accepted, odd_answer
from facecrf_ocio.archive.work.parcel import Delivery, Parcel, unpack
from facecrf_ocio.archive.work.processes import Limits, Workers
from facecrf_ocio.cameras.known_cameras import own_cameras
from facecrf_ocio.errors import ClusterError, OutputError, SettingsError, reason_of
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.files.versions import versions

if TYPE_CHECKING:
    from distributed import Client, Future

# [s] between looks whether the scheduler is still there; soon for people, seldom for a cluster.
_POLL = 0.25
_COUNT_AGAIN = 5.0  # [s] after which the workers are counted anew
_RETRIES = 2  # of work that failed there, by other workers; a third failure ends the run
_MARK = ".facecrf-mark-"
_GO_ON = "what is done stays done; start again to go on"


class ClusterWorkers:
    """What `Workers` are, on a cluster; use it as a context manager.

    Raises
    ------
    SettingsError
        If `distributed` is not installed.
    ClusterError
        If the scheduler cannot be reached, has no workers, or a worker has other versions.
    """

    def __init__(self, cluster: Cluster, limits: Limits, folder: Path) -> None:
        try:
            import distributed  # noqa: F401, PLC0415 - an extra
        except ImportError:
            raise SettingsError(
                "a scheduler needs the extra cluster: pip install 'facecrf-ocio[cluster]'"
            ) from None
        self.cluster, self.limits = cluster, limits
        self.shipping = bool(cluster.ship)
        self._versions = versions()
        self._processors: frozenset[str] = frozenset()
        self._mark = folder / f"{_MARK}{os.urandom(8).hex()}"
        self._flying: dict[str, tuple[Future, Task, bool]] = {}  # whether its photo was sent
        self._answers: deque[tuple[Task, Result]] = deque()
        self._landed: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._client: Client
        self._open = ExitStack()
        self._number = 0
        self._threads, self._counted = 1, float("-inf")

    def __enter__(self) -> ClusterWorkers:
        try:
            self._client = connect(self.cluster, self._open)
            self._processors = require_equal_workers(self._client, self._versions)
            self._set_mark()
        except BaseException:
            self._open.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()
        self._flying.clear()

    @property
    def capacity(self) -> int:
        """Photos to be handed out at a time: a few more than the cluster works on at once."""
        if monotonic() - self._counted > _COUNT_AGAIN:
            with suppress(OSError):
                self._threads = max(1, sum(self._client.nthreads().values()))
            self._counted = monotonic()
        return self._threads + max(1, self._threads // 4)

    @property
    def busy(self) -> int:
        """Photos handed out and not yet answered."""
        return len(self._flying) + len(self._answers)

    def processors(self) -> frozenset[str]:
        """Kinds of processors that work when the run begins."""
        return self._processors

    def submit(self, task: Task) -> None:
        """Hand out a photo."""
        try:
            status = task.source.stat()
            shippable = status.st_size <= LARGEST
            photo = task.source.read_bytes() if self.shipping and shippable else None
        except OSError:
            self._answers.append((task, self._here(task)))
            return
        if self.shipping and photo is None:
            self._answers.append((task, self._here(task)))
            return
        parcel = Parcel(
            replace(task, cameras=own_cameras()),
            self.limits,
            source=task.source.absolute(),
            folder=task.place.folder.absolute(),
            versions=self._versions,
            digest=task.recipe.sha256(__version__),
            mark=self._mark.absolute(),
            size=status.st_size,
            mtime_ns=status.st_mtime_ns,
            photo=photo,
        )
        self._number += 1
        key = f"{self._mark.name.removeprefix('.')}-{self._number}"
        future = self._client.submit(unpack, parcel, key=key, pure=False, retries=_RETRIES)
        self._flying[key] = future, task, photo is not None
        future.add_done_callback(lambda done: self._landed.put(str(done.key)))

    def results(self) -> Iterator[tuple[Task, Result]]:
        """Wait until at least one photo is answered, and yield those that are."""
        answered = False
        while self._answers:
            answered = True
            yield self._answers.popleft()
        while self._flying and not (answered and self._landed.empty()):
            try:
                key = self._landed.get(timeout=_POLL)
            except queue.Empty:
                self._require_connection()
                continue
            if key in self._flying:
                task, result = self._answer(*self._flying.pop(key))
                if result is not None:
                    answered = True
                    yield task, result
                elif self._answers:
                    answered = True
                    yield self._answers.popleft()

    def _answer(self, future: Future, task: Task, sent: bool) -> tuple[Task, Result | None]:
        """Return what came of a photo, None if it was handed out anew."""
        from distributed import KilledWorker  # noqa: PLC0415 - an extra

        delivery: Any  # whatever the worker's machine sends
        try:
            delivery = future.result()
        except KilledWorker as error:
            lost = f"took {error.allowed_failures + 1} of the cluster's workers with it"
            return task, Result(FAILED, reason=lost)
        except Exception as error:
            self._require_connection()
            problem = (str(error) or type(error).__name__).partition("\n")[0]
            raise ClusterError(
                f"{self.cluster.address}: a worker could not do its work: {problem}; {_GO_ON}"
            ) from error
        finally:
            future.release()
        if not isinstance(delivery, Delivery) or not isinstance(delivery.unlike, str):
            return task, odd_answer("it is no delivery")
        if delivery.unlike:
            raise ClusterError(unlike("a worker", plain_text(delivery.unlike)))
        if delivery.result is None:
            self._ship_from_now_on(plain_text(delivery.unseen))
            self.submit(task)
            return task, None
        return task, accepted(task, delivery, shipped=sent)

    def _ship_from_now_on(self, unseen: str) -> None:
        if self.cluster.ship is False:
            raise ClusterError(
                f"{unseen}: a worker of {self.cluster.address} does not see it as it is here; "
                "mount it there under the same path, or pass ship=True"
            )
        self.shipping = True

    def _here(self, task: Task) -> Result:
        """Work on what cannot be shipped, or not even read."""
        with Workers(1, self.limits) as workers:
            workers.submit(task)
            while workers.busy:
                for _, result in workers.results():
                    return result
        raise AssertionError("workers answer every photo")

    def _set_mark(self) -> None:
        folder = self._mark.parent
        for former in folder.glob(f"{_MARK}*"):  # of a run that was killed
            former.unlink(missing_ok=True)
        try:
            self._mark.touch(exist_ok=False)
        except OSError as error:
            problem = reason_of(error)
            raise OutputError(
                f"{self._mark}: cannot be written: {problem}; choose another folder"
            ) from error
        self._open.callback(self._mark.unlink, missing_ok=True)

    def _require_connection(self) -> None:
        if self._client.status != "running":
            raise ClusterError(f"{self.cluster.address}: the scheduler was lost; {_GO_ON}")
