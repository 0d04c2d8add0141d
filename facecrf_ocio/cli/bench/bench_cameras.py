"""`facecrf bench cameras`: what a measured response of its camera adds to a photo."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.bench.bench_terminal import PATH
from facecrf_ocio.cli.live import counting
from facecrf_ocio.cli.terminal import DONE, ending_well


@click.command("cameras")
@click.option("--faces", required=True, type=PATH, metavar="DIR", help="Linear images.")
@click.option("--pattern", default="*", help="Names to take from it, e.g. 'dev_*_clean.exr'.")
@click.option(
    "--curves", required=True, multiple=True, type=PATH, metavar="FILE", help="May be repeated."
)
@click.option(
    "--repeat",
    type=click.IntRange(1),
    default=2,
    show_default=True,
    help="Photos of each pair of measurements.",
)
@ending_well
def bench_cameras(faces: Path, pattern: str, curves: tuple[Path, ...], repeat: int) -> int:
    """Photos whose camera is known by a measurement that is not that of their own curve."""
    from facecrf_ocio.benchmark.camera_known import known_markdown, measure_known
    from facecrf_ocio.benchmark.images import find_linear_images
    from facecrf_ocio.benchmark.responses import read_responses

    files = [read_responses(path) for path in curves]
    images = find_linear_images(faces, pattern).images
    with counting("cases", plainly=True) as done:
        results = list(measure_known(images, files, repeat=repeat, progress=done))
    click.echo(known_markdown(results))
    return DONE
