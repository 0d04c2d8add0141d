"""`facecrf pair`: camera raw and the camera's JPEG in, the LUTs of that camera out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from facecrf_ocio.cli.options import PHOTO_PATH
from facecrf_ocio.cli.output_files import OutputFiles, folder_option, measurement_options
from facecrf_ocio.cli.terminal import USAGE, complain, ending_well, require_writable, status, tell
from facecrf_ocio.errors import LutError


@click.command()
@click.argument("linear", type=PHOTO_PATH, metavar="RAW")
@click.argument("encoded", type=PHOTO_PATH, metavar="JPEG")
@folder_option
@measurement_options
@ending_well
def pair(
    linear: Path,
    encoded: Path,
    output: Path,
    as_json: bool,
    **way: Any,
) -> int:
    """Fit the response of a camera to RAW and the JPEG it made of the same exposure.

    RAW may also be any linear image (EXR, 16-bit TIFF or PNG), JPEG any encoded one. Size, crop,
    orientation, lens correction, white balance and color matrix may differ. The outputs are those
    of `facecrf calibrate`, named after JPEG; the band is the residual of the fit.
    """
    from facecrf_ocio import read_photo
    from facecrf_ocio.pair.calibrate_pair import calibrate_pair
    from facecrf_ocio.settings import Settings

    try:
        outputs = OutputFiles.asked(output, **way)
    except LutError as error:
        return complain(str(error), USAGE)
    require_writable(output)
    outputs.require_free(encoded)
    with status(f"fitting {encoded} to {linear}"):
        photo = read_photo(encoded)
        estimate = calibrate_pair(read_photo(linear), photo).estimate
        written = outputs.write(encoded, photo, estimate, Settings())
    return tell(encoded, estimate, written, as_json=as_json)
