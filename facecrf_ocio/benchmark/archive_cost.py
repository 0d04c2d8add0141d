"""What an archive's run costs beside calibrating its photos one after the other, in one process.

Every command runs as processes of its own, on a few photos and on all. What all took more, divided
by how many more they were, is the cost of a photo without that of starting; the time that all took
is the cost with it. Several loops side by side, which share nothing but the machine, are the bound
of what as many jobs can reach.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

from facecrf_ocio.errors import FaceCRFError, SettingsError
from facecrf_ocio.files.threads import limit_to_one_thread

_COMMAND = "from facecrf_ocio.cli.facecrf import main; main()"
_LOOP = "from facecrf_ocio.benchmark.archive_cost import calibrate_loop; calibrate_loop()"
_UNCOMPILED = "PYTHONDONTWRITEBYTECODE"


@dataclass(frozen=True, slots=True)
class Cost:
    """What a photo costs.

    Attributes
    ----------
    wall, cpu
        [s] Of time and of processor time of all processes, without starting.
    rate
        [photo / s] With starting.
    """

    wall: float
    cpu: float
    rate: float


@dataclass(frozen=True, slots=True)
class ArchiveCost:
    """What `measure_archive` found.

    Attributes
    ----------
    photos, jobs
        Their numbers.
    loop, loops
        Of calibrating and writing LUTs in a loop, as `facecrf calibrate` does; of `jobs` such loops
        at a time, among which the photos are divided.
    one, several
        Of `facecrf batch` with one job, and with `jobs`.
    """

    photos: int
    jobs: int
    loop: Cost
    loops: Cost
    one: Cost
    several: Cost

    @property
    def text(self) -> str:
        """The figures as lines."""
        wall, cpu = self.one.wall / self.loop.wall - 1.0, self.one.cpu / self.loop.cpu - 1.0
        named = {
            "calibrate in a loop": self.loop,
            f"{self.jobs} such loops": self.loops,
            "batch --jobs 1": self.one,
            f"batch --jobs {self.jobs}": self.several,
        }
        lines = [
            f"{name:<20} {cost.wall:7.4f} s, {cost.cpu:7.4f} s of CPU a photo; "
            f"{cost.rate:6.2f} photos/s with starting"
            for name, cost in named.items()
        ]
        return "\n".join(
            (
                f"{self.photos} photos, one thread a process",
                *lines,
                f"batch over calibrate: {100 * wall:+.1f} % of time, {100 * cpu:+.1f} % of CPU",
                f"{self.jobs} jobs over one: {_gain(self.one, self.several)}",
                f"{self.jobs} loops over one: {_gain(self.loop, self.loops)}",
            )
        )


def batch_cost(photos: Sequence[Path], jobs: int, repeat: int) -> Cost:
    """Run `facecrf batch` on a few photos and on all, in turn, `repeat` times.

    Of the least that each took: the least of differences would be the one whose run on a few was
    hindered most.
    """
    return _cost(lambda folder, some: _batch(folder, some, jobs), photos, repeat)


def _gain(one: Cost, several: Cost) -> str:
    steady, started = one.wall / several.wall, several.rate / one.rate
    return f"{steady:.2f} times the rate, {started:.2f} times with starting"


def measure_archive(photos: Sequence[Path], jobs: int, repeat: int) -> ArchiveCost:
    """Calibrate photos in a loop and by `facecrf batch`, all commands in turn, `repeat` times.

    Parameters
    ----------
    photos
        At least 8, from one folder, of different bytes.
    jobs
        Of the run that is compared with one job.
    repeat
        How often; the means are told.

    Raises
    ------
    SettingsError
        If there are too few photos.
    FaceCRFError
        If a command fails.
    """
    if len(photos) < 8:
        raise SettingsError(f"{len(photos)} photos are too few to time; give 8 or more")
    runs: tuple[Callable[[Path, Sequence[Path]], None], ...] = (
        lambda folder, some: _loops(folder, some, 1),
        lambda folder, some: _loops(folder, some, jobs),
        lambda folder, some: _batch(folder, some, 1),
        lambda folder, some: _batch(folder, some, jobs),
    )
    found = [[_cost(run, photos) for run in runs] for _ in range(repeat)]
    return ArchiveCost(len(photos), jobs, *(_mean(costs) for costs in zip(*found, strict=True)))


def calibrate_loop() -> None:
    """Calibrate the photos that stdin names, for the folder that the command line names."""
    # Only where it is run, in a process of its own.
    from facecrf_ocio import calibrate, read_photo  # noqa: PLC0415
    from facecrf_ocio.record.outputs import write_outputs  # noqa: PLC0415
    from facecrf_ocio.settings import Settings  # noqa: PLC0415

    limit_to_one_thread()  # as in a worker of `facecrf batch`
    for path in map(Path, os.fsdecode(sys.stdin.buffer.read()).split("\0")):
        photo = read_photo(path)
        estimate = calibrate(photo)
        if estimate.found is not None:
            write_outputs(photo, estimate, Settings(), Path(sys.argv[1]))


def _loops(folder: Path, photos: Sequence[Path], jobs: int) -> None:
    shares = [photos[first::jobs] for first in range(min(jobs, len(photos)))]
    with ThreadPoolExecutor(jobs) as starters:
        list(starters.map(lambda share: _run([_LOOP, str(folder)], share), shares))


def _batch(folder: Path, photos: Sequence[Path], jobs: int) -> None:
    options = ("-o", str(folder), "--jobs", str(jobs), "--files-from", "-", "-0")
    _run([_COMMAND, "batch", str(photos[0].parent), *options], photos)


def _run(arguments: Sequence[str], photos: Sequence[Path]) -> None:
    names = b"\0".join(os.fsencode(photo.absolute()) for photo in photos)
    done = subprocess.run(
        [sys.executable, "-c", *arguments],
        input=names,
        capture_output=True,
        check=False,
        env=installed(),
    )
    if done.returncode:
        said = done.stderr.decode(errors="replace").strip().rpartition("\n")[2]
        raise FaceCRFError(f"a command of the benchmark failed: {said}")


def installed() -> dict[str, str]:
    """The environment of a process that may keep what it compiles, as of an installed package."""
    return {name: value for name, value in os.environ.items() if name != _UNCOMPILED}


def _cost(
    run: Callable[[Path, Sequence[Path]], None], photos: Sequence[Path], repeat: int = 1
) -> Cost:
    few = photos[: max(2, len(photos) // 8)]
    rounds = [(_timed(run, few), _timed(run, photos)) for _ in range(repeat)]
    some, whole = (tuple(map(min, zip(*runs, strict=True))) for runs in zip(*rounds, strict=True))
    more = len(photos) - len(few)
    return Cost((whole[0] - some[0]) / more, (whole[1] - some[1]) / more, len(photos) / whole[0])


def _timed(
    run: Callable[[Path, Sequence[Path]], None], photos: Sequence[Path]
) -> tuple[float, float]:
    """[s] Of time and of processor time, that of all processes which were started."""
    with TemporaryDirectory(prefix="facecrf-") as folder:
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), perf_counter()
        run(Path(folder), photos)
        wall, after = perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def _mean(costs: Sequence[Cost]) -> Cost:
    return Cost(
        *(
            sum(values) / len(costs)
            for values in zip(*((c.wall, c.cpu, c.rate) for c in costs), strict=True)
        )
    )
