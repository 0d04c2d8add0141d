"""`facecrf show`: one photo's result as a page to look at."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.cli.choices import Choices
from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.options import PHOTO_PATH, TEXT_PATH, estimation_options
from facecrf_ocio.cli.terminal import ending_well
from facecrf_ocio.cli.told_estimates import tell
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.record.output_names import EXR, PAGE, output_path

if TYPE_CHECKING:
    from facecrf_ocio.values import Estimate, Photo


@click.command()
@click.argument("photo", type=PHOTO_PATH)
@click.option(
    "-o",
    "--output",
    type=TEXT_PATH,
    metavar="PAGE.html",
    help=f"Page to write; NAME{PAGE} in this folder by default. An older page is replaced, any "
    "other file with --overwrite alone.",
)
@click.option(
    "--record",
    type=TEXT_PATH,
    metavar="FILE.crf.json",
    help="Show this result of the photo instead of calibrating it anew, with links to its LUTs.",
)
@click.option("--open", "opens", is_flag=True, help="Open the page in a browser.")
@estimation_options
@ending_well
def show(photo: Path, output: Path | None, record: Path | None, opens: bool, **choices: Any) -> int:
    """Show PHOTO before and after, its curve and what to expect, as one HTML page."""
    from facecrf_ocio.archive.report.photo_page import write_photo_page

    chosen = Choices(**choices)
    page = output_path(Path(), photo, PAGE) if output is None else output
    with status(f"looking at {photo}"):
        files: tuple[Path, ...] = ()
        if record is None:
            source, estimate = chosen.read_and_estimate(photo)
        else:
            source, estimate, files = _recorded(photo, record)
        written = write_photo_page(page, source, estimate, files, overwrite=chosen.overwrite)
    code = tell(photo, estimate, (written,), notes=source.notes, verbose=chosen.verbose)
    if estimate.found is None:
        click.echo(f"  {written}")
    if opens:
        click.launch(written.absolute().as_uri())
    return code


def _recorded(path: Path, record: Path) -> tuple[Photo, Estimate, tuple[Path, ...]]:
    """A photo and what a record says of it, with the files that stand beside the record."""
    from facecrf_ocio import read_photo
    from facecrf_ocio.record.calibration_record import read_record

    held = read_record(record)
    photo = read_photo(path)
    if held.source.sha256 not in (None, photo.sha256):
        raise SettingsError(
            f"{record}: is the record of another photo, {held.source.name}; name that photo, "
            "or leave out --record"
        )
    beside = [record.parent / name for name in held.luts]
    beside.append(output_path(record.parent, path, EXR))
    return photo, held.estimate, (*(made for made in beside if made.is_file()), record)
