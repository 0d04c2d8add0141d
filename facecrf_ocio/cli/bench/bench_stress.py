"""`facecrf bench stress`: faces and responses through all that photos go through."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from facecrf_ocio.cli.bench.bench_terminal import PATH, left_out, told
from facecrf_ocio.cli.live import counting
from facecrf_ocio.cli.terminal import FAILED, complain, ending_well, require_writable


@click.command()
@click.option("--faces", required=True, type=PATH, metavar="DIR", help="Linear images.")
@click.option("--pattern", default="*", help="Names to take from it, e.g. 'dev_*_noisy.exr'.")
@click.option("--curves", required=True, type=PATH, metavar="FILE", help="Responses.")
@click.option(
    "--kinds", default="all", show_default=True, help="Of the responses, a list with commas."
)
@click.option("--green", is_flag=True, help="Take the green curve for all channels.")
@click.option("--cells", default="all", show_default=True, metavar="NAMES", help="Rows to measure.")
@click.option(
    "--count",
    type=click.IntRange(1),
    default=24,
    show_default=True,
    help="Photos of a cell; three times as many of a day's photos, fewer of large ones.",
)
@click.option("--title", help="Of the table; by default what was measured on.")
@click.option("--jobs", type=click.IntRange(1), default=1, show_default=True, help="Processes.")
@click.option(
    "--seed", type=click.IntRange(0), default=0, show_default=True, help="Of all that is drawn."
)
@click.option("-o", "--output", required=True, type=PATH, metavar="DIR")
@ending_well
def stress(
    faces: Path,
    pattern: str,
    curves: Path,
    kinds: str,
    cells: str,
    title: str | None,
    output: Path,
    jobs: int,
    **rest: Any,
) -> int:
    """Send faces through all that photos go through: exposure, color, processing, size, a day.

    Every row of the table is one condition. The headline is `day`: combinations drawn at random.
    Interrupted and started again with the same options and output, it goes on where it was.
    """
    from facecrf_ocio.benchmark.images import find_linear_images
    from facecrf_ocio.benchmark.responses import read_responses
    from facecrf_ocio.benchmark.stress import StressPlan, choose_cells, rows_of_kinds, run_stress

    responses = read_responses(curves)
    rows, chosen = rows_of_kinds(responses, kinds), choose_cells(cells)
    found = find_linear_images(faces, pattern)
    left_out(found.left_out)
    which = f"{len(found.images)} images, {len(rows)} responses of {curves.name}"
    plan = StressPlan(title or which, found.images, responses, rows, chosen, **rest)
    require_writable(output)
    try:
        with counting("cases", plainly=True) as tell:
            return told(*run_stress(plan, output, jobs=jobs, progress=tell))
    except KeyboardInterrupt:
        return complain("interrupted; the same command goes on where it was", FAILED)
