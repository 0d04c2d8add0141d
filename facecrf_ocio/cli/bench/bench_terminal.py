"""What every command of `bench` tells on a terminal: how far it is, and what it made."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from facecrf_ocio.cli.terminal import DONE, one_line

PATH = click.Path(path_type=Path)
_REPORTS = 20  # lines of progress where there is no terminal


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


@contextmanager
def progress() -> Iterator[Callable[[int, int], None]]:
    """A bar on a terminal's stderr, else a line now and then."""
    if not sys.stderr.isatty():
        yield _ProgressLines()
        return
    from rich.console import Console
    from rich.progress import MofNCompleteColumn, Progress, TimeElapsedColumn

    columns = (*Progress.get_default_columns(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("measuring")
        yield lambda done, total: bar.update(task, completed=done, total=total)


class _ProgressLines:
    """Says so on stderr when another twentieth is done."""

    def __init__(self) -> None:
        self._told = -1

    def __call__(self, done: int, total: int) -> None:
        if done * _REPORTS // total > self._told:
            self._told = done * _REPORTS // total
            click.echo(f"facecrf: {done} of {total} cases are done", err=True)
