"""Work is spread over the cores that a process may use, not over those that there are."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from command_line import CommandLine, write_noise

from facecrf_ocio.archive import report
from facecrf_ocio.archive.report import write_report
from facecrf_ocio.archive.work import hired
from facecrf_ocio.archive.work.processes import Workers
from facecrf_ocio.files.threads import usable_cores

pytestmark = pytest.mark.skipif(
    not hasattr(os, "sched_setaffinity"), reason="this system ties no process to cores"
)


@pytest.fixture
def one_core() -> Iterator[None]:
    """As `taskset`, a container or a batch system leave it."""
    former = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(former)})
    yield
    os.sched_setaffinity(0, former)


@pytest.mark.usefixtures("one_core")
def test_usable_cores_are_those_of_the_affinity() -> None:
    assert usable_cores() == 1


def test_usable_cores_are_all_where_nothing_ties() -> None:
    assert usable_cores() == len(os.sched_getaffinity(0))


@pytest.mark.usefixtures("one_core")
@pytest.mark.parametrize(("options", "expected"), [((), 1), (("--jobs", "2"), 2)])
def test_batch_starts_as_many_processes(
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    options: tuple[str, ...],
    expected: int,
) -> None:
    asked = []

    def workers(jobs: int, *rest: object) -> Workers:
        asked.append(jobs)
        return Workers(jobs, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(hired, "Workers", workers)
    (tmp_path / "photos").mkdir()
    write_noise(tmp_path / "photos" / "a.png")
    how = ("--estimator", "mean", "--formats", "spi1d", *options)
    ended = CommandLine(capfd)("batch", tmp_path / "photos", "-o", tmp_path / "luts", *how)
    assert (ended.code, asked) == (0, [expected])


@pytest.mark.usefixtures("one_core")
def test_report_starts_as_many_threads(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "photos").mkdir()
    write_noise(tmp_path / "photos" / "a.png")
    facecrf, luts = CommandLine(capfd), tmp_path / "luts"
    facecrf("batch", tmp_path / "photos", "-o", luts, "--estimator", "mean", "--formats", "spi1d")
    asked = []

    def written(*arguments: Any, jobs: int, **options: Any) -> Any:
        asked.append(jobs)
        return write_report(*arguments, jobs=jobs, **options)

    monkeypatch.setattr(report, "write_report", written)
    assert facecrf("report", luts).code == 0
    assert asked == [1]


def test_a_process_that_is_tied_when_it_starts_finds_so() -> None:
    code = (
        "import os; os.sched_setaffinity(0, {min(os.sched_getaffinity(0))});"
        "from facecrf_ocio.files.threads import usable_cores; print(usable_cores())"
    )
    ended = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert ended.stdout == "1\n"
