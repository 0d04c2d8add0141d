"""Folders whose names survive a power cut."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from facecrf_ocio.errors import OutputError, reason_of


def make_folder(folder: Path) -> None:
    """Make a folder and those above it, each flushed into the one that holds it.

    Raises
    ------
    OutputError
        If it cannot be made.
    """
    missing = []
    place = folder
    while not place.is_dir() and place != place.parent:
        missing.append(place)
        place = place.parent
    for new in reversed(missing):
        try:
            new.mkdir(exist_ok=True)  # another worker may have been faster
            _flush(new.parent)
        except OSError as error:
            problem = reason_of(error)
            raise OutputError(
                f"{new}: the folder cannot be made: {problem}; choose another folder"
            ) from error


def _flush(folder: Path) -> None:
    with suppress(PermissionError):  # a folder that may be written to, but not listed
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def real_path(path: Path) -> Path:
    """Return where a path leads; of links that lead in a circle, as far as they can be followed.

    `Path.resolve` raises a RuntimeError of those before Python 3.13.
    """
    return Path(os.path.realpath(path))
