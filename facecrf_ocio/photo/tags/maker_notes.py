"""Where the directory of a maker's notes lies in a file, and its numbers by their tags.

How notes begin, and from where their offsets count, is published in ExifTool's table
`MakerNotes.pm` (exiftool.org, version 13.58). Damaged notes have fewer tags, or none.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.photo.containers.jpeg_segments import JpegParts
from facecrf_ocio.photo.containers.tiff_directory import (
    TagEntry,
    byte_order,
    entries,
    number_at,
    number_in,
    numbers,
)

_MAKE, _MODEL, _EXIF_DIRECTORY, _NOTES = 271, 272, 0x8769, 0x927C  # tags (EXIF 2.32, sec. 4.6)
_IN_JPEG = b"Exif\0\0"
# How EXIF begins in a box of JPEG XL (behind an offset of 32 bits) and in chunks of PNG and of WebP
# (behind its length); some programs put JPEG's own mark before it.
_MARK = re.compile(rb"(Exif|eXIf|EXIF)(|..|....)\Z", re.DOTALL)
_LONGEST = 8  # [byte] of a mark and what is between it and EXIF
_HEADS = (b"II*\0", b"MM\0*")  # with which EXIF begins, as a TIFF does
_MOST_HEADS = 64  # looked at: pixels have one of them by chance in 4 GB
_MOST_ENTRIES = 512  # of a directory; a larger number is one in the other order of bytes
_MOST_TEXT = 64  # [characters] of a make or a model
_KINDS = range(1, 14)  # of TIFF's values
_FOOTER = (
    8  # [byte] behind Canon's notes: a TIFF's head, with the offset at which they were written
)


@dataclass(frozen=True, slots=True)
class _Layout:
    """How one kind of notes begins.

    Attributes
    ----------
    maker
        Whose tags they have.
    signature, make
        What the notes begin with, and what the file's Make does, in lower case.
    start
        [byte] From the notes' begin to their directory.
    base
        [byte] From the notes' begin to where offsets count from; None: EXIF's.
    """

    maker: str
    signature: bytes
    make: str
    start: int
    base: int | None


# By what they begin with, those of no signature last.
_LAYOUTS = (
    _Layout("Nikon", b"Nikon\0\2", "", 18, 10),
    _Layout("Olympus", b"OLYMPUS\0", "", 12, 0),
    _Layout("Olympus", b"OM SYSTEM\0", "", 16, 0),
    _Layout("Olympus", b"OLYMP\0", "", 8, None),
    _Layout("Panasonic", b"Panasonic\0", "", 12, None),
    _Layout("Pentax", b"AOC\0", "", 6, None),
    _Layout("Pentax", b"PENTAX \0", "", 10, 0),
    _Layout("Pentax", b"RICOH\0II", "", 8, 0),
    _Layout("Pentax", b"RICOH\0MM", "", 8, 0),
    _Layout("Ricoh", b"Ricoh\0", "", 8, None),
    _Layout("Fujifilm", b"FUJIFILM", "", 12, 0),
    _Layout("Sony", b"SONY DSC", "", 12, None),
    _Layout("Sony", b"SONY CAM", "", 12, None),
    _Layout("Sony", b"SONY MOBILE", "", 12, None),
    _Layout("Sony", b"\0\0SONY PIC\0", "", 12, None),
    _Layout("Canon", b"", "canon", 0, None),
    _Layout("Sony", b"", "sony", 0, None),
    _Layout("Samsung", b"", "samsung", 0, None),
)


@dataclass(frozen=True, slots=True)
class MakerNotes:
    """The directory of a maker's notes.

    Attributes
    ----------
    maker
        Whose tags they are, as `_LAYOUTS` calls it; empty where there are no notes.
    model
        As EXIF names it.
    order, content, base
        Order of bytes; the bytes in which values lie, and where offsets count from there.
    found
        Its entries by their tags.
    """

    maker: str
    model: str
    order: str
    content: bytes
    base: int
    found: dict[int, TagEntry]

    def numbers(self, tag: int, most: int, letter: str = "") -> tuple[int, ...]:
        """The first numbers of a tag, read as the kind of a letter where one is given."""
        return numbers(self.order, self.content, self.found.get(tag), most, letter)

    def size(self, tag: int) -> int:
        """[byte] Of a tag's value; 0 without."""
        return self.found[tag].size if tag in self.found else 0

    def below(self, tag: int) -> MakerNotes:
        """The directory to which a tag leads, or that is its value; without entries if none."""
        entry = self.found.get(tag)
        if entry is None:
            return MakerNotes(self.maker, self.model, self.order, self.content, self.base, {})
        at = entry.place
        if entry.letter == "I":
            at = self.base + next(iter(self.numbers(tag, 1)), len(self.content))
        found = entries(self.order, self.content, at, self.base)
        return MakerNotes(self.maker, self.model, self.order, self.content, self.base, found)


NO_NOTES = MakerNotes("", "", "<", b"", 0, {})
"""Of a file that has none, or none that is known."""


def exif_of(content: bytes, jpeg: JpegParts | None) -> bytes:
    """The EXIF of a file's bytes, a TIFF by itself; empty where there is none.

    In JPEG it is a segment (EXIF 2.32, sec. 4.7.2), a TIFF is one itself, and elsewhere it stands
    uncompressed behind a mark. HEIF and AVIF, in whose items it has none, are left to decoders.
    """
    if jpeg is not None:
        return next(iter(jpeg.contents(0xE1, _IN_JPEG)), b"")
    if byte_order(content):
        return content
    for head in _HEADS:
        at = -1
        for _ in range(_MOST_HEADS):
            at = content.find(head, at + 1)
            if at < 0:
                break
            if _MARK.search(content[max(at - _LONGEST, 0) : at]):
                return content[at:]
    return b""


def maker_notes(exif: bytes) -> MakerNotes:
    """Find the directory of the maker's notes in EXIF; `NO_NOTES` where there is none."""
    order = byte_order(exif)
    if not order:
        return NO_NOTES
    first = entries(order, exif, number_at(order + "I", exif, 4))
    below = entries(order, exif, number_in(order, exif, first, _EXIF_DIRECTORY))
    notes = below.get(_NOTES)
    if notes is None or notes.letter != "B":
        return NO_NOTES
    make, model = (_text(exif, first.get(tag)) for tag in (_MAKE, _MODEL))
    begin = exif[notes.place : notes.place + min(notes.size, _MOST_TEXT)]
    for layout in _LAYOUTS:
        if begin.startswith(layout.signature) and make.casefold().startswith(layout.make):
            base = _moved(exif, notes) if layout.base is None else notes.place + layout.base
            at = notes.place + layout.start
            told = _order_at(exif, at, order)
            return MakerNotes(layout.maker, model, told, exif, base, entries(told, exif, at, base))
    return NO_NOTES


def _moved(exif: bytes, notes: TagEntry) -> int:
    """[byte] By how much notes were moved by programs that left the offsets in them; 0 if untold.

    Canon's end with where they began.
    """
    end = exif[notes.place : notes.place + notes.size][-_FOOTER:]
    order = byte_order(end)
    return notes.place - number_at(order + "I", end, 4) if order else 0


def _text(content: bytes, entry: TagEntry | None) -> str:
    return plain_text(bytes(numbers("<", content, entry, _MOST_TEXT, "B")).partition(b"\0")[0])


def _order_at(content: bytes, at: int, order: str) -> str:
    """The order of bytes in which a directory makes sense; the given one where both or none do.

    Programs that write EXIF anew turn its order, and leave that of notes as it is.
    """
    for tried in (order, "<>".replace(order, "")):
        count, kind = (number_at(tried + "H", content, at + more) for more in (0, 4))
        if 0 < count <= _MOST_ENTRIES and kind in _KINDS:
            return tried
    return order
