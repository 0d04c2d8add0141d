"""Refuse, before any decoder sees them, files that decoders take badly."""

from __future__ import annotations

import hashlib
import re
import stat
import struct
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

_CRITICAL = (b"IHDR", b"PLTE", b"IDAT", b"IEND")  # PNG, third edition, 11.2
_PATTERN = re.compile(r"[*?]|\[.+\]")  # of file names, as shells know them
_BLOCK = 1 << 20  # [byte] hashed at once
# BMP (Microsoft's BITMAPV4HEADER): size of the first header that may have masks, bits a pixel with
# the ways to pack them by masks (BI_BITFIELDS, BI_ALPHABITFIELDS), and masks of bytes as usual.
_WITH_MASKS, _BY_MASKS, _BGR = 40, {(32, 3), (32, 6)}, (0xFF0000, 0xFF00, 0xFF)
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
        raise PhotoError(path, *_missing(path)) from None
    except PermissionError:
        problem = "may not be read (permission denied)"
        raise PhotoError(path, problem, "give yourself permission to read it") from None
    except OSError as error:
        problem = f"cannot be read ({error.strerror})"
        raise PhotoError(path, problem, "check the name and the disk") from None


def _missing(path: Path) -> tuple[str, str]:
    """What is told of a path that leads to nothing, and what to do about it."""
    if path.is_symlink():
        return "is a link to a file that does not exist", "check what it leads to"
    if _PATTERN.search(path.name):  # which a shell hands on where no name fits
        return "matches no file", "check the folder and the suffix"
    return "does not exist", "check the name and the folder"


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
    """Check PNG for damage, GIF and JPEG 2000 for their size, and BMP for the bits of its channels.

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
    elif name == "BMP":
        _check_bmp(path, head)
    elif name == "JPEG 2000":
        start = max(head.find(_CODESTREAM), 0)
        check_size(path, *(int.from_bytes(head[start + at :][:4], "big") for at in (8, 12)))


def _check_bmp(path: Path, head: bytes) -> None:
    """Refuse 32 bits a pixel in another order than blue, green, red: OpenImageIO passes over it."""
    size, bits, packing = struct.unpack_from("<14xI10xHI", head.ljust(66, b"\0"))
    masks = struct.unpack_from("<54x3I", head.ljust(66, b"\0"))
    if size >= _WITH_MASKS and (bits, packing) in _BY_MASKS and masks != _BGR:
        problem = "is a BMP with its channels in an order of its own, which is not read here"
        raise PhotoError(path, problem, "save it as PNG")


def _check_png(path: Path, file: BinaryIO) -> None:
    for chunk in chunks(file):
        if not chunk.is_whole:
            raise PhotoError(path, "is cut short (the PNG ends early)", COPY_AGAIN)
        if chunk.is_critical and chunk.is_damaged:
            raise PhotoError(path, "is damaged (a PNG checksum does not match)", COPY_AGAIN)
        if chunk.is_critical and chunk.kind not in _CRITICAL:
            problem = "has a critical PNG chunk that is not known"
            raise PhotoError(path, problem, "save it as an ordinary PNG")
