"""`facecrf bench peers`: other software on the same brackets and charts."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from facecrf_ocio.cli.bench.bench_terminal import PATH, left_out
from facecrf_ocio.cli.terminal import DONE, ending_well

if TYPE_CHECKING:
    from facecrf_ocio.values import InverseCRF

TABLES = ("brackets", "merges", "charts", "published")
_TITLES = {
    "brackets": "Curves from brackets: a still scene, four exposures over six stops, 8 bits",
    "merges": "Merges of brackets by a curve that is given: RMS error in stops",
    "charts": "Curves from a photo of a color chart, turned, in uneven light, JPEG 92",
    "published": "Curves from one photo: what was published, and what is measured here",
}


@click.command()
@click.argument("tables", nargs=-1, type=click.Choice(TABLES), metavar="[TABLE]...")
@click.option(
    "--curves", multiple=True, type=PATH, metavar="FILE", help="Responses; by formula without it."
)
@click.option("--most", type=click.IntRange(1), default=12, show_default=True, help="Of a file.")
@ending_well
def peers(tables: tuple[str, ...], curves: tuple[Path, ...], most: int) -> int:
    """Run what others offer for brackets and charts beside ours, and tell what was published.

    TABLE is brackets, merges, charts or published; all without it. Peers come with the extra peers;
    one that is not installed is left out and named.
    """
    truths = _truths(curves, most)
    for table in tables or TABLES:
        click.echo(f"### {_TITLES[table]}\n")
        for line in _lines(table, truths):
            click.echo(line)
        click.echo()
    return DONE


def _truths(paths: tuple[Path, ...], most: int) -> list[InverseCRF]:
    from facecrf_ocio.benchmark.peers.made_curves import made_curves, some_of

    if not paths:
        return list(made_curves().values())
    return [curve for path in paths for curve in some_of(path, most)]


def _lines(table: str, truths: list[InverseCRF]) -> Iterator[str]:
    from facecrf_ocio.benchmark.peers.bracket_curves import Brackets
    from facecrf_ocio.benchmark.peers.chart_curves import Charts
    from facecrf_ocio.benchmark.peers.merge_errors import merge_rows
    from facecrf_ocio.benchmark.peers.peer_table import curve_rows
    from facecrf_ocio.benchmark.peers.published_figures import published_rows

    def missing(line: str) -> None:
        left_out([line])

    if table == "brackets":
        yield from curve_rows(Brackets(truths).answers(), truths, missing)
    elif table == "charts":
        yield from curve_rows(Charts(truths).answers(), truths, missing)
    elif table == "merges":
        yield from merge_rows(missing)
    else:
        yield from published_rows()
