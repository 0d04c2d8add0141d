"""How many processes there may be, and one thread for each: the processes are the parallelism.

With several threads, sums are added in an order that depends on their number, and results differ in
the last digits from machine to machine.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from threading import Lock
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from concurrent.futures import ThreadPoolExecutor

_T = TypeVar("_T")


def usable_cores() -> int:
    """Cores that this process may run on, which can be fewer than there are."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def limit_to_one_thread() -> None:
    """Let all libraries of this process work in one thread, from now on and for good."""
    import cv2  # noqa: PLC0415 - heavy, and only for those who work on photos
    import scipy.linalg  # noqa: F401, PLC0415 - brings a BLAS of its own, which must be there
    from threadpoolctl import threadpool_limits  # noqa: PLC0415

    threadpool_limits(1)
    cv2.setNumThreads(1)


class OtherThread:
    """A thread beside this one, which does one work after the other until the block ends.

    Where OpenCV is held to one thread, as in the processes of a batch, there is none, and each work
    is done when its result is asked for. What was begun and not asked for by the end is dropped.
    """

    def __init__(self) -> None:
        import cv2  # noqa: PLC0415 - heavy

        self._executor = _executor() if cv2.getNumThreads() > 1 else None

    def __enter__(self) -> OtherThread:
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Let the thread end."""
        if self._executor is not None:
            self._executor.shutdown(wait=False, cancel_futures=True)

    def begin(self, work: Callable[[], _T]) -> Callable[[], _T]:
        """Begin some work when that before is done; returns what waits for its result."""
        return work if self._executor is None else self._executor.submit(work).result


@contextmanager
def beside(work: Callable[[], object]) -> Iterator[None]:
    """Do some work in a thread while the block runs, and end when both are done.

    What it raises is lost: it is loading alone, and whoever needs what could not be loaded tries
    again and meets the same error where it can be told.
    """
    done = _begun(work)
    try:
        yield
    finally:
        with suppress(Exception):
            done()


def _begun(work: Callable[[], _T]) -> Callable[[], _T]:
    executor = _executor()
    result = executor.submit(work).result
    executor.shutdown(wait=False)
    return result


def _executor() -> ThreadPoolExecutor:
    from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415 - not for `facecrf --help`

    return ThreadPoolExecutor(1)


class WhileAny:
    """What holds for the whole process while any of its threads is inside of a block.

    Were it begun and ended by each thread alone, one could take another's beginning for the former
    state, and leave it behind for good.
    """

    def __init__(self, begin: Callable[[], Callable[[], object]]) -> None:
        self._begin = begin
        self._end: Callable[[], object] = int  # that of nobody
        self._inside, self._lock = 0, Lock()

    @contextmanager
    def __call__(self) -> Iterator[None]:
        """Begin it where nobody has, and end it where nobody else is inside."""
        with self._lock:
            if not self._inside:
                self._end = self._begin()
            self._inside += 1
        try:
            yield
        finally:
            with self._lock:
                self._inside -= 1
                if not self._inside:
                    self._end()


def _hold_opencv() -> Callable[[], object]:
    import cv2  # noqa: PLC0415 - heavy

    former = cv2.getNumThreads()
    cv2.setNumThreads(1)
    return partial(cv2.setNumThreads, former)


one_opencv_thread = WhileAny(_hold_opencv)
"""Lets OpenCV, which threadpoolctl does not know, work in one thread meanwhile."""
