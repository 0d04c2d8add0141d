"""`facecrf report`: what a batch made, on one page."""

from __future__ import annotations

from itertools import count
from pathlib import Path

import click

from facecrf_ocio.cli.live import counting
from facecrf_ocio.cli.options import TEXT_PATH
from facecrf_ocio.cli.terminal import DONE, complain, ending_well, say
from facecrf_ocio.files.plain_text import counted
from facecrf_ocio.files.threads import usable_cores


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=TEXT_PATH, metavar="FILE.html", help="FOLDER's by default.")
@click.option("--overwrite", is_flag=True, help="Replace even a file that is no report.")
@click.option(
    "--pictures",
    default=10_000,
    show_default=True,
    type=click.IntRange(0),
    metavar="N",
    help="Photos that get thumbnails and curves; all are listed.",
)
@click.option("--jobs", type=click.IntRange(1), metavar="N", help="Threads; one per core.")
@ending_well
def report(
    folder: Path, output: Path | None, overwrite: bool, pictures: int, jobs: int | None
) -> int:
    """Write one HTML file that shows what a batch made in FOLDER: photos, verdicts, curves.

    It can be searched and sorted in any browser and needs no network. Photos are only read.
    """
    from facecrf_ocio.archive.report import write_report

    looked_at = count(1)
    with counting("photos") as tell:
        written = write_report(
            folder,
            output,
            overwrite=overwrite,
            limit=pictures,
            jobs=jobs or usable_cores(),
            watch=lambda total: tell(next(looked_at), total),
        )
    if not written.source_is_there:
        complain("the folder of the photos is not there, so the report shows none of them", DONE)
    say(
        f"{written.path}: {counted(written.photos, 'photo')}, "
        f"{written.pictured} of them with pictures, "
        f"{written.size / 1e6:.1f} MB"
    )
    return DONE
