"""`facecrf batch`: whole archives, unattended."""

from __future__ import annotations

import shlex
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.archive.walk import Passed, photos_under
from facecrf_ocio.cli.batch_progress import Progress, kind_of
from facecrf_ocio.cli.choices import Choices
from facecrf_ocio.cli.named_photos import named_photos
from facecrf_ocio.cli.options import (
    TEXT_PATH,
    compression_option,
    direction_options,
    estimation_options,
    exposure_option,
    require_exrs,
)
from facecrf_ocio.cli.output_files import formats_option
from facecrf_ocio.cli.terminal import (
    DONE,
    FAILED,
    NOTHING,
    UNREADABLE,
    complain,
    ending_well,
    interrupted,
    say,
)
from facecrf_ocio.cli.told_estimates import tell_json
from facecrf_ocio.errors import LutError, in_options
from facecrf_ocio.files.threads import usable_cores

if TYPE_CHECKING:
    from facecrf_ocio.archive.job import Event, Job
    from facecrf_ocio.archive.work.cluster import Cluster

_TLS = ("tls_ca", "tls_cert", "tls_key")


@click.command()
@click.argument("source", type=click.Path(path_type=Path))
@click.option("-o", "--output", required=True, type=TEXT_PATH, metavar="DST", help="Own folder.")
@click.option("--jobs", type=click.IntRange(1), metavar="N", help="Processes; one per core.")
@click.option("--include", multiple=True, metavar="GLOB", help="Only these; may be repeated.")
@click.option("--exclude", multiple=True, metavar="GLOB", help="Not these; may be repeated.")
@click.option(
    "--files-from",
    type=click.File("rb"),
    help="File of photo names below SOURCE, one a line; - for stdin.",
)
@click.option("--all-folders", is_flag=True, help="Also those of other software, as @eaDir.")
@click.option("-0", "--null", is_flag=True, help="Names in --files-from end with NUL.")
@formats_option
@direction_options
@click.option("--exr", is_flag=True, help="Also write scene-linear EXRs.")
@exposure_option
@compression_option
@click.option(
    "--pool",
    type=click.Choice(("none", "camera")),
    default="none",
    show_default=True,
    help="One curve from all photos of a camera, by EXIF; and one for each bracket.",
)
@click.option(
    "--merge",
    is_flag=True,
    help="Also merge each bracket that --pool camera finds to one EXR, NAME.hdr.exr.",
)
@click.option(
    "--timeout",
    default=300.0,
    show_default=True,
    type=click.FloatRange(0.0, min_open=True),
    metavar="SECONDS",
    help="For one photo.",
)
@click.option(
    "--memory",
    default=4096,
    show_default=True,
    type=click.IntRange(1),
    metavar="MB",
    help="For one process.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object per photo and line.")
@click.option(
    "--csv", "table", type=TEXT_PATH, metavar="FILE.csv", help="At the end, list every photo."
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
@click.option("--tls-ca", type=click.Path(path_type=Path), help="Certificate of the authority.")
@click.option("--tls-cert", type=click.Path(path_type=Path), help="Certificate shown to it.")
@click.option("--tls-key", type=click.Path(path_type=Path), help="Key of that certificate.")
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
    command goes on where it was stopped, and redoes only what changed, in SOURCE or in DST. The
    exit code is 3 if a photo failed; one that gives no curve has not.
    """
    from facecrf_ocio.archive.photo_list import require_list, write_list
    from facecrf_ocio.archive.run import run

    as_json, table, all_folders = (options.pop(n) for n in ("as_json", "table", "all_folders"))
    job = _job(source, output, jobs, options)
    if table is not None:
        require_list(table, overwrite=job.overwrite)
    passed = Passed()
    if files_from is not None:
        photos = named_photos(files_from.read(), source, b"\0" if null else b"\n")
        total = None
    else:
        walk = (source, include, exclude)
        photos = photos_under(*walk, all_folders=all_folders)
        counted = photos_under(*walk, all_folders=all_folders, passed=passed)
        total = sum(1 for _ in counted) if source.is_dir() else None
    progress = Progress(total, passed, partial(_tell, source) if as_json else _silent)
    try:
        with progress:
            run(job, photos, progress)
        if table is not None:
            write_list(job.folder, table)
        if sys.stderr.isatty():
            next_step = f"facecrf report {shlex.quote(str(output))}"
            say(f"  to look at it: {next_step}", err=True)
    except KeyboardInterrupt:
        return interrupted("run the same command again to go on")
    except OSError as error:
        return complain(f"{error.filename or output}: {error.strerror or error}", FAILED)
    failed = progress.counts["failed"] or progress.brackets["failed"]
    return UNREADABLE if failed else DONE


def _job(source: Path, output: Path, jobs: int | None, options: dict[str, Any]) -> Job:
    from facecrf_ocio.archive.job import Job
    from facecrf_ocio.archive.task import Recipe
    from facecrf_ocio.archive.work.processes import Limits

    exr, exposure, retry = (options.pop(name) for name in ("exr", "exposure", "retry"))
    compression = options.pop("compression")
    _require_exposure(exposure, exr=exr)
    formats = _endings(*(options.pop(name) for name in ("formats", "direction", "space")))
    limits = Limits(options.pop("timeout"), options.pop("memory"))
    pool, merge = options.pop("pool") == "camera", options.pop("merge")
    cluster = _cluster(*(options.pop(n) for n in ("scheduler", "ship", *_TLS)))
    choices = Choices(**options)
    if pool and choices.estimator not in ("auto", "joint"):
        raise click.UsageError("--pool camera takes the estimator auto or joint")
    if merge and not pool:
        raise click.UsageError("--merge merges what --pool camera finds; pass both")
    require_exrs(compression, asked=exr or merge)
    recipe = Recipe(
        *(choices.estimator, choices.fallback, choices.prior, choices.min_confidence),
        *(choices.settings, formats, exr, pool),
        max_error=choices.max_error,
        exposure=exposure,
        merge=merge,
        compression=compression,
    )
    return Job(
        *(source, output, recipe, jobs or usable_cores(), limits),
        overwrite=choices.overwrite,
        retry=retry,
        cluster=cluster,
    )


def _require_exposure(exposure: str, *, exr: bool) -> None:
    from facecrf_ocio.image.exposure import require_exposure

    if exposure != "0":
        require_exposure(exposure)
        if not exr:
            raise click.UsageError("--exposure scales the light of EXRs; pass --exr, too")


def _silent(_: Event) -> None:
    """Tell no more than the counts do."""


def _tell(source: Path, event: Event) -> None:
    """Print what came of a photo as `calibrate --json` does."""
    result = event.result
    if event.step == "bracket":
        _tell_bracket(source, event)
    if event.step != "done":
        return
    kind = kind_of(result.outcome, result.verdict)
    tell_json(
        source / event.name,
        {"failed": UNREADABLE, "no curve": NOTHING}.get(kind, DONE),
        outcome=result.outcome,
        verdict=result.verdict or None,
        estimator=result.estimator,
        reason=result.reason,
        remedy=in_options(result.remedy),
        fresh=event.fresh,
        files=[file.name for file in result.outputs],
    )


def _tell_bracket(source: Path, event: Event) -> None:
    """Print what came of the bracket that begins with a photo."""
    result = event.result
    code = {"failed": UNREADABLE, "merged": DONE}.get(result.outcome, NOTHING)
    told: dict[str, Any] = {"outcome": result.outcome, "reason": result.reason}
    files = [file.name for file in result.outputs]
    told |= {"remedy": in_options(result.remedy), "fresh": event.fresh, "files": files}
    tell_json(source / event.name, code, bracket=True, **told)


def _endings(formats: tuple[str, ...], direction: str, space: str | None) -> tuple[str, ...]:
    """Endings of a photo's LUTs, or wrong usage where a format cannot hold what is asked for."""
    if direction == "linearize" and space is None:
        return formats  # without the libraries that the endings are looked up with
    from facecrf_ocio.lut.write import endings

    try:
        return endings(formats, direction, space or "")
    except LutError as error:
        raise click.UsageError(str(error)) from None


def _cluster(scheduler: str | None, ship: bool | None, *tls: Path | None) -> Cluster | None:
    if not scheduler:
        if ship is not None or any(tls):
            raise click.UsageError("--ship, --no-ship and --tls-... are for --scheduler")
        return None
    if any(tls) and not all(tls):
        raise click.UsageError("--tls-ca, --tls-cert and --tls-key belong together")
    from facecrf_ocio.archive.work.cluster import Cluster

    return Cluster(scheduler, ship, *map(str, filter(None, tls)))
