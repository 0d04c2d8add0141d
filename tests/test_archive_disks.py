"""Disks that really fill up, and disks that fail at any moment: nothing is lost.

Whatever the moment, the run ends in one line, and the next on a sound disk makes what an unbroken
run makes, to the byte.
"""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from archive_photos import everything, files
from command_line import CODE, CommandLine, write_noise
from memory_disks import Disk, memory_disk
from workers_here import workers_here  # noqa: F401 - a fixture

from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.archive.place import alone

OPTIONS = ("--estimator", "mean", "--formats", "spi1d", "--exr")


@pytest.fixture
def source(tmp_path: Path) -> Path:
    source = tmp_path / "photos"
    for number in range(6):
        folder = source / str(number % 2)
        folder.mkdir(parents=True, exist_ok=True)
        write_noise(folder / f"{number}.png", seed=number, size=(60, 80))
    return source


@pytest.fixture
def whole(facecrf: CommandLine, source: Path, tmp_path: Path) -> Path:
    """What an unbroken run makes."""
    folder = tmp_path / "whole"
    assert facecrf("batch", source, "-o", folder, *OPTIONS).code == 0
    return folder


def told(err: str) -> list[str]:
    return [line for line in err.splitlines() if line.startswith("facecrf: ")]


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Disk]:
    with memory_disk(tmp_path / "disk") as disk:
        yield disk


@pytest.mark.slow
@pytest.mark.usefixtures("workers_here")
@pytest.mark.parametrize(
    ("limits", "some"),
    [
        ("size=40k", False),
        ("size=300k", None),
        ("size=500k", True),
        ("size=900k", True),
        ("nr_inodes=4", False),
        ("nr_inodes=9", None),
        ("nr_inodes=14", None),
        ("nr_inodes=20", True),
    ],
)
def test_a_run_on_a_disk_that_is_full_goes_on_where_there_is_more_room(
    facecrf, source, whole, disk, limits: str, some: bool | None
) -> None:
    disk.limit(limits)
    luts = disk.folder / "luts"
    ended = facecrf("batch", source, "-o", luts, *OPTIONS)
    assert ended.code == 1
    (line,) = told(ended.err)
    assert "no space left on device" in line or "database or disk is full" in line
    found, expected = files(luts) if luts.exists() else {}, files(whole)
    assert {name: expected.get(name) for name in found} == found  # nothing half written
    if some is not None:
        assert bool(found) == some
    disk.more("size=50m,nr_inodes=1000")
    assert facecrf("batch", source, "-o", luts, *OPTIONS).code == 0
    assert files(luts) == expected
    assert everything(luts) == everything(whole)
    assert facecrf("verify", luts).code == 0


@pytest.mark.slow
def test_a_disk_that_may_only_be_read_is_told(facecrf, source, whole, disk) -> None:
    disk.limit("size=50m")
    luts = disk.folder / "luts"
    shutil.copytree(whole, luts)
    disk.more("ro")
    for photos in (source, source / "0"):
        ended = facecrf("batch", photos, "-o", luts if photos == source else luts / "new", *OPTIONS)
        assert ended.code == 1
        (line,) = told(ended.err)
        assert "read-only file system" in line
    assert facecrf("verify", luts).code == 0
    assert files(luts) == files(whole)


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What makes a disk fail, compiled."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None or not sys.platform.startswith("linux"):
        pytest.skip("a C compiler, and Linux, are needed to let a disk fail")
    made = tmp_path_factory.mktemp("disk") / "failing_disk.so"
    code = Path(__file__).with_name("failing_disk.c")
    build = [compiler, "-shared", "-fPIC", "-O1", "-o", str(made), str(code), "-ldl"]
    if subprocess.run(build, check=False, capture_output=True).returncode:
        pytest.skip("the C compiler here makes no shared library")
    return made


@pytest.mark.slow
@pytest.mark.parametrize("after", [0, 9, 40, 90, 150])
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS])
def test_a_disk_that_fails_at_any_moment_costs_nothing(
    facecrf, source, whole, library, tmp_path, number: int, after: int
) -> None:
    luts = tmp_path / "luts"
    ended = on_failing_disk(library, source, luts, number, after=after)
    assert ended.returncode in (0, 1, 3), ended.stderr
    assert "Traceback" not in ended.stderr
    if ended.returncode:
        assert 1 <= len(told(ended.stderr)) <= (1 if ended.returncode == 1 else 6)
    found, expected = files(luts) if luts.exists() else {}, files(whole)
    kept = {name: content for name, content in found.items() if ".facecrf-" not in name}
    assert {name: expected.get(name) for name in kept} == kept
    assert facecrf("batch", source, "-o", luts, *OPTIONS).code == 0
    assert files(luts) == expected
    assert everything(luts) == everything(whole)
    assert facecrf("verify", luts).code == 0


def on_failing_disk(
    library: Path, source: Path, luts: Path, number: int, *, after: int, times: int = -1
) -> subprocess.CompletedProcess[str]:
    count = luts.parent / "count"
    count.write_bytes(bytes(8))
    fails = {
        "LD_PRELOAD": str(library),
        "FAIL_BELOW": str(luts),
        "FAIL_WITH": str(number),
        "FAIL_AFTER": str(after),
        "FAIL_TIMES": str(times),
        "FAIL_COUNT": str(count),
    }
    return subprocess.run(
        [sys.executable, "-c", CODE, "batch", str(source), "-o", str(luts), *OPTIONS],
        env=os.environ | fails,
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )


@pytest.mark.slow
def test_a_second_run_on_a_folder_that_is_at_work_is_told_and_changes_nothing(
    facecrf, source, whole, tmp_path
) -> None:
    for number in range(40):
        write_noise(source / f"more {number}.png", seed=100 + number, size=(60, 80))
    assert facecrf("batch", source, "-o", whole, *OPTIONS).code == 0
    luts = tmp_path / "luts"
    at_work = f"facecrf: {luts}: another run is at work there; wait for it"
    command = [sys.executable, "-c", CODE, "batch", str(source), "-o", str(luts), *OPTIONS]
    with subprocess.Popen([*command, "--jobs", "1"], stderr=subprocess.PIPE, text=True) as first:
        while not (luts / FILE).exists() and first.poll() is None:
            time.sleep(0.01)
        seconds = [subprocess.Popen(command, stderr=subprocess.PIPE, text=True) for _ in range(2)]
        looks = [facecrf("verify", luts, "--repair"), facecrf("verify", luts)]
        ended = [(second.communicate()[1], second.returncode) for second in seconds]
        first.communicate()
    for err, code in ended:
        # With 0, it came when the first was done.
        assert (code, told(err)) in ((1, [at_work]), (0, []))
    for look in looks:
        (line,) = told(look.err) or [""]
        nothing = "has nothing in it yet; start the batch again"
        may_say = (at_work, nothing, "not as they were", " extra")
        assert (look.code, line) == (0, "") or any(words in line for words in may_say)
    assert first.returncode == 0
    assert files(luts) == files(whole)
    assert everything(luts) == everything(whole)


@pytest.mark.usefixtures("workers_here")
def test_while_one_is_at_work_there_every_other_is_told_in_one_line(
    facecrf, source, tmp_path
) -> None:
    luts = tmp_path / "luts"
    assert facecrf("batch", source, "-o", luts, *OPTIONS).code == 0
    before = files(luts)
    (luts / "0" / "0.png.spi1d").unlink()
    with alone(luts):
        for arguments in (("batch", source, "-o", luts, *OPTIONS), ("verify", luts, "--repair")):
            ended = facecrf(*arguments)
            assert ended.code == 1
            at_work = f"facecrf: {luts}: another run is at work there; wait for it"
            assert told(ended.err) == [at_work]
    assert facecrf("verify", luts, "--repair").code == 0
    assert files(luts) == before


@pytest.mark.usefixtures("workers_here")
def test_a_manifest_that_a_killed_run_has_left_empty_is_told_and_filled(
    facecrf, source, tmp_path
) -> None:
    luts = tmp_path / "luts"
    luts.mkdir()
    (luts / FILE).touch()
    for command in ("verify", "report"):
        ended = facecrf(command, luts)
        assert ended.code == 1
        (line,) = told(ended.err)
        assert line.endswith("has nothing in it yet; start the batch again, or wait")
    assert facecrf("batch", source, "-o", luts, *OPTIONS).code == 0
    assert facecrf("verify", luts).code == 0
