"""How many processes there may be, and one thread for each: the processes are the parallelism.

With several threads, sums are added in an order that depends on their number, and results differ in
the last digits from machine to machine.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TypeVar

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


def meanwhile(work: Callable[[], _T]) -> Callable[[], _T]:
    """Begin some work in a thread of its own; returns what waits for its result.

    Where OpenCV is held to one thread, as in the processes of a batch, it is done when its result
    is asked for.
    """
    import cv2  # noqa: PLC0415 - heavy

    return work if cv2.getNumThreads() < 2 else _begun(work)


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
    from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415 - not for `facecrf --help`

    pool = ThreadPoolExecutor(1)
    result = pool.submit(work).result
    pool.shutdown(wait=False)
    return result


@contextmanager
def one_opencv_thread() -> Iterator[None]:
    """Let OpenCV, which threadpoolctl does not know, work in one thread meanwhile."""
    import cv2  # noqa: PLC0415 - heavy

    former = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(former)
