"""Every row of the table of speed, in one run."""

from __future__ import annotations

import platform
import subprocess
from collections.abc import Callable, Iterator, Sequence
from datetime import datetime, timezone
from pathlib import Path
from tempfile import TemporaryDirectory

from facecrf_ocio.benchmark.speed.linearize_rows import apply_rows, exr_rows
from facecrf_ocio.benchmark.speed.photo_rows import calibrate_rows
from facecrf_ocio.benchmark.speed.process_rows import batch_rows, cold_rows, memory_rows
from facecrf_ocio.benchmark.speed.report_rows import report_rows
from facecrf_ocio.benchmark.speed.speed_row import SpeedRow
from facecrf_ocio.files.threads import usable_cores

KINDS: dict[str, Callable[[Path, float, int], Iterator[SpeedRow]]] = {
    "calibrate": calibrate_rows,
    "cold": cold_rows,
    "apply": apply_rows,
    "exr": exr_rows,
    "batch": batch_rows,
    "memory": memory_rows,
    "report": report_rows,
}
"""What is measured, each by a generator of rows that takes a folder, the scale, and rounds."""


def measure_rows(
    kinds: Sequence[str] = tuple(KINDS), scale: float = 1.0, repeat: int = 5
) -> tuple[SpeedRow, ...]:
    """Measure the rows of some kinds, or of all.

    Parameters
    ----------
    kinds
        Of `KINDS`.
    scale
        Factor on the pixels of every photo; the table's own figures are those of 1.
    repeat
        Rounds, of which the best counts.
    """
    rows: list[SpeedRow] = []
    for kind in kinds:
        with TemporaryDirectory(prefix="facecrf-") as folder:
            rows += KINDS[kind](Path(folder), scale, repeat)
    return tuple(rows)


def machine() -> str:
    """The kind of machine: processor, cores that may be used, and the Python that runs."""
    return f"{_processor()}, {usable_cores()} cores, Python {platform.python_version()}"


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    for line in lines:
        name, _, value = line.partition(":")
        if name.strip() == "model name":
            return value.strip().replace(",", "")
    return platform.processor() or platform.machine()


def commit(folder: Path) -> str:
    """The checkout's commit, with `+` where files differ from it; empty outside of one."""
    told = _git(folder, "rev-parse", "--short", "HEAD")
    return told + ("+" if told and _git(folder, "status", "--porcelain", "-uno") else "")


def _git(folder: Path, *arguments: str) -> str:
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *arguments], capture_output=True, text=True, check=False
        )
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def today() -> str:
    """The date, in UTC."""
    return datetime.now(timezone.utc).date().isoformat()
