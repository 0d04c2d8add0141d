"""Whether two files hold the same: by a few bytes first, by all of them then."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

from facecrf_ocio.errors import OutputError

_BLOCK = 1 << 20  # [byte] read at once
_ENDS = 1 << 12  # [byte] of a file's beginning and end: one page of a disk each


def sha256_of(path: Path) -> str:
    """Hash of a file's bytes.

    Raises
    ------
    OutputError
        If it cannot be read.
    """
    digest = hashlib.sha256()
    try:
        with path.open("rb") as file:
            while block := file.read(_BLOCK):
                digest.update(block)
    except OSError as error:
        raise OutputError(f"{path}: cannot be read: {error.strerror}; check the disk") from error
    return digest.hexdigest()


def sha256_or_unreadable(path: Path) -> str:
    """Hash of a file's bytes; else `unreadable`, which none is: whoever works on it will tell."""
    try:
        return sha256_of(path)
    except OutputError:
        return "unreadable"


def fingerprint_of(path: Path) -> str:
    """Hash of a file's size, first and last bytes: files of one content have the same.

    Empty for an empty file and for one that cannot be read.
    """
    try:
        with path.open("rb") as file:
            head = file.read(_ENDS)
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - _ENDS))
            tail = file.read(_ENDS)
    except OSError:
        return ""
    return hashlib.sha256(b"%d " % size + head + tail).hexdigest() if size else ""
