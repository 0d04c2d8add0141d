"""`facecrf bracket`: exposures of one scene in, the LUTs of that camera out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.cli.calibrate_command import PLOT_SUFFIX, formats_option
from facecrf_ocio.cli.options import PHOTO_PATH, TEXT_PATH, direction_options
from facecrf_ocio.cli.terminal import USAGE, complain, ending_well, require_writable, status, tell
from facecrf_ocio.errors import LutError, SettingsError

if TYPE_CHECKING:
    from facecrf_ocio.pair.calibrate_bracket import BracketEstimate


def stops_option(command: Any) -> Any:
    """Add the option that gives exposures which the files do not tell."""
    return click.option(
        "--stops",
        "given",
        metavar="LIST",
        help="Exposures in stops, by commas, in the photos' order; by EXIF without it.",
    )(command)


def solve(photos: tuple[Path, ...], given: str | None) -> BracketEstimate:
    """Read a bracket, small, and find its response."""
    import numpy as np

    from facecrf_ocio import read_photo
    from facecrf_ocio.pair.calibrate_bracket import (
        apertures_differ,
        calibrate_bracket,
        stops_by_exif,
    )
    from facecrf_ocio.photo.shot import read_shot
    from facecrf_ocio.values import Photo

    shots = [read_shot(path) for path in photos]
    if given is None:
        empty = np.zeros((1, 1, 3), np.float32)
        stops = stops_by_exif(shots, [Photo(empty, path=path) for path in photos])
    else:
        stops = np.array(_numbers(given, len(photos)))
    read = (read_photo(path) for path in photos)
    return calibrate_bracket(read, stops, center_only=apertures_differ(shots))


def _numbers(given: str, count: int) -> list[float]:
    try:
        numbers = [float(part) for part in given.split(",")]
    except ValueError:
        raise SettingsError(f"--stops {given}: give numbers by commas, such as -2,0,2") from None
    if len(numbers) != count:
        raise SettingsError(f"--stops gives {len(numbers)} exposures for {count} photos")
    return numbers


@click.command()
@click.argument("photos", nargs=-1, required=True, type=PHOTO_PATH)
@click.option(
    "-o", "--output", required=True, type=TEXT_PATH, metavar="DIR", help="Where to write."
)
@stops_option
@formats_option
@direction_options
@click.option("--plot", is_flag=True, help=f"Also write NAME{PLOT_SUFFIX}: the curves.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("--overwrite", is_flag=True, help="Replace existing outputs.")
@ending_well
def bracket(
    photos: tuple[Path, ...],
    output: Path,
    given: str | None,
    formats: tuple[str, ...],
    plot: bool,
    as_json: bool,
    overwrite: bool,
    **way: Any,
) -> int:
    """Find the response of a camera from PHOTOS of one scene at different exposures.

    In any order, by EXIF's exposure times, f-numbers and sensitivities, which the pixels refine.
    The outputs are those of `facecrf calibrate`, named after the first photo.
    """
    from facecrf_ocio import read_photo
    from facecrf_ocio.files.atomic import require_free
    from facecrf_ocio.lut.write import endings
    from facecrf_ocio.record.outputs import require_outputs_free, write_outputs
    from facecrf_ocio.settings import Settings

    try:
        formats = endings(formats, way["direction"], way["space"] or "")
    except LutError as error:
        return complain(str(error), USAGE)
    require_writable(output)
    first = photos[0]
    picture = output / f"{first.stem}{PLOT_SUFFIX}"
    require_outputs_free(first, output, formats, overwrite=overwrite)
    if plot:
        require_free(picture, overwrite=overwrite)
    with status(f"solving a bracket of {len(photos)} photos"):
        estimate = solve(tuple(dict.fromkeys(photos)), given).estimate
        if estimate.found is None:
            return tell(first, estimate, (), as_json=as_json)
        photo, also = read_photo(first), []
        if plot:
            from facecrf_ocio.plots.calibration_plot import plot_draft

            also.append(plot_draft(picture, photo, estimate, Settings()))
        written = write_outputs(
            photo, estimate, Settings(), output, formats, overwrite=overwrite, also=also
        )
    return tell(first, estimate, written, as_json=as_json)
