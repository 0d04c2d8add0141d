"""`facecrf demo`: a portrait that anybody has, calibrated and linearized."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.live import status
from facecrf_ocio.cli.options import TEXT_PATH
from facecrf_ocio.cli.terminal import ending_well, hush_matplotlib, require_writable
from facecrf_ocio.cli.told_estimates import tell


@click.command()
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
    hush_matplotlib()
    from facecrf_ocio.cli.portrait_demo import run_demo

    require_writable(output)
    with status("calibrating a portrait of Grace Hopper"):
        photo, estimate, written = run_demo(output)
    return tell(photo, estimate, written)
