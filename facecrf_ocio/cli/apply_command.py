"""`facecrf apply`: a photo through a LUT made before, into an EXR."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.linearize_command import require_exr_free, with_remedy
from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.options import PHOTO_PATH, TEXT_PATH, exr_options
from facecrf_ocio.cli.terminal import DONE, ending_well, one_line, say
from facecrf_ocio.cli.told_estimates import tell_notes


@click.command()
@click.argument("photo", type=PHOTO_PATH)
@click.option("--lut", required=True, type=TEXT_PATH, help="Any LUT file OpenColorIO reads.")
@click.option(
    "--direction",
    type=click.Choice(("linearize", "encode")),
    help="Toward light, for which a LUT that encodes is inverted, or away from it. Needed only "
    "for a LUT that encodes; ICC profiles go from the device to CIE XYZ.",
)
@exr_options("OUT.exr")
@click.option("--overwrite", is_flag=True, help="Replace an existing EXR.")
@ending_well
def apply(
    photo: Path,
    lut: Path,
    direction: str | None,
    output: Path,
    half: bool,
    compression: str,
    overwrite: bool,
) -> int:
    """Send PHOTO through a LUT made before and write it as a scene-linear EXR.

    The EXR's color space is the one that the LUT's own records name; of a LUT that keeps the
    channels apart, PHOTO's primaries; else `unknown`.
    """
    from facecrf_ocio import read_photo
    from facecrf_ocio.image.linearize import write_through_lut
    from facecrf_ocio.lut.lint import error_notes

    require_exr_free(output, overwrite=overwrite)
    with status(f"applying {lut}"):
        source = read_photo(photo)
        written = write_through_lut(
            output,
            source,
            lut,
            direction=direction,
            half=half,
            compression=compression,
            overwrite=overwrite,
        )
    say(f"{photo}: sent through {lut}")
    if source.scene_linear and direction != "encode":
        tell_notes(["it is linear light already; a LUT for code values bends it"])
    tell_notes((*source.notes, *error_notes(lut), *with_remedy(written.notes)))
    click.echo(one_line(f"  {written.path}"))
    return DONE
