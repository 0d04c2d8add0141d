"""Worker processes that stay warm, and of which each death costs one photo alone.

A decoder that crashes, hangs or eats the memory takes its process with it. The photo is tried once
more after a crash, for the fault may have been the machine's, and not after a time-out or too much
memory, which would only cost the same again. Workers are replaced after `Limits.photos_per_worker`
photos, so that what libraries leak does not add up.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from pathlib import Path
from time import monotonic

from facecrf_ocio.archive.task import FAILED, Result, Task
from facecrf_ocio.files.processor import processor
from facecrf_ocio.files.threads import limit_to_one_thread

_POLL = 0.25  # [s] between looks at limits of time and memory, which are told in seconds


@dataclass(frozen=True, slots=True)
class Limits:
    """What one photo may cost.

    Attributes
    ----------
    seconds
        [s] Of wall time.
    megabytes
        [MB] Of resident memory of a worker; needs /proc, and is not watched elsewhere.
    photos_per_worker
        After so many photos a worker is replaced.
    """

    seconds: float = 300.0
    megabytes: int = 4096
    photos_per_worker: int = 500


@dataclass(slots=True)
class _Worker:
    process: SpawnProcess
    pipe: Connection
    task: Task | None = None
    since: float = 0.0
    photos: int = 0
    ready: bool = False


class Workers:
    """Some processes that run `one_photo.process`; use it as a context manager."""

    def __init__(self, jobs: int, limits: Limits) -> None:
        self.jobs, self.limits = jobs, limits
        self._context = multiprocessing.get_context("spawn")
        self._workers: list[_Worker] = []
        self._waiting: deque[Task] = deque()
        self._tried: set[str] = set()

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End its processes, whatever they are at."""
        for worker in self._workers:
            worker.process.kill()
            worker.process.join()
            worker.pipe.close()
        self._workers.clear()

    @property
    def capacity(self) -> int:
        """Photos to be handed out at a time.

        One a worker waits, so that no worker does while photos are recorded and looked for.
        """
        return 2 * self.jobs

    @property
    def busy(self) -> int:
        """Photos handed out and not yet answered."""
        return sum(worker.task is not None for worker in self._workers) + len(self._waiting)

    def processors(self) -> frozenset[str]:
        """Kinds of processors that work."""
        return frozenset((processor(),))

    def submit(self, task: Task) -> None:
        """Hand out a photo."""
        self._waiting.append(task)
        self._hand_out()

    def results(self) -> Iterator[tuple[Task, Result]]:
        """Wait until at least one photo is answered, and yield those that are."""
        answers: list[tuple[Task, Result]] = []
        while self.busy and not answers:
            wait([worker.pipe for worker in self._workers if worker.task], timeout=_POLL)
            looked = [self._look_at(worker) for worker in tuple(self._workers)]
            answers = [answer for answer in looked if answer is not None]
            self._hand_out()
        yield from answers

    def _hand_out(self) -> None:
        """Give waiting photos to idle workers, new ones if there are fewer than there may be."""
        while self._waiting:
            worker = next((one for one in self._workers if one.task is None), None)
            if worker is None and len(self._workers) >= self.jobs:
                return
            self._give(worker or self._hire(), self._waiting.popleft())

    def _give(self, worker: _Worker, task: Task) -> None:
        worker.task, worker.since = task, monotonic()
        with contextlib.suppress(OSError):  # it died while idle: a crash, and tried again
            worker.pipe.send(task)

    def _look_at(self, worker: _Worker) -> tuple[Task, Result] | None:
        if worker.task is None:
            return None
        try:
            while worker.pipe.poll():
                answer = worker.pipe.recv()
                if answer is None:  # it has started; only now does the photo's own time count
                    worker.ready, worker.since = True, monotonic()
                    continue
                return self._answered(worker, answer)
        except (EOFError, OSError):
            return self._crashed(worker)
        if worker.ready and monotonic() - worker.since > self.limits.seconds:
            reason = f"took longer than {self.limits.seconds:g} s and was stopped"
            return self._stopped(worker, reason, "seconds=...")
        if _resident_megabytes(worker.process.pid) > self.limits.megabytes:
            reason = f"needed more than {self.limits.megabytes} MB of memory and was stopped"
            return self._stopped(worker, reason, "megabytes=...")
        return None

    def _answered(self, worker: _Worker, result: Result) -> tuple[Task, Result]:
        task, worker.task = worker.task, None
        assert task is not None  # noqa: S101 - looked at only while it has a task
        self._tried.discard(task.name)
        worker.photos += 1
        if worker.photos >= self.limits.photos_per_worker:
            self._dismiss(worker)
        return task, result

    def _crashed(self, worker: _Worker) -> tuple[Task, Result] | None:
        task = worker.task
        self._dismiss(worker)
        assert task is not None  # noqa: S101
        if task.name not in self._tried:
            self._tried.add(task.name)
            self._waiting.appendleft(task)
            return None
        self._tried.discard(task.name)
        code = worker.process.exitcode or 0
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        reason = f"crashed the process that read it, twice ({how})"
        return task, Result(FAILED, reason=reason, remedy="convert it to TIFF by another program")

    def _stopped(self, worker: _Worker, reason: str, limit: str) -> tuple[Task, Result]:
        task = worker.task
        self._dismiss(worker)
        assert task is not None  # noqa: S101
        remedy = f"use a smaller version of it, or raise {limit} and pass retry=True"
        return task, Result(FAILED, reason=reason, remedy=remedy)

    def _dismiss(self, worker: _Worker) -> None:
        worker.process.kill()
        worker.process.join()
        worker.pipe.close()
        self._workers.remove(worker)

    def _hire(self) -> _Worker:
        ours, theirs = self._context.Pipe()
        process = self._context.Process(target=_serve, args=(theirs,), daemon=True)
        with _interrupts_held_back():
            process.start()
        theirs.close()
        worker = _Worker(process, ours)
        self._workers.append(worker)
        return worker


@contextlib.contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Let a process inherit that Ctrl-C waits, so that it says nothing of one while it starts.

    This process gets a Ctrl-C of meanwhile a moment later.
    """
    resource_tracker.ensure_running()  # its start would let them through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _serve(pipe: Connection) -> None:
    """Work on photos until the parent ends, however it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides what an interrupt means
    _die_with_parent()
    from facecrf_ocio.archive.work.one_photo import process  # noqa: PLC0415 - not in the parent

    limit_to_one_thread()
    pipe.send(None)
    with contextlib.suppress(EOFError):
        while True:
            pipe.send(process(pipe.recv()))


def _die_with_parent() -> None:
    """End at once with the parent, so that a killed run does not write into the next one."""
    parent = multiprocessing.parent_process()
    if parent is None:
        return

    def watch(sentinel: int) -> None:
        wait([sentinel])
        os._exit(1)

    threading.Thread(target=watch, args=(parent.sentinel,), daemon=True).start()
    if sys.platform == "linux":
        import ctypes  # noqa: PLC0415

        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG, linux/prctl.h
        if not parent.is_alive():
            os._exit(1)


def _resident_megabytes(pid: int | None) -> float:
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    except (OSError, IndexError):
        return 0.0
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6
