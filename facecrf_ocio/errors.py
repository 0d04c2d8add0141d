"""The errors this package raises: each names what is wrong and what to do."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

# How texts name an argument of Python's: `stops=...`, `direction="encode"`, `overwrite=True`,
# `stops=[0, -1, 2]`.
_ARGUMENT = re.compile(r'\b([a-z][a-z_]*)=(?:\.\.\.|True|"([\w-]+)"|\[([-\d., ]+)\])')
_OPTIONS = {
    "ca": "tls-ca",
    "corners_xy": "corners",
    "space": "to",
    "megabytes": "memory",
    "seconds": "timeout",
}
"""Options of commands that are not called as the arguments are."""


class FaceCRFError(Exception):
    """Base of all errors raised on purpose by this package.

    Its text says what to do as Python has it; `on_command_line` names the options of commands.
    """

    def on_command_line(self) -> str:
        """The same text as commands tell it."""
        return in_options(str(self))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the text and what else it holds.

        Pickle's own way back passes the text alone to constructors, some of which take more, and
        ends the executor whose process an error comes from.
        """
        return _again, (type(self), self.args), vars(self)


def _again(kind: type[FaceCRFError], args: tuple[Any, ...]) -> FaceCRFError:
    return kind.__new__(kind, *args)


def in_options(text: str, command: str = "") -> str:
    """Say with options of commands what is advised with arguments of Python's.

    Only what follows the last semicolon is advice. `command` is the one that has the options, where
    it is told by another command or on a page.
    """
    problem, semicolon, advice = text.rpartition("; ")
    told = _ARGUMENT.sub(_option, advice)
    whose = f" (of `{command}`)" if command and told != advice else ""
    return problem + semicolon + told + whose


def _option(argument: re.Match[str]) -> str:
    name, value = argument[1], argument[2] or (argument[3] or "").replace(" ", "")
    option = f"--{_OPTIONS.get(name, name).replace('_', '-')}"
    return f"{option} {value}" if value else option


class PhotoError(FaceCRFError):
    """A photo cannot be read or used; its text names the file, what is wrong and what to do.

    Parameters
    ----------
    path
        The file, or None for an array in memory.
    problem
        What is wrong, without a final period.
    remedy
        What the user can do about it, without a final period.
    """

    def __init__(self, path: Path | None, problem: str, remedy: str) -> None:
        self.path = path
        self.problem = problem
        self.remedy = remedy
        name = "photo in memory" if path is None else str(path)
        super().__init__(f"{name}: {problem}; {remedy}")


class LutError(FaceCRFError):
    """A LUT cannot be written, read, or did not read back as it was written."""


class OutputError(FaceCRFError):
    """An output cannot be written: it exists, its folder is missing, or the disk refused it."""


class ExistsError(OutputError):
    """A file is there already, and nobody allowed to replace it.

    Parameters
    ----------
    target
        The file.
    problem
        What is wrong, without a final period.
    """

    def __init__(self, target: Path, problem: str = "exists already") -> None:
        self.target = target
        self.problem = problem
        super().__init__(f"{target}: {problem}; {OVERWRITE}")


IS_FOLDER = "is a folder"
"""The problem of a path that a photo was expected at."""
OVERWRITE = "pass overwrite=True to replace it"
"""What is advised where a file is in the way."""


class SettingsError(FaceCRFError):
    """A setting or an argument is outside of what it may be."""


class NotCalibratedError(FaceCRFError):
    """The curve of an estimate was asked for, but the photo could not be calibrated."""


class ClusterError(FaceCRFError):
    """A cluster cannot be reached, is not set up for the work, or was lost."""


def reason_of(error: OSError) -> str:
    """What the system says went wrong, as it stands in the middle of a line."""
    return (error.strerror or str(error)).lower()
