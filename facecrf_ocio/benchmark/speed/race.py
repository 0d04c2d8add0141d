"""Calls that take turns, so that a busy machine hits all alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

Call = Callable[[], object]


@dataclass(frozen=True, slots=True)
class Timed:
    """One call's best time.

    Attributes
    ----------
    work
        What is done, such as `uint8 to float16`.
    by
        Who does it.
    seconds
        The shortest of several runs.
    cpu
        The least seconds of processor time of several runs, all threads together.
    rate
        [megapixel / s]
    """

    work: str
    by: str
    seconds: float
    cpu: float
    rate: float


def race(work: str, calls: Mapping[str, Call], size: float, repeat: int) -> Iterator[Timed]:
    """Time calls of one work on `size` megapixels, each once a round, in `repeat` rounds."""
    runs: dict[str, list[tuple[float, float]]] = {name: [] for name in calls}
    for _ in range(repeat):
        for name, call in calls.items():
            start, cpu = time.perf_counter(), time.process_time()
            call()
            runs[name].append((time.perf_counter() - start, time.process_time() - cpu))
    for name, times in runs.items():
        seconds, spent = (min(column) for column in zip(*times, strict=True))
        yield Timed(work, name, seconds, spent, size / seconds)
