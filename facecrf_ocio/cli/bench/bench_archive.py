"""`facecrf bench archive`: how long a batch takes."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.bench.bench_terminal import PATH
from facecrf_ocio.cli.terminal import DONE, ending_well


@click.command()
@click.argument("folder", type=PATH)
@click.option(
    "--photos", type=click.IntRange(8), default=64, show_default=True, help="Use so many."
)
@click.option(
    "--jobs", type=click.IntRange(1), default=2, show_default=True, help="Processes of the batch."
)
@click.option(
    "--repeat",
    type=click.IntRange(1),
    default=2,
    show_default=True,
    help="Run each so often, in turn.",
)
@ending_well
def archive(folder: Path, photos: int, jobs: int, repeat: int) -> int:
    """Time `batch` on the photos in FOLDER beside calibrating them in a loop, and by more jobs.

    Outputs go to temporary folders.
    """
    from facecrf_ocio.benchmark.archive_cost import measure_archive

    names = sorted(path for path in folder.iterdir() if path.is_file())
    click.echo(measure_archive(names[:photos], jobs, repeat).text)
    return DONE
