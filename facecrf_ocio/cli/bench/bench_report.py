"""`facecrf bench report`: one page of what benches wrote."""

from __future__ import annotations

from pathlib import Path

import click

from facecrf_ocio.cli.bench.bench_terminal import PATH
from facecrf_ocio.cli.terminal import DONE, ending_well, one_line, require_writable


@click.command()
@click.argument("folders", nargs=-1, required=True, type=PATH)
@click.option("-o", "--output", required=True, type=PATH, metavar="PAGE.md")
@click.option(
    "--findings",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE",
    help="Markdown before the tables.",
)
@ending_well
def report(folders: tuple[Path, ...], output: Path, findings: Path | None) -> int:
    """Assemble what benches wrote to FOLDERS into one page, its pictures in results/ beside it.

    An earlier page is replaced.
    """
    from facecrf_ocio.benchmark.results_page import results_page
    from facecrf_ocio.files.atomic import Draft, write_files

    text = "" if findings is None else findings.read_text(encoding="utf-8")
    page, pictures = results_page(folders, text, "results")
    require_writable(output.parent)
    beside = output.parent / "results"
    beside.mkdir(parents=True, exist_ok=True)
    contents = {beside / picture.name: picture.read_bytes() for picture in pictures}
    contents[output] = page.encode()
    drafts = [Draft(path, content, lambda _: None) for path, content in contents.items()]
    for file in write_files(drafts, overwrite=True):
        click.echo(one_line(str(file)))
    return DONE
