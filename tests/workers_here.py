"""Photos worked on in this process: for tests of what is done with them, not of who does it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

import pytest

from facecrf_ocio.archive.task import Result, Task
from facecrf_ocio.archive.work import hired
from facecrf_ocio.archive.work.one_photo import process


class WorkersHere:
    """What `Workers` are, without processes of its own."""

    capacity = 2

    def __init__(self, *_: object) -> None:
        self._tasks: deque[Task] = deque()

    def __enter__(self) -> WorkersHere:
        return self

    def __exit__(self, *_: object) -> None:
        self._tasks.clear()

    def processors(self) -> frozenset[str]:
        return frozenset(("test",))

    @property
    def busy(self) -> int:
        return len(self._tasks)

    def submit(self, task: Task) -> None:
        self._tasks.append(task)

    def results(self) -> Iterator[tuple[Task, Result]]:
        task = self._tasks.popleft()
        yield task, process(task)


@pytest.fixture
def workers_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let runs work in this process."""
    monkeypatch.setattr(hired, "Workers", WorkersHere)
