"""`facecrf chart`: a photo of a color chart in, the LUTs of that camera out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.options import PHOTO_PATH
from facecrf_ocio.cli.output_files import OutputFiles, folder_option, measurement_options
from facecrf_ocio.cli.terminal import USAGE, complain, ending_well, require_writable
from facecrf_ocio.cli.told_estimates import tell
from facecrf_ocio.errors import LutError


class _Point(click.ParamType):  # type: ignore[type-arg]
    name = "x,y"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        """Two numbers, or wrong usage."""
        try:
            x, y = (float(part) for part in str(value).split(","))
        except ValueError:
            self.fail(f"{value}: give pixels as x,y, such as 812,430.5", param, ctx)
        return x, y


@click.command()
@click.argument("photo", type=PHOTO_PATH)
@folder_option
@click.option(
    "--corners",
    nargs=4,
    type=_Point(),
    metavar="X,Y X,Y X,Y X,Y",
    help="Outer corners of the four patches in the chart's corners, in pixels, around it from any "
    "one; found by OpenCV without it.",
)
@click.option(
    "--edition",
    type=click.Choice(("2014", "2005")),
    default="2014",
    show_default=True,
    help="Charts made since November 2014, or before.",
)
@measurement_options
@ending_well
def chart(
    photo: Path,
    output: Path,
    corners: tuple[tuple[float, float], ...] | None,
    edition: str,
    as_json: bool,
    **way: Any,
) -> int:
    """Find the response of a camera from PHOTO, which shows a ColorChecker Classic.

    One curve a channel from the gray row's published reflectances, uneven light taken out. The
    outputs are those of `facecrf calibrate`; `facecrf cameras add` takes the record.
    """
    from facecrf_ocio import read_photo
    from facecrf_ocio.chart.calibrate_chart import calibrate_chart
    from facecrf_ocio.settings import Settings

    try:
        outputs = OutputFiles.asked(output, **way)
    except LutError as error:
        return complain(str(error), USAGE)
    require_writable(output)
    outputs.require_free(photo)
    with status(f"reading the chart in {photo}"):
        source = read_photo(photo)
        estimate = calibrate_chart(source, corners, edition=edition).estimate
        if estimate.found is None:
            return tell(photo, estimate, (), notes=source.notes, as_json=as_json)
        written = outputs.write(photo, source, estimate, Settings())
    return tell(photo, estimate, written, notes=source.notes, as_json=as_json)
