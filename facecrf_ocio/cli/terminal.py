"""How a command speaks and ends: one line per complaint, and its exit code."""

from __future__ import annotations

import io
import os
import shutil
import sys
import textwrap
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any, TextIO

import click

from facecrf_ocio.errors import (
    IS_FOLDER,
    FaceCRFError,
    LutError,
    OutputError,
    PhotoError,
    SettingsError,
    reason_of,
)
from facecrf_ocio.files.plain_text import one_line as one_line  # noqa: PLC0414 - for commands
from facecrf_ocio.files.plain_text import plain_text

# Exit codes, which EXIT_CODES explains to users.
DONE, FAILED, USAGE, UNREADABLE, NOTHING = 0, 1, 2, 3, 4
EXIT_CODES = """
Exit codes: 0 done; 1 an output cannot be written; 2 wrong usage; 3 a file cannot be read;
4 a photo gives nothing to calibrate from; 130 interrupted (Ctrl-C). Of several photos, the worst:
1, then 3, then 4.
"""
INTERRUPTED = 130  # exit code of what Ctrl-C ended: 128 + SIGINT, as shells have it
_CODES = {
    PhotoError: UNREADABLE,
    LutError: UNREADABLE,
    OutputError: FAILED,
    SettingsError: USAGE,
}

_NARROWEST = 30  # columns: below, words are longer than lines
_INDENT = 4  # columns before the second line of what is broken

# Click's own ways out, and a reader of stdout that went away, which Click handles.
PASSED_ON = (click.ClickException, click.exceptions.Exit, click.Abort, BrokenPipeError)

Command = Callable[..., int]


def ending_well(command: Command) -> Command:
    """Exit with the code a command returns, or with that of our own error, told in one line."""

    @wraps(command)
    def run(*args: Any, **kwargs: Any) -> int:
        try:
            code = command(*args, **kwargs)
        except PASSED_ON:
            raise
        except Exception as error:  # the last net: one line for whatever a library raises
            _raise_interrupt_of(error)
            code = complain(problem_of(error), exit_code_of(error))
        sys.exit(code)

    return run


def _raise_interrupt_of(error: BaseException | None) -> None:
    """Raise KeyboardInterrupt where Ctrl-C is why a library could not be loaded."""
    while error is not None:
        if isinstance(error, KeyboardInterrupt):
            raise error
        error = error.__cause__ or error.__context__


def exit_code_of(error: Exception) -> int:
    """Return the exit code an error stands for."""
    return next((code for kind, code in _CODES.items() if isinstance(error, kind)), FAILED)


def problem_of(error: Exception) -> str:
    """Return what an error says, and of one that nobody foresaw, what it is.

    With FACECRF_DEBUG in the environment that one is raised again, for whoever looks for its place.
    """
    if isinstance(error, PhotoError) and error.problem == IS_FOLDER:
        return f"{error}, or take all of it: facecrf batch"
    if isinstance(error, FaceCRFError):
        return error.on_command_line()
    if isinstance(error, MemoryError):
        return "not enough memory; use smaller files"
    if isinstance(error, OSError) and error.filename is not None:
        return f"{os.fsdecode(error.filename)}: {reason_of(error)}; check the name and the disk"
    if os.environ.get("FACECRF_DEBUG"):
        raise error
    return f"unexpected {type(error).__name__}: {plain_text(error)}; please report this"


def complain(message: str, code: int) -> int:
    """Print one line on stderr and return the code."""
    click.echo(fitted(f"facecrf: {one_line(message)}", sys.stderr), err=True)
    return code


def interrupted(advice: str = "files that it named are whole, and none is half written") -> int:
    """Say that Ctrl-C ended a command, below what the terminal shows of it; return the code."""
    if sys.stderr.isatty():
        click.echo(err=True)
    return complain(f"interrupted; {advice}", INTERRUPTED)


def say(line: str, *, err: bool = False, indent: int = _INDENT) -> None:
    """Print one line, broken between words where a terminal is narrower."""
    stream = sys.stderr if err else sys.stdout
    click.echo(fitted(one_line(line), stream, indent), err=err)


def columns() -> int:
    """Return how wide the terminal is; 80 where there is none."""
    return max(shutil.get_terminal_size().columns, _NARROWEST)


def fitted(line: str, stream: TextIO, indent: int = _INDENT) -> str:
    """Break a line between words where a terminal would within one; elsewhere it stays a line."""
    if not stream.isatty():
        return line
    return textwrap.fill(
        *(line, columns()),
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )


def speak_any_name() -> None:
    """Let names that stdout's encoding cannot hold be printed escaped instead of failing."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def hush_matplotlib() -> None:
    """Keep off the terminal what matplotlib logs of its font cache and folder; errors are raised.

    Not where it is imported, since what it logs in a program of others is theirs to choose.
    """
    import logging

    logging.getLogger("matplotlib").setLevel(logging.ERROR)


def require_writable(folder: Path) -> None:
    """Raise OutputError unless the folder, or the nearest above it that exists, can be written.

    Known before a photo is calibrated, which may take long.
    """
    existing = next(place for place in (folder, *folder.parents) if os.path.lexists(place))
    problem = None
    if not existing.is_dir():
        problem = f"{existing} is not a folder; choose another"
    elif not os.access(existing, os.W_OK | os.X_OK):
        problem = f"permission denied in {existing}; choose a folder you may write to"
    if problem:
        raise OutputError(f"{folder}: cannot be written: {problem}")
