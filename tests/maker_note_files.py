"""EXIF with a maker's notes, written here: headers, directories and offsets as makers have them."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from typing import TypeAlias

SHORT, LONG, BYTES, SIGNED_SHORT, SIGNED_LONG = 3, 4, 7, 8, 9  # kinds of values (TIFF 6.0)
_LETTERS = {2: "B", SHORT: "H", LONG: "I", BYTES: "B", SIGNED_SHORT: "h", SIGNED_LONG: "i"}

Tags: TypeAlias = Mapping[int, tuple[int, tuple[int, ...]]]
"""Kind and numbers of each tag."""


def directory(order: str, tags: Tags, at: int) -> bytes:
    """A directory at an offset, with its values behind it."""
    table, values = struct.pack(order + "H", len(tags)), b""
    behind = at + 2 + 12 * len(tags) + 4
    for tag, (kind, said) in sorted(tags.items()):
        value = struct.pack(f"{order}{len(said)}{_LETTERS[kind]}", *said)
        table += struct.pack(order + "HHI", tag, kind, len(said))
        if len(value) > 4:
            table += struct.pack(order + "I", behind + len(values))
            values += value + bytes(len(value) % 2)
        else:
            table += value.ljust(4, b"\0")
    return table + bytes(4) + values


def behind(header: bytes, base: int | None, order: str = "<") -> Callable[[Tags, int], bytes]:
    """Notes with a directory behind a header; offsets count from `base`, or from EXIF's start."""

    def notes(tags: Tags, at: int) -> bytes:
        start = len(header) - base if base is not None else at + len(header)
        return header + directory(order, tags, start)

    return notes


def olympus_settings(header: bytes, base: int | None) -> Callable[[Tags, int], bytes]:
    """Notes whose tags lie in a directory of their own, to which the first one leads."""

    def notes(tags: Tags, at: int) -> bytes:
        start = len(header) - base if base is not None else at + len(header)
        below = start + 2 + 12 + 4
        first = directory("<", {0x2020: (LONG, (below,))}, start)
        return header + first + directory("<", tags, below)

    return notes


NOTES: Mapping[str, Callable[[Tags, int], bytes]] = {
    "NIKON CORPORATION": behind(b"Nikon\0\x02\x10\0\0II*\0\x08\0\0\0", 10),
    "Canon": behind(b"", None),
    "SONY": behind(b"SONY DSC \0\0\0", None),
    "OLYMPUS IMAGING CORP.": olympus_settings(b"OLYMPUS\0II\x03\0", 0),
    "OLYMPUS OPTICAL CO.,LTD": olympus_settings(b"OLYMP\0\x02\0", None),
    "OM Digital Solutions": olympus_settings(b"OM SYSTEM\0\0\0II\x04\0", 0),
    "Panasonic": behind(b"Panasonic\0\0\0", None),
    "PENTAX": behind(b"AOC\0MM", None, ">"),
    "RICOH IMAGING COMPANY, LTD.": behind(b"PENTAX \0II", 0),
    "RICOH": behind(b"Ricoh\0\0\0", None),
    "FUJIFILM": behind(b"FUJIFILM\x0c\0\0\0", 0),
    "SAMSUNG": behind(b"", None),
}
"""How the notes of each Make are written."""


def footed(order: str = "<") -> Callable[[Tags, int], bytes]:
    """Canon's notes, which end with where they were written: here 1,000 bytes behind."""

    def notes(tags: Tags, at: int) -> bytes:
        foot = struct.pack(order + "I", at + 1000)
        return directory(order, tags, at + 1000) + {"<": b"II*\0", ">": b"MM\0*"}[order] + foot

    return notes


def exif_with(
    make: str,
    tags: Tags,
    model: str = "One",
    order: str = "<",
    written: Callable[[Tags, int], bytes] | None = None,
) -> bytes:
    """EXIF of a camera, in an order of bytes that need not be that of the maker's notes."""
    write = written or NOTES[make]
    texts = {tag: (2, (*text.encode(), 0)) for tag, text in ((271, make), (272, model))}
    start = 8 + len(directory(order, {**texts, 0x8769: (LONG, (0,))}, 8))
    place = start + 2 + 12 + 4
    size = len(write(tags, place))
    first = directory(order, {**texts, 0x8769: (LONG, (start,))}, 8)
    entry = struct.pack(order + "HHHII", 1, 0x927C, BYTES, size, place) + bytes(4)
    head = (b"II*\0" if order == "<" else b"MM\0*") + struct.pack(order + "I", 8)
    return head + first + entry + write(tags, place)
