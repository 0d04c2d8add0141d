"""`facecrf bench pairs`: every estimator beside real cameras."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.bench.bench_options import estimators_option
from facecrf_ocio.cli.bench.bench_terminal import PATH, told
from facecrf_ocio.cli.live import counting
from facecrf_ocio.cli.terminal import ending_well, require_writable
from facecrf_ocio.settings import Settings


@click.command()
@click.argument("source", type=PATH)
@estimators_option
@click.option("-o", "--output", required=True, type=PATH, metavar="DIR")
@ending_well
def pairs(source: Path, estimators: str, output: Path) -> int:
    """Compare every estimator with real cameras (the paper's Table 2).

    SOURCE is a folder with a.dng and a.jpg (or a.exr and a.png) of the same exposures, or a list of
    two columns, separated by a tab: linear image, encoded image. The truth is what `facecrf pair`
    fits to them. Interrupted and started again, it goes on where it was.
    """
    from facecrf_ocio.benchmark.cases import choose_estimators
    from facecrf_ocio.benchmark.table2 import find_pairs, run_pairs

    chosen = choose_estimators(estimators)
    found = find_pairs(source)
    require_writable(output)
    with counting("cases", plainly=True) as tell:
        table = run_pairs(found, chosen, output, Settings(), tell)
    return told(table.text, table.files)
