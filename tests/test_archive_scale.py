"""A hundred thousand photos that are done: what it takes to find that out."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from facecrf_ocio import __version__
from facecrf_ocio.archive.cameras.settle import settle
from facecrf_ocio.archive.manifest.database import Manifest, Stamp
from facecrf_ocio.archive.task import Gathered, Output, Recipe, Result
from facecrf_ocio.photo.shot import Shot

# Runs in a process of its own and prints the seconds of the run, then the memory it took at most.
RUN = """
import resource, sys, time
from pathlib import Path
from facecrf_ocio.archive.job import Job
from facecrf_ocio.archive.run import run
from facecrf_ocio.archive.task import Recipe
from facecrf_ocio.archive.walk import photos_under
source, folder, pool = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3] == "pool"
count = 0
def tell(event):
    global count
    assert not event.fresh, event
    count += 1
begin = time.monotonic()
run(Job(source, folder, Recipe(pool=pool)), photos_under(source), tell)
print(count, time.monotonic() - begin, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
"""


def done_before(source: Path, folder: Path, count: int, *, pool: bool) -> tuple[int, float, float]:
    """Photos told, seconds and megabytes of a run over so many photos that are all done."""
    source.mkdir()
    folder.mkdir()
    digest = Recipe(pool=pool).sha256(__version__)
    manifest = Manifest(folder)
    told = Gathered('{"messages": {}, "coverage": [], "leaning": 0, "lacking": "-", "remedy": ""}')
    with manifest.transaction():
        for number in range(count):
            path = source / f"{number % 100:02d}" / f"{number:06d}.jpg"
            path.parent.mkdir(exist_ok=True)
            path.touch()
            status = path.stat()
            stamp = Stamp(0, status.st_mtime_ns, digest, status.st_ctime_ns)
            name = path.relative_to(source).as_posix()
            made = folder / f"{name}.cube"
            made.parent.mkdir(exist_ok=True)
            made.touch()
            output = Output(f"{name}.cube", 0, "0", made.stat().st_mtime_ns)
            result = Result("calibrated", "weak", sha256=f"{number}", outputs=(output,))
            if pool:
                shot = Shot("", 1.0, 1.0, 1.0, 1.0)
                camera = (f"{number % 50}", "", "", "")
                said = Result("", "", sha256=f"{number}", camera=camera, shot=shot, gathered=told)
                manifest.record_gathered(name, stamp, said, f"{number}")
                manifest.written(name, result)
            else:
                manifest.finish(name, stamp, result, f"{number}")
    if pool:
        manifest.change("UPDATE photos SET taken = 0")
        settle(manifest, digest, Recipe(), lambda *_: None)
    manifest.close()
    command = [sys.executable, "-c", RUN, str(source), str(folder), "pool" if pool else "none"]
    told_count, seconds, memory = subprocess.run(
        command, check=True, capture_output=True, text=True, env=os.environ
    ).stdout.split()
    return int(told_count), float(seconds), float(memory)


@pytest.mark.slow
@pytest.mark.parametrize("pool", [False, True])
def test_resume_decides_on_a_hundred_thousand_rows_in_seconds_and_in_constant_memory(
    tmp_path, pool
):
    few = done_before(tmp_path / "few", tmp_path / "few-luts", 1_000, pool=pool)
    many = done_before(tmp_path / "many", tmp_path / "many-luts", 100_000, pool=pool)
    print(f"photos, seconds, MB: {few}, {many}")
    assert (few[0], many[0]) == (1_000, 100_000)
    assert many[1] < 60  # 10 on an idle machine
    assert many[2] < few[2] + 30
