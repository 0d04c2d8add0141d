"""The chunks that a PNG consists of (PNG, third edition, sec. 5.3), and what they tell."""

from __future__ import annotations

import io
import os
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_LARGEST_PROFILE = 1 << 22  # [byte] inflated; those of printers, with their tables, take 3 MB


@dataclass(frozen=True, slots=True)
class Chunk:
    """One chunk; of one that the file ends within, what is there."""

    kind: bytes
    data: bytes
    checksum: int | None

    @property
    def is_whole(self) -> bool:
        """Whether the file goes on to its end."""
        return self.checksum is not None

    @property
    def is_damaged(self) -> bool:
        """Whether its bytes are not those that were written."""
        return self.is_whole and zlib.crc32(self.data, zlib.crc32(self.kind)) != self.checksum

    @property
    def is_critical(self) -> bool:
        """Whether pixels depend on it, by the capital first letter of its kind."""
        return self.kind[:1].isupper()


def chunks(file: BinaryIO) -> Iterator[Chunk]:
    """The chunks of a PNG in their order, up to IEND or to one that is not whole."""
    size = file.seek(0, os.SEEK_END)
    file.seek(len(_SIGNATURE))
    kind = b""
    while kind != b"IEND":
        header = file.read(8)
        length, kind = int.from_bytes(header[:4], "big"), header[4:]
        # A length that is a lie must not cost its memory.
        data = file.read(min(length, size))
        checksum = file.read(4)
        if len(header) < 8 or len(data) < length or len(checksum) < 4:
            yield Chunk(kind, data, None)
            return
        yield Chunk(kind, data, int.from_bytes(checksum, "big"))


def has_void_gamma(content: bytes) -> bool:
    """Whether a PNG's gAMA is zero, which says nothing (PNG, third edition, 11.3.2.2).

    OpenImageIO takes it for linear.
    """
    gamma = _before_pixels(content, b"gAMA")
    return gamma is not None and not any(gamma)


def is_animated(content: bytes) -> bool:
    """Whether a PNG has more frames than its picture, by acTL (11.3.4.1)."""
    frames = (_before_pixels(content, b"acTL") or b"")[:4]
    return int.from_bytes(frames, "big") > 1


def profile_told(content: bytes) -> bytes:
    """The profile of a PNG (11.3.2.3), which libpng keeps to itself where it does not fit.

    One that cannot be inflated is handed on as it is.
    """
    _, _, packed = (_before_pixels(content, b"iCCP") or b"").partition(b"\0")
    try:
        return zlib.decompressobj().decompress(packed[1:], _LARGEST_PROFILE)
    except zlib.error:
        return packed


def chromaticities_told(content: bytes) -> tuple[float, ...] | None:
    """CIE xy of red, green, blue and white by a PNG's cHRM (11.3.2.1); None where there is none.

    OpenImageIO does not pass them on.
    """
    told = _before_pixels(content, b"cHRM")
    is_srgb = _before_pixels(content, b"sRGB") is not None  # which goes before it (4.3)
    if is_srgb or told is None or len(told) != 32:
        return None
    white_x, white_y, *colors = (number / 100_000 for number in struct.unpack(">8I", told))
    return (*colors, white_x, white_y)


def _before_pixels(content: bytes, kind: bytes) -> bytes | None:
    """What the first chunk of a kind before the pixels of a PNG holds; None where there is none."""
    if content.startswith(_SIGNATURE):
        for chunk in chunks(io.BytesIO(content)):
            if chunk.kind in (kind, b"IDAT"):
                return chunk.data if chunk.kind == kind else None
    return None
