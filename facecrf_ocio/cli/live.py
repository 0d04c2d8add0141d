"""Signs of life on a terminal's stderr: a spinner where nothing can be counted, else a bar."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

import click

from facecrf_ocio.cli.terminal import fitted
from facecrf_ocio.files.plain_text import one_line

if TYPE_CHECKING:
    from rich.progress import Progress, Task

_BAR = 16  # [letter] leaves most of 40 for the words
_REPORTS = 20  # lines of progress where there is no terminal


@contextmanager
def status(message: str) -> Iterator[None]:
    """Show a spinner on a terminal; print nothing meanwhile, and nothing elsewhere."""
    if not sys.stderr.isatty():
        yield
        return
    from rich.console import Console
    from rich.markup import escape

    with Console(stderr=True).status(escape(one_line(message))):
        yield


class Bar:
    """A bar on a terminal, with words that break where it is narrow; nothing elsewhere."""

    def __init__(self) -> None:
        self._progress: Progress | None = None

    def __enter__(self) -> Bar:
        if sys.stderr.isatty():
            self._progress = _rich_bar()
            self._progress.add_task("")
            self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._progress is not None:
            self._progress.stop()

    def __bool__(self) -> bool:
        return self._progress is not None

    def show(self, words: str, done: int, total: int | None) -> None:
        """Fill the bar, as far as a total is known, and write words beside it."""
        if self._progress is not None:
            task = self._progress.task_ids[0]
            self._progress.update(
                task, description=words, completed=done, total=total, refresh=True
            )

    def say(self, line: str, *, err: bool = True) -> None:
        """Print a line, above the bar if there is one."""
        if self._progress is not None:
            self._progress.stop()
        click.echo(fitted(line, sys.stderr) if err else line, err=err)
        if self._progress is not None:
            self._begin_again(self._progress.tasks[0])

    def _begin_again(self, task: Task) -> None:
        """Draw the bar anew below: the old one would clear as many lines as it had itself."""
        self._progress = _rich_bar()
        self._progress.add_task(task.description, total=task.total, completed=int(task.completed))
        self._progress.start()


@contextmanager
def counting(things: str, *, plainly: bool = False) -> Iterator[Callable[[int, int], None]]:
    """A bar of how many things are done, of how many, and the time left.

    `plainly` prints a line now and then where there is no terminal.
    """
    begin, said = monotonic(), -1
    with Bar() as bar:

        def tell(done: int, total: int) -> None:
            nonlocal said
            share = done * _REPORTS // max(total, 1)
            if bar:
                bar.show(f"{done} of {total} {things}{_left(begin, done, total)}", done, total)
            elif plainly and share > said:
                said = share
                click.echo(f"facecrf: {done} of {total} {things} are done", err=True)

        yield tell


def _left(begin: float, done: int, total: int) -> str:
    if not 0 < done < total:
        return ""
    return f", {in_words((monotonic() - begin) / done * (total - done))} left"


def in_words(seconds: float) -> str:
    """A time, as a person would say it."""
    minutes = seconds / 60
    if minutes < 1:
        return f"{seconds:.0f} s"
    return f"{minutes:.0f} min" if minutes < 90 else f"{minutes / 60:.0f} h"


def _rich_bar() -> Progress:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn
    from rich.table import Column

    words = TextColumn("{task.description}", markup=False, table_column=Column(ratio=1))
    bar = BarColumn(bar_width=_BAR)
    return Progress(bar, words, console=Console(stderr=True), transient=True, expand=True)
