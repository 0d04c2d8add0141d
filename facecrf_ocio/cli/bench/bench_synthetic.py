"""`facecrf bench synthetic`: every estimator on the same photos of known responses."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from facecrf_ocio.cli.bench.bench_options import prior_option
from facecrf_ocio.cli.bench.bench_plan import PROTOCOLS, plan
from facecrf_ocio.cli.bench.bench_terminal import PATH
from facecrf_ocio.cli.live import counting
from facecrf_ocio.cli.terminal import (
    DONE,
    FAILED,
    complain,
    ending_well,
    one_line,
    require_writable,
)
from facecrf_ocio.estimators import ESTIMATOR_NAMES


@click.command()
@click.option(
    "--faces",
    required=True,
    type=PATH,
    metavar="DIR",
    help="Folder of linear images with faces: EXR, 16-bit TIFF or PNG, camera raw.",
)
@click.option("--pattern", default="*", help="Names to take from it, e.g. 'dev_*_noisy.exr'.")
@click.option(
    "--curves",
    required=True,
    type=PATH,
    metavar="FILE",
    help="Responses: DoRF's .mat, or an .npz with inverse curves (C, K) or (C, 3, K).",
)
@click.option(
    "--estimators",
    default="all",
    show_default=True,
    metavar="NAMES",
    help=f"all, or a list with commas of {', '.join(ESTIMATOR_NAMES)}.",
)
@click.option("-o", "--output", required=True, type=PATH, metavar="DIR")
@click.option(
    "--protocol",
    type=click.Choice(list(PROTOCOLS)),
    default="both",
    show_default=True,
    help="What the prior has seen: not the tested curve's fold, or all DoRF curves.",
)
@click.option(
    "--folds",
    type=click.IntRange(2),
    default=5,
    show_default=True,
    help="Parts of the curves, each tested by a prior of the others.",
)
@click.option(
    "--bits",
    type=click.IntRange(8, 16),
    default=8,
    show_default=True,
    help="Of the encoded photos.",
)
@click.option("--jpeg", type=click.IntRange(1, 100), metavar="QUALITY", help="Store as JPEG.")
@click.option(
    "--noise", type=click.FloatRange(0, min_open=True), metavar="ISO", help="Add a sensor's noise."
)
@click.option("--every", type=click.IntRange(1), default=1, help="Test every n-th curve.")
@click.option("--limit-curves", type=click.IntRange(1), help="Test so many, spread evenly.")
@prior_option
@click.option(
    "--set",
    "assignments",
    multiple=True,
    metavar="NAME=VALUE",
    help="Change one of the estimators' settings; may be repeated.",
)
@click.option(
    "--groups",
    type=(PATH, str),
    metavar="FILE COLUMN",
    help="Group the images by a column of a tab-separated table of their names.",
)
@click.option("--jobs", type=click.IntRange(1), default=1, show_default=True, help="Processes.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the noise.")
@ending_well
def synthetic(output: Path, jobs: int, groups: tuple[Path, str] | None, **choices: Any) -> int:
    """Encode linear images with known responses and recover them (Table 1 of the paper).

    Interrupted and started again with the same options and output, it goes on where it was.
    """
    from facecrf_ocio.benchmark.groups import image_groups
    from facecrf_ocio.benchmark.table1 import run_synthetic

    asked = plan(**choices)
    group_of = image_groups(*groups) if groups else {}
    require_writable(output)
    try:
        with counting("cases", plainly=True) as tell:
            table = run_synthetic(asked, output, jobs=jobs, progress=tell, groups=group_of)
    except KeyboardInterrupt:
        return complain("interrupted; the same command goes on where it was", FAILED)
    click.echo(f"{table.text}\n{table.timing}")
    for file in table.files:
        click.echo(one_line(str(file)))
    failures = [result for result in table.results if result.outcome == "failed"]
    if not failures:
        return DONE
    return complain(
        f"{len(failures)} of {len(table.results)} estimates broke down, the first was "
        f"{failures[0].estimator} on {failures[0].image}: {failures[0].reason}",
        FAILED,
    )
