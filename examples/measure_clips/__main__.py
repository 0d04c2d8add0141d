"""Measure clips of known curves: python examples/measure_clips --faces DIR --curves FILE -o DIR."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from clips_known import ClipPlan, choose_cells, run_clips

from facecrf_ocio.benchmark.images import find_linear_images
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.cli.bench.bench_terminal import PATH, left_out, told
from facecrf_ocio.cli.live import counting
from facecrf_ocio.cli.terminal import FAILED, complain, ending_well, require_writable


@click.command()
@click.option("--faces", required=True, type=PATH, metavar="DIR", help="Linear images.")
@click.option("--pattern", default="*", help="Names to take from it, e.g. 'dev_*_clean.exr'.")
@click.option("--curves", required=True, type=PATH, metavar="FILE", help="Responses.")
@click.option(
    "--cells", default="all", show_default=True, help="Parts of rows' names, between semicolons."
)
@click.option("--count", type=click.IntRange(1), default=10, show_default=True, help="Of a row.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True)
@click.option("--minutes", type=float, default=float("inf"), help="After which none is begun.")
@click.option("-o", "--output", required=True, type=PATH, metavar="DIR")
@ending_well
def measure_clips(
    faces: Path,
    pattern: str,
    curves: Path,
    cells: str,
    minutes: float,
    output: Path,
    **rest: Any,
) -> int:
    """Take clips of known curves: moving camera and exposure, noise, H.264 and JPEG.

    Interrupted and started again with the same options and output, it goes on where it was.
    """

    chosen, responses = choose_cells(cells), read_responses(curves)
    found = find_linear_images(faces, pattern)
    left_out(found.left_out)
    require_writable(output)
    plan = ClipPlan(found.images, responses, cells=chosen, **rest)
    try:
        with counting("clips", plainly=True) as tell:
            return told(*run_clips(plan, output, minutes=minutes, progress=tell))
    except KeyboardInterrupt:
        return complain("interrupted; the same command goes on where it was", FAILED)


if __name__ == "__main__":
    measure_clips()
