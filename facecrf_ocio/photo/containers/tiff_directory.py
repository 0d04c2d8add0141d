"""Directories of TIFF 6.0 (sec. 2), of which EXIF and most makers' notes consist as well."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from mmap import mmap

# Kinds of values (TIFF 6.0, sec. 2; 13 by supplement 1) that are read, as `struct` has them: texts
# and undefined bytes as bytes.
_LETTERS = {1: "B", 2: "B", 3: "H", 4: "I", 6: "b", 7: "B", 8: "h", 9: "i", 13: "I"}
_SIZES = {"B": 1, "b": 1, "H": 2, "h": 2, "I": 4, "i": 4}  # [byte]
_INSIDE = 4  # [byte] of a value that stands in its entry, in the place of an offset
_ENTRY = 12  # [byte]


@dataclass(frozen=True, slots=True)
class TagEntry:
    """Where a tag's value stands, and of how many numbers of which kind it is said to be."""

    letter: str
    count: int
    place: int

    @property
    def size(self) -> int:
        """[byte] Of the value."""
        return self.count * _SIZES[self.letter]


def byte_order(content: bytes | mmap) -> str:
    """As `struct` has it; empty where the content is no TIFF with offsets of 32 bits."""
    is_tiff = content[2:4] in (b"*\0", b"\0*")
    return {b"II": "<", b"MM": ">"}.get(content[:2], "") if is_tiff else ""


def entries(order: str, content: bytes | mmap, at: int, base: int = 0) -> dict[int, TagEntry]:
    """Entries of the directory at an offset, by their tags, of values that lie within the content.

    Offsets in them count from `base`.
    """
    found = {}
    end = at + 2 + _ENTRY * number_at(order + "H", content, at)
    for entry in range(at + 2, min(end, len(content) - _ENTRY + 1), _ENTRY):
        tag, kind, count = struct.unpack_from(order + "HHI", content, entry)
        if kind not in _LETTERS:
            continue
        said = TagEntry(_LETTERS[kind], count, entry + _ENTRY - _INSIDE)
        if said.size > _INSIDE:
            said = TagEntry(said.letter, count, base + number_at(order + "I", content, said.place))
        if 0 <= said.place <= len(content) - said.size:
            found[tag] = said
    return found


def numbers(
    order: str, content: bytes | mmap, entry: TagEntry | None, most: int, letter: str = ""
) -> tuple[int, ...]:
    """The first numbers of a value, read as another kind where a letter is given; none of none."""
    if entry is None:
        return ()
    letter = letter or entry.letter
    count = min(entry.size // _SIZES[letter], most)
    return struct.unpack_from(f"{order}{count}{letter}", content, entry.place)


def number_in(order: str, content: bytes | mmap, found: Mapping[int, TagEntry], tag: int) -> int:
    """The first number of a tag; 0 without."""
    return next(iter(numbers(order, content, found.get(tag), 1)), 0)


def number_at(layout: str, content: bytes | mmap, at: int) -> int:
    """The number at an offset; 0 beyond the end."""
    size = struct.calcsize(layout)
    return int(struct.unpack_from(layout, content, at)[0]) if at + size <= len(content) else 0
