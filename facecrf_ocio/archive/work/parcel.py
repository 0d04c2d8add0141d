"""The work on one photo as another machine does it. `unpack` is what a Dask worker calls.

It needs no `distributed`, only what `Workers` need: photos are worked on in a process of our own
there, too, which stays warm between photos and takes nothing else with it when it dies.
"""

from __future__ import annotations

import multiprocessing
import tempfile
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from facecrf_ocio import __version__
from facecrf_ocio.archive.place import Place
from facecrf_ocio.archive.task import Result, Task
from facecrf_ocio.archive.work.processes import Limits, Workers
from facecrf_ocio.files.folders import real_path
from facecrf_ocio.files.versions import difference, versions

_IDLE = 60.0  # [s] after which a process that nobody asks is let go


@dataclass(frozen=True, slots=True)
class Parcel:
    """One photo to be worked on elsewhere.

    Attributes
    ----------
    task, limits
        What is to be done, in paths of the client, and what it may cost.
    source, folder
        The paths of the task, absolute.
    versions, digest
        The client's `versions()` and hash of the recipe.
    mark
        File in the folder of outputs; a worker that finds it there sees the client's folder.
    size, mtime_ns
        Of the photo as the client sees it.
    photo
        The photo's bytes, None if the worker is to read it from `task.source`.
    """

    task: Task
    limits: Limits
    source: Path
    folder: Path
    versions: Mapping[str, str]
    digest: str
    mark: Path
    size: int
    mtime_ns: int
    photo: bytes | None = None


@dataclass(frozen=True, slots=True)
class Delivery:
    """What came of a parcel.

    Attributes
    ----------
    result
        None if it was not worked on, for one of the two reasons below.
    contents
        Bytes of `result.outputs` in their order, if the photo's bytes were in the parcel.
    unseen
        A path that the worker does not see as the client does, else empty.
    unlike
        How the worker's software differs from the client's, else empty.
    """

    result: Result | None = None
    contents: tuple[bytes, ...] = ()
    unseen: str = ""
    unlike: str = ""


def unpack(parcel: Parcel) -> Delivery:
    """Work on one photo; in a Dask worker."""
    unlike = difference(parcel.versions, versions())
    if not unlike and parcel.task.recipe.sha256(__version__) != parcel.digest:
        unlike = "the same version makes another recipe of these settings"
    if unlike:
        return Delivery(unlike=unlike)
    if parcel.photo is not None:
        return _at_home(parcel, parcel.photo)
    unseen = _unseen(parcel)
    if unseen is not None:
        return Delivery(unseen=str(unseen))
    place = Place(parcel.folder, real_path(parcel.folder))
    return Delivery(_work(parcel, parcel.source, place))


def _unseen(parcel: Parcel) -> Path | None:
    try:
        status = parcel.source.stat()
    except OSError:
        return parcel.source
    if (status.st_size, status.st_mtime_ns) != (parcel.size, parcel.mtime_ns):
        return parcel.source
    return None if parcel.mark.exists() else parcel.folder


def _at_home(parcel: Parcel, photo: bytes) -> Delivery:
    """Work on bytes in a temporary folder, and give back bytes."""
    with tempfile.TemporaryDirectory(prefix="facecrf-") as home:
        source, folder = Path(home, "photo", parcel.source.name), Path(home, "outputs")
        source.parent.mkdir()
        source.write_bytes(photo)
        folder.mkdir()
        result = _work(parcel, source, Place.of(folder))
        return Delivery(result, tuple((folder / one.name).read_bytes() for one in result.outputs))


def _work(parcel: Parcel, source: Path, place: Place) -> Result:
    """Work with these paths, and speak of the client's."""
    task = parcel.task
    result = _answer(replace(task, source=source, place=place), parcel.limits)
    told = {
        name: getattr(result, name)
        .replace(str(source), str(task.source))
        .replace(str(place.folder), str(task.place.folder))
        for name in ("reason", "remedy", "stop")
    }
    return replace(result, **told)


def _answer(task: Task, limits: Limits) -> Result:
    with _WARM.borrowed(limits) as workers:
        workers.submit(task)
        while workers.busy:
            for _, result in workers.results():
                return result
    raise AssertionError("workers answer every photo")


class _Warm:
    """Pools of one process each, kept for the next photo: one for each that is worked on."""

    def __init__(self) -> None:
        self._idle: list[tuple[Workers, threading.Timer]] = []
        self._lock = threading.Lock()

    @contextmanager
    def borrowed(self, limits: Limits) -> Iterator[Workers]:
        workers = self._take(limits)
        try:
            yield workers
        except BaseException:
            workers.close()
            raise
        timer = threading.Timer(_IDLE, self._let_go, (workers,))
        timer.daemon = True
        with self._lock:
            self._idle.append((workers, timer))
        timer.start()

    def _take(self, limits: Limits) -> Workers:
        with self._lock:
            for entry in reversed(self._idle):
                workers, timer = entry
                if workers.limits == limits:
                    timer.cancel()
                    self._idle.remove(entry)
                    return workers
        # Dask's nanny makes its workers daemons, which may have no children; ours end with them.
        multiprocessing.current_process().daemon = False
        return Workers(1, limits)

    def _let_go(self, workers: Workers) -> None:
        with self._lock:
            entry = next((entry for entry in self._idle if entry[0] is workers), None)
            if entry is None:  # it was taken a moment ago
                return
            self._idle.remove(entry)
        workers.close()


_WARM = _Warm()
