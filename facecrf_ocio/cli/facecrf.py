"""The `facecrf` command: arguments in, one library call each, exit codes out.

Heavy modules are imported by the commands that need them, so that `facecrf --help` is instant.
"""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio import __version__
from facecrf_ocio.cli.batch_command import batch
from facecrf_ocio.cli.bench_command import bench
from facecrf_ocio.cli.bracket_command import bracket
from facecrf_ocio.cli.calibrate_command import calibrate
from facecrf_ocio.cli.cameras_command import cameras
from facecrf_ocio.cli.chart_command import chart
from facecrf_ocio.cli.clip_command import clip
from facecrf_ocio.cli.completion_command import completion
from facecrf_ocio.cli.doctor_command import doctor
from facecrf_ocio.cli.explain_command import explain
from facecrf_ocio.cli.linearize_command import linearize, require_exr_free
from facecrf_ocio.cli.lint_command import lint
from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.merge_command import merge
from facecrf_ocio.cli.ocio_config_command import ocio_config
from facecrf_ocio.cli.options import (
    PHOTO_PATH,
    TEXT_PATH,
    exr_options,
)
from facecrf_ocio.cli.pair_command import pair
from facecrf_ocio.cli.report_command import report
from facecrf_ocio.cli.sections import EXAMPLES, Sections, examples
from facecrf_ocio.cli.show_command import show
from facecrf_ocio.cli.terminal import (
    DONE,
    EXIT_CODES,
    ending_well,
    one_line,
    require_writable,
    speak_any_name,
    tell,
)
from facecrf_ocio.cli.verify_command import verify


@click.group(
    cls=Sections,
    epilog=f"{examples(EXAMPLES[''])}\n\n{EXIT_CODES}",
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(__version__, prog_name="facecrf")
def main() -> None:
    """From one photo with a face to an OCIO transform that makes it scene-linear."""
    speak_any_name()


main.add_command(calibrate)
main.add_command(linearize)
main.add_command(bench)
main.add_command(pair)
main.add_command(bracket)
main.add_command(chart)
main.add_command(merge)
main.add_command(clip)
main.add_command(cameras)
main.add_command(ocio_config)
main.add_command(lint)
main.add_command(batch)
main.add_command(verify)
main.add_command(report)
main.add_command(show)
main.add_command(explain)
main.add_command(doctor)
main.add_command(completion)


@main.command()
@click.argument("photo", type=PHOTO_PATH)
@click.option("--lut", required=True, type=TEXT_PATH, help="Any LUT file OpenColorIO reads.")
@click.option(
    "--direction",
    type=click.Choice(("linearize", "encode")),
    help="Toward light, for which a LUT that encodes is inverted, or away from it. Needed only "
    "for a LUT that encodes; ICC profiles go from the device to CIE XYZ.",
)
@exr_options
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

    require_exr_free(output, overwrite=overwrite)
    with status(f"applying {lut}"):
        written = write_through_lut(
            output,
            read_photo(photo),
            lut,
            direction=direction,
            half=half,
            compression=compression,
            overwrite=overwrite,
        )
    click.echo(one_line(f"{photo}: sent through {lut}"))
    click.echo(one_line(f"  {written}"))
    return DONE


@main.command()
@click.option(
    "-o",
    "--output",
    default=Path("facecrf-demo"),
    show_default=True,
    type=TEXT_PATH,
    metavar="DIR",
    help="Folder for the demo's files, which replace those of an earlier demo.",
)
@ending_well
def demo(output: Path) -> int:
    """Calibrate and linearize a portrait that comes with matplotlib (public domain)."""
    from facecrf_ocio.cli.portrait_demo import run_demo

    require_writable(output)
    with status("calibrating a portrait of Grace Hopper"):
        photo, estimate, written = run_demo(output)
    return tell(photo, estimate, written)
