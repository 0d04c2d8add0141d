"""How a command speaks and ends: one line per complaint, and its exit code."""

from __future__ import annotations

import io
import json
import os
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

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

if TYPE_CHECKING:
    from facecrf_ocio.values import Estimate

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


def tell_estimate(whose: str, estimate: Estimate) -> None:
    """Print on one line what to expect of a curve."""
    from facecrf_ocio.wording.sentence import COMMAND_LINE, sentence

    told = estimate.confidence
    outcome = str(estimate.outcome) if told is None else f"{estimate.outcome} ({told.verdict})"
    say(f"{whose}: {outcome}: {sentence(estimate, COMMAND_LINE)}")


def tell_details(estimate: Estimate) -> None:
    """Print what a curve rests on, a line each."""
    from facecrf_ocio.wording.sentence import details

    for line in details(estimate):
        say(f"  {line}")


def tell_notes(notes: Iterable[str], *, err: bool = False) -> None:
    """Print what was mended, chosen or cut on the way, a line each."""
    for note in notes:
        say(f"  note: {note}", err=err)


def tell(
    path: Path,
    estimate: Estimate,
    written: tuple[Path, ...],
    *,
    notes: tuple[str, ...] = (),
    as_json: bool = False,
    verbose: bool = False,
    told_before: bool = False,
) -> int:
    """Print what came of a photo: results on stdout, the lack of one on stderr.

    Of an estimate that was told before, as of photos that share one, only the files are told.
    """
    from facecrf_ocio.wording.expectation import expectation
    from facecrf_ocio.wording.sentence import COMMAND_LINE, sentence

    expected = expectation(estimate)
    told = estimate.confidence
    verdict = None if told is None else str(told.verdict)
    code = DONE
    if estimate.found is None:
        message = f"{path}: {estimate.outcome}: {sentence(estimate, COMMAND_LINE)}"
        code = complain(message, NOTHING)
        tell_notes(() if as_json else notes, err=True)
    elif not as_json:
        if told_before:
            say(str(path))
        else:
            tell_estimate(str(path), estimate)
        tell_notes(notes)
        if verbose and not told_before:
            tell_details(estimate)
        for file in written:
            click.echo(one_line(f"  {file}"))
    if as_json:
        tell_json(
            path,
            code,
            outcome=str(estimate.outcome),
            estimator=estimate.estimator,
            reason=estimate.reason,
            remedy=estimate.remedy,
            summary=sentence(estimate),
            expected=None if expected is None else expected.record(),
            verdict=verdict,
            differs_from_srgb=None if told is None else told.differs_from_srgb,
            energy=dict(estimate.energy),
            faces=len(estimate.faces),
            notes=list(notes),
            files=[str(file) for file in written],
        )
    return code


def tell_json(path: Path, code: int, **record: object) -> None:
    """Print one JSON object on a line of its own, in ASCII, which any stdout can hold."""
    click.echo(json.dumps({"photo": str(path), "exit_code": code, **record}))
