"""`facecrf bench consistency`: what estimates of anyone's photos must satisfy."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.bench.bench_terminal import PATH, left_out, told
from facecrf_ocio.cli.live import counting
from facecrf_ocio.cli.terminal import ending_well, require_writable


@click.command()
@click.argument("photos", nargs=-1, required=True, type=PATH)
@click.option("--half", is_flag=True, help="Take the photos at half their width, to save time.")
@click.option("-o", "--output", type=PATH, metavar="DIR", help="Also write the table there.")
@ending_well
def consistency(photos: tuple[Path, ...], half: bool, output: Path | None) -> int:
    """Test estimates of PHOTOS without knowing the truth.

    Sent through known curves, a photo's estimate must change as they say; encoded as sRGB, it must
    be sRGB; photos of one camera must agree.
    """
    from facecrf_ocio.benchmark.consistency import (
        consistency_markdown,
        measure_consistency,
        write_consistency,
    )

    if output is not None:
        require_writable(output)
        output.mkdir(parents=True, exist_ok=True)
    with counting("cases", plainly=True) as tell:
        found = measure_consistency(photos, half=half, progress=tell)
    left_out(found.left_out)
    files = () if output is None else write_consistency(found, output)
    return told(consistency_markdown(found), files)
