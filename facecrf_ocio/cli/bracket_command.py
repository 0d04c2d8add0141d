"""`facecrf bracket`: exposures of one scene in, the LUTs of that camera out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.options import PHOTO_PATH
from facecrf_ocio.cli.output_files import OutputFiles, folder_option, measurement_options
from facecrf_ocio.cli.terminal import USAGE, complain, ending_well, require_writable
from facecrf_ocio.cli.told_estimates import tell
from facecrf_ocio.errors import LutError, SettingsError
from facecrf_ocio.files.plain_text import counted

if TYPE_CHECKING:
    from facecrf_ocio.pair.calibrate_bracket import BracketEstimate


_MOST_STOPS = 64.0  # a second to the age of the universe; more would overflow sums of squares


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
    from facecrf_ocio.photo.containers.integrity import check_file
    from facecrf_ocio.photo.shot import read_shot
    from facecrf_ocio.values import Photo

    for path in photos:
        check_file(path)  # tells in words what EXIF's reader would not
    shots = [read_shot(path) for path in photos]
    if given is None:
        for path, shot in zip(photos, shots, strict=True):
            if shot.exposure_s <= 0.0:
                read_photo(path)  # what is no photo is told as that, not as one without EXIF
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
        exposures, photos = counted(len(numbers), "exposure"), counted(count, "photo")
        raise SettingsError(f"--stops gives {exposures} for {photos}, each named once")
    wrong = next((number for number in numbers if not abs(number) <= _MOST_STOPS), None)
    if wrong is not None:
        raise SettingsError(f"--stops {wrong:g}: no camera's; give stops up to {_MOST_STOPS:.0f}")
    return numbers


@click.command()
@click.argument("photos", nargs=-1, required=True, type=PHOTO_PATH)
@folder_option
@stops_option
@measurement_options
@ending_well
def bracket(
    photos: tuple[Path, ...],
    output: Path,
    given: str | None,
    as_json: bool,
    **way: Any,
) -> int:
    """Find the response of a camera from PHOTOS of one scene at different exposures.

    In any order, by EXIF's exposure times, f-numbers and sensitivities, which the pixels refine.
    The outputs are those of `facecrf calibrate`, named after the first photo.
    """
    from facecrf_ocio import read_photo
    from facecrf_ocio.settings import Settings

    try:
        outputs = OutputFiles.asked(output, **way)
    except LutError as error:
        return complain(str(error), USAGE)
    require_writable(output)
    first = photos[0]
    outputs.require_free(first)
    with status(f"solving a bracket of {len(photos)} photos"):
        estimate = solve(tuple(dict.fromkeys(photos)), given).estimate
        if estimate.found is None:
            return tell(first, estimate, (), as_json=as_json)
        written = outputs.write(first, read_photo(first), estimate, Settings())
    return tell(first, estimate, written, as_json=as_json)
