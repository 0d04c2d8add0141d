"""`facecrf batch`, `verify` and `report`: whole archives, unattended."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.archive.walk import as_utf8
from facecrf_ocio.cli.calibrate_command import formats_option
from facecrf_ocio.cli.options import TEXT_PATH, Choices, direction_options, estimation_options
from facecrf_ocio.cli.terminal import DONE, FAILED, complain, ending_well, one_line, status
from facecrf_ocio.errors import LutError

if TYPE_CHECKING:
    from facecrf_ocio.archive.run import Event
    from facecrf_ocio.archive.work.dask_cluster import Cluster

INTERRUPTED = 130
_PLAIN_EVERY = 30.0
_KINDS = ("reliable", "weak", "prior only", "no curve", "failed")


class _Progress:
    """Rate, time left and counts: a live line on a terminal, a plain one now and then elsewhere."""

    def __init__(self, total: int | None) -> None:
        self.total, self.counts = total, Counter[str]()
        self.done = self.fresh = self.gathered = 0
        self.begin = self.said = monotonic()
        self.live: Any = None

    def __enter__(self) -> _Progress:
        if sys.stderr.isatty():
            from rich.console import Console

            self.live = Console(stderr=True).status(self._line())
            self.live.start()
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if self.live is not None:
            self.live.stop()
        if self.done or self.gathered or kind is None:  # else the error alone says it all
            click.echo(self._line(), err=True)

    def __call__(self, event: Event) -> None:
        result = event.result
        if event.step == "gathered":
            self.gathered += 1
        else:
            by = -1 if event.step == "reopened" else 1
            self.done += by
            self.fresh += event.fresh
            self.counts[_kind(result.outcome, result.verdict)] += by
        if event.fresh and result.outcome == "failed":
            if self.live is not None:
                self.live.stop()
            click.echo(f"facecrf: {one_line(_failure(event))}", err=True)
            if self.live is not None:
                self.live.start()
        if self.live is not None:
            self.live.update(self._line())
        elif monotonic() - self.said > _PLAIN_EVERY:
            self.said = monotonic()
            click.echo(self._line(), err=True)

    def _line(self) -> str:
        rate = self.fresh / max(monotonic() - self.begin, 1e-9)
        of = "" if self.total is None else f" of {self.total}"
        text = f"{self.done}{of} photos"
        if self.gathered and (self.total is None or self.done < self.total):
            text = f"{self.gathered} looked at, {text}"
        if self.done > self.fresh:
            text += f" ({self.done - self.fresh} done before)"
        if self.fresh:
            text += f", {rate:.2f}/s"
            if self.total is not None and self.total > self.done:
                text += f", {(self.total - self.done) / rate / 60:.0f} min left"
        return f"{text}: " + ", ".join(f"{self.counts[kind]} {kind}" for kind in _KINDS)


def _failure(event: Event) -> str:
    """Which photo, what is wrong and what to do, without its name once more inside."""
    reason = as_utf8(event.result.reason)
    wrong = reason.rpartition(f"{event.name}: ")[2]
    return "; ".join(filter(None, (f"{event.name}: failed: {wrong}", event.result.remedy)))


def _kind(outcome: str, verdict: str) -> str:
    return "failed" if outcome == "failed" else verdict or "no curve"


@click.command()
@click.argument("source", type=click.Path(path_type=Path))
@click.option("-o", "--output", required=True, type=TEXT_PATH, metavar="DST", help="Own folder.")
@click.option("--jobs", type=click.IntRange(1), default=None, help="Processes; one per core.")
@click.option("--include", multiple=True, metavar="GLOB", help="Only these; may be repeated.")
@click.option("--exclude", multiple=True, metavar="GLOB", help="Not these; may be repeated.")
@click.option(
    "--files-from",
    type=click.File("rb"),
    help="File of photo names below SOURCE, one a line; - for stdin.",
)
@click.option("-0", "--null", is_flag=True, help="Names in --files-from end with NUL.")
@formats_option
@direction_options
@click.option("--exr", is_flag=True, help="Also write scene-linear EXRs.")
@click.option(
    "--pool",
    type=click.Choice(("none", "camera")),
    default="none",
    show_default=True,
    help="One curve from all photos of a camera, by EXIF; and one for each bracket.",
)
@click.option(
    "--timeout",
    default=300.0,
    show_default=True,
    type=click.FloatRange(0.0, min_open=True),
    help="Seconds for one photo.",
)
@click.option(
    "--memory",
    default=4096,
    show_default=True,
    type=click.IntRange(1),
    help="MB for one process.",
)
@click.option("--retry", is_flag=True, help="Try photos again that failed before.")
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Work on the Dask cluster of this scheduler (tcp://host:8786) instead of with --jobs.",
)
@click.option(
    "--ship/--no-ship",
    default=None,
    help="Send photos to its workers and write here what comes back; or never do. By default, "
    "when a worker does not see SOURCE and DST.",
)
@estimation_options
@ending_well
def batch(
    source: Path,
    output: Path,
    jobs: int | None,
    include: tuple[str, ...],
    exclude: tuple[str, ...],
    files_from: Any,
    null: bool,
    **options: Any,
) -> int:
    """Calibrate all photos below SOURCE and write their LUTs to a mirrored tree.

    Photos are only read. For sub/a.jpg, DST gets sub/a.jpg.cube and so on. Started again, the
    command goes on where it was stopped, and redoes only what changed.
    """
    from facecrf_ocio.archive.run import Job, run
    from facecrf_ocio.archive.walk import photos_under
    from facecrf_ocio.archive.work.processes import Limits
    from facecrf_ocio.archive.work.task import Recipe

    exr, retry = options.pop("exr"), options.pop("retry")
    formats = _endings(*(options.pop(name) for name in ("formats", "direction", "space")))
    limits = Limits(options.pop("timeout"), options.pop("memory"))
    pool = options.pop("pool") == "camera"
    scheduler, ship = options.pop("scheduler"), options.pop("ship")
    if ship is not None and scheduler is None:
        raise click.UsageError("--ship and --no-ship are for --scheduler")
    choices = Choices(**options)
    if pool and choices.estimator not in ("auto", "joint"):
        raise click.UsageError("--pool camera takes the estimator auto or joint")
    recipe = Recipe(
        *(choices.estimator, choices.fallback, choices.prior, choices.min_confidence),
        *(choices.settings, formats, exr, pool),
        max_error=choices.max_error,
    )
    job = Job(
        *(source, output, recipe, jobs or os.cpu_count() or 1, limits),
        overwrite=choices.overwrite,
        retry=retry,
        cluster=_cluster(scheduler, ship),
    )
    total = None
    if files_from is not None:
        photos = _named(files_from.read(), source, b"\0" if null else b"\n")
    else:
        photos = photos_under(source, include, exclude)
        if source.is_dir():
            total = sum(1 for _ in photos_under(source, include, exclude))
    progress = _Progress(total)
    try:
        with progress:
            run(job, photos, progress)
    except KeyboardInterrupt:
        return complain("interrupted; run the same command again to go on", INTERRUPTED)
    except OSError as error:
        return complain(f"{error.filename or output}: {error.strerror or error}", FAILED)
    return DONE


def _endings(formats: tuple[str, ...], direction: str, space: str | None) -> tuple[str, ...]:
    """Endings of a photo's LUTs, or wrong usage where a format cannot hold what is asked for."""
    if direction == "linearize" and space is None:
        return formats  # without the libraries that the endings are looked up with
    from facecrf_ocio.lut.write import endings

    try:
        return endings(formats, direction, space or "")
    except LutError as error:
        raise click.UsageError(str(error)) from None


def _cluster(scheduler: str | None, ship: bool | None) -> Cluster | None:
    if not scheduler:
        return None
    from facecrf_ocio.archive.work.dask_cluster import Cluster

    return Cluster(scheduler, ship)


def _named(text: bytes, source: Path, end: bytes) -> Iterator[Path]:
    """Photos of a list, relative to the source or absolute; those elsewhere are refused."""
    root = Path(os.path.abspath(source))  # noqa: PTH100 - links are names, too
    for line in text.split(end):
        if line:
            path = Path(os.path.normpath(root / os.fsdecode(line)))
            if root not in path.parents:
                raise click.BadParameter(f"{path} is not below {source}")
            yield source / path.relative_to(root)


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@ending_well
def verify(folder: Path) -> int:
    """Tell which files of a batch in FOLDER are missing, altered, unreadable or extra."""
    from facecrf_ocio.archive.check_outputs import verify as faults_in

    count = 0
    for count, fault in enumerate(faults_in(folder), start=1):  # noqa: B007
        click.echo(one_line(f"{fault.kind}: {fault.name}"))
    if count:
        return complain(f"{folder}: {count} files are not as they were written", FAILED)
    click.echo(one_line(f"{folder}: all files are as they were written"))
    return DONE


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=TEXT_PATH, metavar="FILE.html", help="FOLDER's by default.")
@click.option("--overwrite", is_flag=True, help="Replace an existing report.")
@click.option(
    "--pictures",
    default=10_000,
    show_default=True,
    type=click.IntRange(0),
    help="Photos that get thumbnails and curves; all are listed.",
)
@click.option("--jobs", type=click.IntRange(1), default=None, help="Threads; one per core.")
@ending_well
def report(
    folder: Path, output: Path | None, overwrite: bool, pictures: int, jobs: int | None
) -> int:
    """Write one HTML file that shows what a batch made in FOLDER: photos, verdicts, curves.

    It can be searched and sorted in any browser and needs no network. Photos are only read.
    """
    from facecrf_ocio.archive.report import write_report

    with status(f"reading the photos of {folder}"):
        written = write_report(
            folder, output, overwrite=overwrite, limit=pictures, jobs=jobs or os.cpu_count() or 1
        )
    if not written.source_is_there:
        complain("the folder of the photos is not there, so the report shows none of them", DONE)
    click.echo(
        one_line(
            f"{written.path}: {written.photos} photos, {written.pictured} of them with pictures, "
            f"{written.size / 1e6:.1f} MB"
        )
    )
    return DONE
