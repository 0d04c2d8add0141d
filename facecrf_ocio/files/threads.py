"""One thread for each process: the processes are the parallelism.

With several threads, sums are added in an order that depends on their number, and results differ in
the last digits from machine to machine. Libraries read these variables when they are loaded.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager

ONE_THREAD = dict.fromkeys(
    (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "BLIS_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    ),
    "1",
)
_ENVIRONMENT = threading.Lock()


@contextmanager
def single_threaded() -> Iterator[None]:
    """Let processes that are started meanwhile inherit the limit; one caller at a time."""
    with _ENVIRONMENT:
        former = {name: os.environ.get(name) for name in ONE_THREAD}
        os.environ.update(ONE_THREAD)
        try:
            yield
        finally:
            for name, value in former.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value
