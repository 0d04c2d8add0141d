"""Work that needs no answer, done in a thread beside other work."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import Thread


@contextmanager
def beside(work: Callable[[], object]) -> Iterator[None]:
    """Do some work while the block runs, and end when both are done.

    What it raises is lost: it is loading alone, and whoever needs what could not be loaded tries
    again and meets the same error where it can be told.
    """

    def quietly() -> None:
        with suppress(Exception):
            work()

    thread = Thread(target=quietly)
    thread.start()
    try:
        yield
    finally:
        thread.join()
