"""What is wrong with a manifest, in one line with the remedy that fits."""

from __future__ import annotations

import errno
import sqlite3
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from facecrf_ocio.errors import OutputError, reason_of
from facecrf_ocio.files.plain_text import plain_text

_FULL = "free some space, or choose another folder"
_LOCKED = "close the program that has it open, and start again"
_DAMAGED = "restore it from a copy; or move it away and start the batch again with overwrite=True"
_ANY = "close what has it open, check the disk, or choose another folder"
_BY_NAME = {
    "SQLITE_FULL": _FULL,
    "SQLITE_IOERR": "check the disk, and start again",
    "SQLITE_CANTOPEN": "allow writing it, or choose another folder",
    "SQLITE_READONLY": "allow writing it, or choose another folder",
    "SQLITE_PERM": "allow writing it, or choose another folder",
    "SQLITE_BUSY": _LOCKED,
    "SQLITE_LOCKED": _LOCKED,
}
# By code; -1 stands for what this Python has no name for, and is no code.
_REMEDIES = {getattr(sqlite3, name, -1): remedy for name, remedy in _BY_NAME.items()}


@contextmanager
def telling(path: Path) -> Iterator[None]:
    """Turn what SQLite complains of into OutputError, which names file and remedy."""
    try:
        yield
    except sqlite3.Error as error:
        # Python 3.10 does not tell the code.
        code = getattr(error, "sqlite_errorcode", None)
        remedy = _ANY if code is None else _REMEDIES.get(code & 0xFF, _DAMAGED)
        refused = _refusal(path.parent) if "unable to open" in str(error) else None
        if refused is not None and refused.errno in (errno.ENOSPC, errno.EDQUOT):
            remedy = _FULL
        told = error if refused is None else reason_of(refused)
        problem = f"{path}: the manifest cannot be used: {told}; {remedy}"
        raise OutputError(problem) from error


def _refusal(folder: Path) -> OSError | None:
    """Why a folder takes no further file, which SQLite does not tell; None if it takes one."""
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        return error
    return None


@contextmanager
def understanding(path: Path) -> Iterator[None]:
    """Turn what a damaged row makes of us into OutputError, which names file and remedy."""
    try:
        yield
    except (
        ArithmeticError,
        AttributeError,
        LookupError,
        RecursionError,
        TypeError,
        ValueError,
    ) as e:
        told = plain_text(e, limit=200)
        problem = f"{path}: the manifest holds what no facecrf wrote ({told}); {_DAMAGED}"
        raise OutputError(problem) from e
