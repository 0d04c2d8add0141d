"""Reading the arrays of an .npz file at once, of which NumPy's reader takes each by itself."""

from __future__ import annotations

from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import Any
from zipfile import ZIP_STORED, BadZipFile, ZipFile, ZipInfo
from zlib import crc32

import numpy as np
import numpy.typing as npt

_LOCAL_HEADER = 30  # [byte] before name and extra field, whose lengths stand at 26 and 28
_PREFIX = 10  # [byte] of .npy, version 1: magic, version and the header's length, which is at 8


def load_arrays(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Return the arrays of an .npz file by name; none can be written to.

    Raises
    ------
    OSError, ValueError, zipfile.BadZipFile
        If the file cannot be read, or is damaged.
    """
    whole = path.read_bytes()
    with ZipFile(BytesIO(whole)) as archive:
        return {
            member.filename.removesuffix(".npy"): _array(_content(archive, whole, member))
            for member in archive.infolist()
        }


def _content(archive: ZipFile, whole: bytes, member: ZipInfo) -> memoryview:
    if member.compress_type != ZIP_STORED:
        return memoryview(archive.read(member))
    local = member.header_offset
    lengths = (int.from_bytes(whole[local + at : local + at + 2], "little") for at in (26, 28))
    start = local + _LOCAL_HEADER + sum(lengths)
    content = memoryview(whole)[start : start + member.file_size]
    if crc32(content) != member.CRC:
        raise BadZipFile(f"{member.filename} is damaged")
    return content


def _array(content: memoryview) -> npt.NDArray[Any]:
    start = _PREFIX + int.from_bytes(content[8:_PREFIX], "little")
    shape, fortran, dtype = _header(bytes(content[:start]))
    return np.frombuffer(content[start:], dtype).reshape(shape, order="F" if fortran else "C")


@lru_cache(maxsize=256)
def _header(head: bytes) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Shape, whether columns come first, and type; many arrays of a file have the same."""
    stream = BytesIO(head)
    version = np.lib.format.read_magic(stream)
    if version != (1, 0):
        raise ValueError(f"arrays of version {version} of NumPy's format are not read")
    return np.lib.format.read_array_header_1_0(stream)
