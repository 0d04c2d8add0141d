"""What whole processes take: a cold command, a batch, a worker's memory."""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from time import perf_counter

from facecrf_ocio.benchmark.archive_cost import batch_cost, installed
from facecrf_ocio.benchmark.speed.photo_rows import decode
from facecrf_ocio.benchmark.speed.race import race
from facecrf_ocio.benchmark.speed.speed_row import SpeedRow
from facecrf_ocio.benchmark.speed.subjects import portrait
from facecrf_ocio.errors import FaceCRFError

_COLD = 0.9  # [s] wanted of a cold process
_BATCH = 6.0  # [photo / s] wanted of a core
_BATCH_PHOTOS = 24  # of which a batch takes five times as long as to start
# [megapixel] and [GB] wanted of a worker.
_MEMORY = ((24.0, 0.35), (100.0, 1.2))
_LIBRARIES = "import numpy, cv2, OpenImageIO, PyOpenColorIO, sys; "
_DECODE = (
    "source = OpenImageIO.ImageInput.open(sys.argv[1]); "
    "pixels = source.read_image(0, 0, 0, 3, OpenImageIO.UINT8); source.close(); "
)
_FLOOR = _LIBRARIES + _DECODE
_COMMAND = "from facecrf_ocio.cli.facecrf import main; main()"
_WORKER = (
    "import sys; from pathlib import Path; "
    "from facecrf_ocio.files.threads import limit_to_one_thread; limit_to_one_thread(); "
    "from facecrf_ocio import calibrate, read_photo; "
    "from facecrf_ocio.record.outputs import write_outputs; "
    "from facecrf_ocio.settings import Settings; "
    "photo = read_photo(sys.argv[1]); "
    "write_outputs(photo, calibrate(photo), Settings(), Path(sys.argv[2]), overwrite=True); "
)
# Not getrusage: its peak starts with that of the process that this one was forked from.
_PEAK = (
    "import pathlib; "
    "said = pathlib.Path('/proc/self/status').read_text(); "
    "print(said.split('VmHWM:')[1].split()[0])"
)


def cold_rows(folder: Path, scale: float, repeat: int) -> Iterator[SpeedRow]:
    """`facecrf calibrate` as a process, against one that imports the libraries and decodes."""
    photo = portrait(folder / "cold.jpg", 12.0 * scale, close=True)
    command = ("calibrate", str(photo), "-o", str(folder / "cold"), "--overwrite")
    calls = ((_COMMAND, command), (_FLOOR, (str(photo),)))
    _spent(*calls[0])  # the first compiles
    runs = [[_spent(*call) for call in calls] for _ in range(repeat)]
    ours, floor = ([min(run[k][i] for run in runs) for i in range(2)] for k in range(2))
    told = [f"{wall:.2f} s ({cpu:.2f} of CPU)" for wall, cpu in (ours, floor)]
    yield SpeedRow(
        "cold",
        f"facecrf calibrate, cold, {12.0 * scale:g} MP",
        told[0],
        told[1],
        ours[0],
        ours[0] / floor[0],
        ours[1] / floor[1],
        _COLD,
    )


def batch_rows(folder: Path, scale: float, repeat: int) -> Iterator[SpeedRow]:
    """Photos a second and core of `facecrf batch`, against decoding them.

    By processor time of all its processes, without starting them: what a photo waits for the disk
    is the time that another process has.
    """
    inside = folder / "batch"
    inside.mkdir()
    photos = [
        portrait(inside / f"{seed}.jpg", 7.7 * scale, seed=seed) for seed in range(_BATCH_PHOTOS)
    ]
    cost = batch_cost(photos, 1, max(1, repeat // 2))
    (floor,) = race("decode", {"OpenImageIO": lambda: decode(photos[0])}, 7.7 * scale, repeat)
    yield SpeedRow(
        "batch",
        f"batch, photos a second and core at {7.7 * scale:g} MP",
        f"{1 / cost.cpu:.1f}/s ({1000 * cost.cpu:.0f} ms of CPU, {1000 * cost.wall:.0f} by time)",
        f"{1 / floor.cpu:.1f}/s ({1000 * floor.cpu:.0f} ms of CPU)",
        1 / cost.cpu,
        cost.wall / floor.seconds,
        cost.cpu / floor.cpu,
        _BATCH,
        more=True,
    )


def memory_rows(folder: Path, scale: float, _: int) -> Iterator[SpeedRow]:
    """The peak of a worker, against one that imports the libraries and decodes; Linux alone."""
    if not Path("/proc/self/status").exists():
        return
    for megapixels, wanted in _MEMORY:
        photo = portrait(folder / f"memory{megapixels:.0f}.jpg", megapixels * scale)
        ours = _peak(_WORKER, str(photo), str(folder / "worker"))
        floor = _peak(_FLOOR, str(photo))
        yield SpeedRow(
            f"memory_{megapixels:.0f}mp",
            f"memory of a worker, {megapixels * scale:g} MP",
            f"{ours:.2f} GB",
            f"{floor:.2f} GB",
            ours,
            ours / floor,
            ours / floor,
            wanted,
        )


def _spent(code: str, arguments: Sequence[str]) -> tuple[float, float]:
    """[s] Time and processor time of a process."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
    _run(code, arguments)
    wall, after = perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _peak(code: str, *arguments: str) -> float:
    """[GB] The most memory that a process of this code had."""
    return float(_run(code + _PEAK, arguments).split()[-1]) * 1024 / 1e9


def _run(code: str, arguments: Sequence[str]) -> str:
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=installed())
    if done.returncode:
        said = done.stderr.strip().rpartition("\n")[2]
        raise FaceCRFError(f"a process of the benchmark failed: {said}")
    return done.stdout
