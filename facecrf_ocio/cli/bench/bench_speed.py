"""`facecrf bench speed`: what the work costs beside what nobody can do without."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.bench.bench_terminal import PATH
from facecrf_ocio.cli.terminal import DONE, ending_well, one_line

# As `speed_table.KINDS`, which is not imported for the help; a test compares them.
_KINDS = ("calibrate", "cold", "apply", "exr", "batch", "memory", "report")


@click.command()
@click.option("--only", multiple=True, type=click.Choice(_KINDS), help="These rows; all otherwise.")
@click.option("--history", type=PATH, metavar="FILE.csv", help="Append the rows to it.")
@click.option("--against", type=PATH, metavar="FILE.csv", help="Warn of rows that got slower.")
@click.option("--types", is_flag=True, help="Time every pair of types and every way to an EXR.")
@click.option("--lut", type=PATH, metavar="FILE", help="For --types; by default the sRGB curve.")
@click.option(
    "--megapixels",
    type=click.FloatRange(0.01, 150),
    default=24,
    show_default=True,
    help="For --types.",
)
@click.option(
    "--scale",
    type=click.FloatRange(0.01, 1),
    default=1,
    show_default=True,
    help="Factor on the pixels of the rows.",
)
@click.option(
    "--repeat",
    type=click.IntRange(1),
    default=5,
    show_default=True,
    help="Time each so often, in turn; the shortest counts.",
)
@ending_well
def speed(
    only: tuple[str, ...],
    history: Path | None,
    against: Path | None,
    types: bool,
    lut: Path | None,
    megapixels: float,
    scale: float,
    repeat: int,
) -> int:
    """Time reading, estimating, applying and writing beside a decoder, an encoder, OpenColorIO.

    Rows take turns with their floor, so a busy machine hits both alike: trust the ratios.
    """
    if types:
        _types(lut, megapixels, repeat)
        return DONE

    from facecrf_ocio.benchmark.speed.speed_history import Run, append, slower
    from facecrf_ocio.benchmark.speed.speed_row import table_of
    from facecrf_ocio.benchmark.speed.speed_table import commit, machine, measure_rows, today

    run = Run(today(), commit(Path()), machine(), scale)
    rows = measure_rows(only or _KINDS, scale, repeat)
    click.echo(f"{run.machine}; best of {repeat}, each in turn with its floor")
    click.echo(table_of(rows))
    for line in () if against is None else slower(against, run, rows):
        click.echo(f"warning: {one_line(line)}", err=True)
    if history is not None:
        append(history, run, rows)
        click.echo(one_line(str(history)))
    return DONE


def _types(lut: Path | None, megapixels: float, repeat: int) -> None:
    import tempfile

    from facecrf_ocio.benchmark.speed.linearize_rows import srgb_lut
    from facecrf_ocio.benchmark.speed.linearize_speed import measure_speed

    with tempfile.TemporaryDirectory(prefix="facecrf-") as folder:
        click.echo(measure_speed(lut or srgb_lut(Path(folder)), megapixels, repeat).text)
