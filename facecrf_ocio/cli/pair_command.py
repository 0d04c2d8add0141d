"""`facecrf pair`: camera raw and the camera's JPEG in, the LUTs of that camera out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from facecrf_ocio.cli.live import Bar
from facecrf_ocio.cli.options import PHOTO_PATH
from facecrf_ocio.cli.output_files import OutputFiles, folder_option, measurement_options
from facecrf_ocio.cli.terminal import USAGE, complain, ending_well, one_line, require_writable
from facecrf_ocio.cli.told_estimates import tell
from facecrf_ocio.errors import LutError

_STEPS = 4  # that the bar counts: two photos read, the fit, the outputs


@click.command()
@click.argument("linear", type=PHOTO_PATH, metavar="RAW")
@click.argument("encoded", type=PHOTO_PATH, required=False, metavar="[JPEG]")
@folder_option
@measurement_options
@ending_well
def pair(
    linear: Path,
    encoded: Path | None,
    output: Path,
    as_json: bool,
    **way: Any,
) -> int:
    """Fit the response of a camera to RAW and the JPEG it made of the same exposure.

    Without JPEG, to the picture that the camera stored inside RAW. RAW may also be any linear image
    (EXR, 16-bit TIFF or PNG), JPEG any encoded one. Size, crop, orientation, lens correction, white
    balance and color matrix may differ. The outputs are those of `facecrf calibrate`, named after
    JPEG, else after RAW; the band is the residual of the fit.
    """
    from facecrf_ocio import read_photo
    from facecrf_ocio.pair.calibrate_pair import calibrate_pair
    from facecrf_ocio.photo.camera_picture import camera_picture
    from facecrf_ocio.settings import Settings

    named, read = (linear, camera_picture) if encoded is None else (encoded, read_photo)
    try:
        outputs = OutputFiles.asked(output, **way)
    except LutError as error:
        return complain(str(error), USAGE)
    require_writable(output)
    outputs.require_free(named)
    with Bar() as bar:
        bar.show(one_line(f"reading {named}"), 0, _STEPS)
        photo = read(named)
        bar.show(one_line(f"reading {linear}"), 1, _STEPS)
        light = read_photo(linear)
        other = "the picture inside of it" if encoded is None else encoded
        bar.show(one_line(f"fitting {other} to {linear}"), 2, _STEPS)
        estimate = calibrate_pair(light, photo).estimate
        bar.show("writing", 3, _STEPS)
        written = outputs.write(named, photo, estimate, Settings())
    return tell(named, estimate, written, notes=photo.notes, as_json=as_json)
