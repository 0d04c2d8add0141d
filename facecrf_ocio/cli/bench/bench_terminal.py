"""What every command of `bench` tells on a terminal."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import click

from facecrf_ocio.cli.terminal import DONE, one_line

PATH = click.Path(path_type=Path)


def told(text: str, files: tuple[Path, ...]) -> int:
    """Tell a table and the files it was written to."""
    click.echo(text)
    for file in files:
        click.echo(one_line(str(file)))
    return DONE


def left_out(lines: Iterable[str]) -> None:
    """Tell what is not measured, and why."""
    for line in lines:
        click.echo(f"facecrf: left out: {one_line(line)}", err=True)
