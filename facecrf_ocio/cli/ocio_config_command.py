"""The command `facecrf ocio-config`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from facecrf_ocio.cli.options import SPACE_NAMES, TEXT_PATH
from facecrf_ocio.cli.terminal import DONE, ending_well, say
from facecrf_ocio.cli.told_estimates import tell_notes
from facecrf_ocio.files.plain_text import counted


@click.command("ocio-config")
@click.argument("luts", nargs=-1, required=True, type=TEXT_PATH, metavar="DIR|LUT...")
@click.option("-o", "--output", required=True, type=TEXT_PATH, help="A .ocio or .ocioz file.")
@click.option(
    "--form",
    type=click.Choice(["auto", "spaces", "variable"]),
    default="auto",
    show_default=True,
    help="A color space per photo, or one that the context variable FACECRF_PHOTO directs.",
)
@click.option("--merge", metavar="CONFIG", help="Extend this config: a file or ocio://NAME.")
@click.option(
    "--reference",
    type=click.Choice(SPACE_NAMES),
    help="Scene reference of that config, if it has no role aces_interchange.",
)
@click.option(
    "--to",
    "space",
    type=click.Choice(SPACE_NAMES),
    help="What scene_linear shall be in a config of its own; lin_rec709 unless given.",
)
@click.option(
    "--primaries",
    type=click.Choice(["Rec.709", "Display P3", "Rec.2020", "Adobe RGB"]),
    help="Of all photos; unless given, what the records beside the LUTs say, else Rec.709.",
)
@click.option("--overwrite", is_flag=True, help="Replace existing files.")
@ending_well
def ocio_config(luts: tuple[Path, ...], output: Path, primaries: str | None, **choices: Any) -> int:
    """Write an OpenColorIO config of many photos' LUTs."""
    from facecrf_ocio.color.primaries import known_primaries
    from facecrf_ocio.lut.lint import error_notes
    from facecrf_ocio.ocio_config import write_config

    given = known_primaries(primaries, "assumed") if primaries else None
    written = write_config(luts, output, primaries=given, **choices)
    config, *files = written
    what = (
        f"config with {counted(len(files), 'file')} beside it"
        if files
        else "config with its LUTs inside"
    )
    if choices["merge"]:
        what += f"; its profile version stays {_profile_version(config)}"
    say(f"{config}: {what}")
    # Those in folders are as commands of ours wrote them, and may be thousands.
    tell_notes(tuple(note for lut in luts if lut.is_file() for note in error_notes(lut)))
    return DONE


def _profile_version(config: Path) -> str:
    """The version that hosts must read, and whether Blender does."""
    from facecrf_ocio.ocio_config import NEWEST_OF_BLENDER, profile_version

    version = profile_version(config)
    newer = version > NEWEST_OF_BLENDER
    return f"{version[0]}.{version[1]}" + (", newer than Blender 5.0 reads (2.4)" if newer else "")
