"""Whether a photo can be looked at: what is in its way is told, and costs that photo alone."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from facecrf_ocio.errors import PhotoError, reason_of

_LEAVE_OUT = "allow reading it, or leave it out with exclude=..."


def status_of(path: Path) -> os.stat_result:
    """Size and time of a photo.

    Raises
    ------
    PhotoError
        If it is not there, may not be looked at, is a link that leads nowhere, or a folder: the
        walk gives those that it cannot read.
    """
    try:
        status = path.stat()
    except OSError as error:
        raise _told(path, error) from error
    if stat.S_ISDIR(status.st_mode):
        try:
            os.scandir(path).close()
        except OSError as error:
            problem = f"is a folder that cannot be read: {reason_of(error)}"
            raise PhotoError(path, problem, _LEAVE_OUT) from error
        raise PhotoError(path, "is a folder", "name the photos in it")
    return status


def _told(path: Path, error: OSError) -> PhotoError:
    if path.is_symlink():
        return PhotoError(
            path, "is a link that leads nowhere", "restore what it leads to, or remove it"
        )
    if isinstance(error, FileNotFoundError):
        return PhotoError(path, "is not there", "correct its name, or start again")
    return PhotoError(path, f"cannot be looked at: {reason_of(error)}", _LEAVE_OUT)
