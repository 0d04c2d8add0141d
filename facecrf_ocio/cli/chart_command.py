"""`facecrf chart`: a photo of a color chart in, the LUTs of that camera out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from facecrf_ocio.cli.calibrate_command import PLOT_SUFFIX, formats_option
from facecrf_ocio.cli.options import PHOTO_PATH, TEXT_PATH, direction_options
from facecrf_ocio.cli.terminal import USAGE, complain, ending_well, require_writable, status, tell
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
@click.option(
    "-o", "--output", required=True, type=TEXT_PATH, metavar="DIR", help="Where to write."
)
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
@formats_option
@direction_options
@click.option("--plot", is_flag=True, help=f"Also write NAME{PLOT_SUFFIX}: the curves.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("--overwrite", is_flag=True, help="Replace existing outputs.")
@ending_well
def chart(
    photo: Path,
    output: Path,
    corners: tuple[tuple[float, float], ...] | None,
    edition: str,
    formats: tuple[str, ...],
    plot: bool,
    as_json: bool,
    overwrite: bool,
    **way: Any,
) -> int:
    """Find the response of a camera from PHOTO, which shows a ColorChecker Classic.

    One curve a channel from the gray row's published reflectances, uneven light taken out. The
    outputs are those of `facecrf calibrate`; `facecrf cameras add` takes the record.
    """
    from facecrf_ocio import read_photo
    from facecrf_ocio.chart.calibrate_chart import calibrate_chart
    from facecrf_ocio.files.atomic import require_free
    from facecrf_ocio.lut.write import endings
    from facecrf_ocio.record.outputs import require_outputs_free, write_outputs
    from facecrf_ocio.settings import Settings

    try:
        formats = endings(formats, way["direction"], way["space"] or "")
    except LutError as error:
        return complain(str(error), USAGE)
    require_writable(output)
    picture = output / f"{photo.stem}{PLOT_SUFFIX}"
    require_outputs_free(photo, output, formats, overwrite=overwrite)
    if plot:
        require_free(picture, overwrite=overwrite)
    with status(f"reading the chart in {photo}"):
        source = read_photo(photo)
        estimate = calibrate_chart(source, corners, edition=edition).estimate
        if estimate.found is None:
            return tell(photo, estimate, (), as_json=as_json)
        also = []
        if plot:
            from facecrf_ocio.plots.calibration_plot import plot_draft

            also.append(plot_draft(picture, source, estimate, Settings()))
        written = write_outputs(
            source, estimate, Settings(), output, formats, overwrite=overwrite, also=also
        )
    return tell(photo, estimate, written, as_json=as_json)
