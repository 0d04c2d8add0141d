"""What one file costs this process and the one that asks OpenColorIO, by Linux's /proc."""

from __future__ import annotations

import os
import re
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage
from typing import NamedTuple

from facecrf_ocio.lut.usable import why_unusable

_TICK = os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")


class Cost(NamedTuple):
    """Processor time [s], and peak memory beyond what was resident before [MB]."""

    seconds: float
    megabytes: float


class Meter:
    """Meters file after file; `sound` is one that OpenColorIO takes at once."""

    def __init__(self, sound: Path) -> None:
        why_unusable(sound)
        (self._child,) = _children()
        # Beyond the start of the other process, which is no file's fault.
        self._start = _seconds_of(self._child)
        self._resident = _resident(self._child)

    def begin(self) -> None:
        self._processes = [os.getpid(), *_children()]
        self._before = {}
        for process in self._processes:
            Path(f"/proc/{process}/clear_refs").write_text("5")  # the peak begins anew
            self._before[process] = _resident(process)
        self._spent = _spent()
        self._largest = getrusage(RUSAGE_CHILDREN).ru_maxrss

    def end(self) -> Cost:
        now = _children()
        started = len(set(now) - set(self._processes))
        peaks = [
            _peak(process) - self._before.get(process, self._resident)
            for process in (os.getpid(), *now)
        ]
        largest = getrusage(RUSAGE_CHILDREN).ru_maxrss * 1024
        if largest > self._largest * 1024:  # of one that ended
            peaks.append(largest - self._resident)
        return Cost(_spent() - self._spent - started * self._start, max(peaks) / 1e6)


def _children() -> list[int]:
    """Processes that ask OpenColorIO; earlier tests may have left others of this process."""
    here = os.getpid()
    listed = Path(f"/proc/{here}/task/{here}/children").read_text().split()
    return [int(process) for process in listed if b"ocio_child" in _command(process)]


def _command(process: str) -> bytes:
    try:
        return Path(f"/proc/{process}/cmdline").read_bytes()
    except OSError:  # it ended meanwhile
        return b""


def _spent() -> float:
    """[s] Of this process and all that it started, ended or not."""
    here, ended = getrusage(RUSAGE_SELF), getrusage(RUSAGE_CHILDREN)
    done = here.ru_utime + here.ru_stime + ended.ru_utime + ended.ru_stime
    return done + sum(_seconds_of(process) for process in _children())


def _seconds_of(process: int) -> float:
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICK


def _resident(process: int) -> int:
    return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * _PAGE


def _peak(process: int) -> int:
    """[byte]"""
    status = Path(f"/proc/{process}/status").read_text()
    found = re.search(r"VmHWM:\s*(\d+) kB", status)
    assert found
    return int(found[1]) * 1024
