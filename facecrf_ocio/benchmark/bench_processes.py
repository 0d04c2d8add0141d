"""Tasks to worker processes, results back as they come."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import Any, Protocol, TypeVar

from facecrf_ocio.benchmark.cases import code_digest
from facecrf_ocio.benchmark.workbench import CaseResult
from facecrf_ocio.errors import FaceCRFError
from facecrf_ocio.files.threads import limit_to_one_thread

Plan = TypeVar("Plan")
Task = TypeVar("Task")
_Task_contra = TypeVar("_Task_contra", contravariant=True)


class Bench(Protocol[_Task_contra]):
    """What measures a task: takes its photo, shows it to the estimators, and scores them."""

    def measure(self, task: _Task_contra, /) -> tuple[CaseResult, ...]:
        """Results of one task."""


_bench: Bench[Any] | None = None  # of a worker process


def measure_tasks(
    bench: Callable[[Plan], Bench[Task]], plan: Plan, tasks: Sequence[Task], jobs: int = 1
) -> Iterator[tuple[Task, tuple[CaseResult, ...]]]:
    """Measure tasks, each in one of `jobs` fresh processes of one thread; yields as they finish.

    Every process sets up `bench(plan)` for itself.

    One job, too, is a process of its own: only there can the threads of libraries that are loaded
    already be limited, on which the last digits depend.

    Raises
    ------
    FaceCRFError
        If a process is killed, which is mostly for want of memory.
    """
    if not tasks:
        return
    executor = ProcessPoolExecutor(
        min(jobs, len(tasks)),
        mp_context=multiprocessing.get_context("spawn"),
        initializer=_start_worker,
        initargs=(bench, plan, code_digest()),
    )
    try:
        futures = {executor.submit(_measure, task): task for task in tasks}
        for future in as_completed(futures):
            yield futures.pop(future), future.result()
    except BrokenProcessPool as error:
        raise FaceCRFError(
            "a worker process was killed; start again, with fewer --jobs if memory is short: "
            "finished cases are kept"
        ) from error
    finally:
        executor.shutdown(cancel_futures=True)


def _start_worker(bench: Callable[[Any], Bench[Any]], plan: object, code: str) -> None:
    global _bench  # noqa: PLW0603 - set once for the life of the process
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends the run
    threading.Thread(target=_die_with_parent, daemon=True).start()
    limit_to_one_thread()
    # Results of an edited package must not be stored under the keys of the former one.
    _bench = bench(plan) if code_digest() == code else None


def _die_with_parent() -> None:
    """Without this, workers of a parent that was killed would wait for tasks forever."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _measure(task: object) -> tuple[CaseResult, ...]:
    if _bench is None:
        raise FaceCRFError("the package was changed since this run began; start again")
    return _bench.measure(task)
