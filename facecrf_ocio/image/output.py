"""Images that OpenImageIO writes, whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from facecrf_ocio.errors import OutputError
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.photo.decoding.picture import open_image


def write_image_file(path: Path, write: Callable[[Path], str], *, overwrite: bool = False) -> Path:
    """Let `write` fill a temporary file in the target's folder, and name it when it is on the disk.

    Parameters
    ----------
    path
        The target.
    write
        Writes to the path it is given; returns OpenImageIO's complaint, or nothing.
    overwrite
        Replace an existing file.

    Raises
    ------
    OutputError
        If the target exists and `overwrite` is false, or it cannot be written.
    """

    def fill(temporary: Path) -> None:
        problem = _first_line(write(temporary))
        if problem:
            _require_space(temporary)
            raise OutputError(f"{path}: cannot be written ({problem}); choose another folder")

    def check(temporary: Path) -> None:
        problem = _why_it_does_not_open(temporary)
        if problem:
            raise OutputError(f"{path}: does not read back ({problem}); write it again")

    (written,) = write_files([Draft(path, fill, check)], overwrite=overwrite)
    return written


def _require_space(path: Path) -> None:
    """Let the system say what OpenImageIO's message does not, such as that the disk is full."""
    with path.open("ab") as file:
        file.write(bytes(1 << 20))
        os.fsync(file.fileno())


def _why_it_does_not_open(path: Path) -> str:
    written, why = open_image(path)
    if written is not None:
        written.close()
    return _first_line(why)


def _first_line(complaint: str) -> str:
    return complaint.strip().partition("\n")[0]
