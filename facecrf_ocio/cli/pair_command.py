"""`facecrf pair`: camera raw and the camera's JPEG in, the LUTs of that camera out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from facecrf_ocio.cli.calibrate_command import PLOT_SUFFIX, formats_option
from facecrf_ocio.cli.options import PHOTO_PATH, TEXT_PATH, direction_options
from facecrf_ocio.cli.terminal import USAGE, complain, ending_well, require_writable, status, tell
from facecrf_ocio.errors import LutError


@click.command()
@click.argument("linear", type=PHOTO_PATH, metavar="RAW")
@click.argument("encoded", type=PHOTO_PATH, metavar="JPEG")
@click.option(
    "-o", "--output", required=True, type=TEXT_PATH, metavar="DIR", help="Where to write."
)
@formats_option
@direction_options
@click.option("--plot", is_flag=True, help=f"Also write NAME{PLOT_SUFFIX}: the curves.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@click.option("--overwrite", is_flag=True, help="Replace existing outputs.")
@ending_well
def pair(
    linear: Path,
    encoded: Path,
    output: Path,
    formats: tuple[str, ...],
    plot: bool,
    as_json: bool,
    overwrite: bool,
    **way: Any,
) -> int:
    """Fit the response of a camera to RAW and the JPEG it made of the same exposure.

    RAW may also be any linear image (EXR, 16-bit TIFF or PNG), JPEG any encoded one. Size, crop,
    orientation, lens correction, white balance and color matrix may differ. The outputs are those
    of `facecrf calibrate`, named after JPEG; the band is the residual of the fit.
    """
    from facecrf_ocio import read_photo
    from facecrf_ocio.files.atomic import require_free
    from facecrf_ocio.lut.write import endings
    from facecrf_ocio.pair.calibrate_pair import calibrate_pair
    from facecrf_ocio.record.outputs import require_outputs_free, write_outputs
    from facecrf_ocio.settings import Settings

    try:
        formats = endings(formats, way["direction"], way["space"] or "")
    except LutError as error:
        return complain(str(error), USAGE)
    require_writable(output)
    picture = output / f"{encoded.stem}{PLOT_SUFFIX}"
    require_outputs_free(encoded, output, formats, overwrite=overwrite)
    if plot:
        require_free(picture, overwrite=overwrite)
    with status(f"fitting {encoded} to {linear}"):
        photo = read_photo(encoded)
        estimate = calibrate_pair(read_photo(linear), photo).estimate
        also = []
        if plot:
            from facecrf_ocio.plots.calibration_plot import plot_draft

            also.append(plot_draft(picture, photo, estimate, Settings()))
        written = write_outputs(
            photo, estimate, Settings(), output, formats, overwrite=overwrite, also=also
        )
    return tell(encoded, estimate, written, as_json=as_json)
