"""Refuse, before any decoder sees them, files that decoders take badly."""

from __future__ import annotations

import hashlib
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from facecrf_ocio.errors import IS_FOLDER, PhotoError
from facecrf_ocio.photo.containers.png_chunks import chunks
from facecrf_ocio.photo.containers.suffixes import HEAD, kind_of

MAX_MEGAPIXELS = 150
"""[megapixel] Larger photos are refused: decoded, this many take 1.8 GB."""

COPY_AGAIN = "copy it again from the camera or from a backup"

_BLOCK = 1 << 20  # [byte] hashed at once
_CODESTREAM = b"\xff\x4f\xff\x51"  # JPEG 2000: start of codestream, then its sizes


def check_file(path: Path) -> None:
    """Check that the path is a file with a photo's claims.

    Raises
    ------
    PhotoError
        If it is missing, a folder, empty, not readable, has a name that is no text, is a PNG cut
        short or damaged, or a GIF or JPEG 2000 larger than `MAX_MEGAPIXELS`.
    """
    _check_name(path)
    with _told(path):
        mode, size = path.stat().st_mode, path.stat().st_size
        if stat.S_ISDIR(mode):
            raise PhotoError(path, IS_FOLDER, "name a photo inside of it")
        if not stat.S_ISREG(mode):
            raise PhotoError(path, "is not a regular file", "name a photo")
        if size == 0:
            raise PhotoError(path, "is empty (zero bytes)", COPY_AGAIN)
        with path.open("rb") as file:
            _check_claims(path, file)


def photo_sha256(path: Path) -> str:
    """SHA-256 of a photo's bytes; raises PhotoError if they cannot be read."""
    digest = hashlib.sha256()
    with _told(path), path.open("rb") as file:
        while block := file.read(_BLOCK):
            digest.update(block)
    return digest.hexdigest()


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Turn the system's error into one that says what to do about the photo."""
    try:
        yield
    except (FileNotFoundError, NotADirectoryError):
        raise PhotoError(path, "does not exist", "check the name and the folder") from None
    except PermissionError:
        problem = "may not be read (permission denied)"
        raise PhotoError(path, problem, "give yourself permission to read it") from None
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        raise PhotoError(path, problem, "check the name and the disk") from None


def _check_name(path: Path) -> None:
    """Check for bytes that are no UTF-8, which the decoders' Python bindings cannot pass on."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        raise PhotoError(path, "has a name that is not UTF-8 text", "rename it") from None


def check_size(path: Path, width: int, height: int) -> None:
    """Raise PhotoError where a header claims more than `MAX_MEGAPIXELS`."""
    megapixels = width * height / 1e6
    if megapixels > MAX_MEGAPIXELS:
        raise PhotoError(
            path,
            f"claims {width} x {height} pixels, {megapixels:.0f} megapixels, and at most "
            f"{MAX_MEGAPIXELS} are read",
            "scale it down, or crop it around the face",
        )


def _check_claims(path: Path, file: BinaryIO) -> None:
    """Check PNG for damage and GIF and JPEG 2000 for their size.

    libpng writes lines of its own to stderr about damaged files, and OpenImageIO decodes GIF and
    JPEG 2000 when it opens them.
    """
    head = file.read(HEAD)
    kind = kind_of(head)
    name = "" if kind is None else kind.name
    if name == "PNG":
        _check_png(path, file)
    elif name == "GIF":
        check_size(path, *(int.from_bytes(head[at : at + 2], "little") for at in (6, 8)))
    elif name == "JPEG 2000":
        start = max(head.find(_CODESTREAM), 0)
        check_size(path, *(int.from_bytes(head[start + at :][:4], "big") for at in (8, 12)))


def _check_png(path: Path, file: BinaryIO) -> None:
    for chunk in chunks(file):
        if not chunk.is_whole:
            raise PhotoError(path, "is cut short (the PNG ends early)", COPY_AGAIN)
        if chunk.is_critical and chunk.is_damaged:
            raise PhotoError(path, "is damaged (a PNG checksum does not match)", COPY_AGAIN)
