"""Which picture of a TIFF is the photo, and whether camera raw hides behind the suffix."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from mmap import mmap

from facecrf_ocio.photo.containers.tiff_directory import (
    byte_order,
    entries,
    number_at,
    numbers,
)

# TIFF 6.0, TIFF/EP and DNG 1.7: tags of a directory.
_SUBFILE, _WIDTH, _LENGTH = 254, 256, 257
# And of what they hold and what lies below them.
_PHOTOMETRIC, _SUB_DIRECTORIES, _DNG_VERSION = 262, 330, 50706
# PhotometricInterpretation of mosaics and of demosaiced raw (DNG 1.4).
_FILTER_ARRAY, _LINEAR_RAW = 32803, 34892
_REDUCED, _MASK = 1, 4  # bits of NewSubfileType
_MOST = 64  # directories looked at: a file may lead in circles


@dataclass(frozen=True, slots=True)
class Page:
    """What tells whether a page is the photo: its pixels, and its NewSubfileType."""

    pixels: int
    subfile: int = 0

    @property
    def is_aside(self) -> bool:
        """Whether the page says that it is a thumbnail or a mask of another."""
        return bool(self.subfile & (_REDUCED | _MASK))


def photo_page(pages: list[Page]) -> int:
    """Index of the page that is the photo: the largest, the first of equals, no thumbnail."""
    candidates = [i for i, page in enumerate(pages) if not page.is_aside] or range(len(pages))
    return max(candidates, key=lambda index: (pages[index].pixels, -index))


def holds_raw(content: bytes) -> bool:
    """Whether a TIFF is camera raw: a DNG, or one with a sensor's pixels in any directory."""
    return any(
        _DNG_VERSION in tags or {_FILTER_ARRAY, _LINEAR_RAW} & set(tags.get(_PHOTOMETRIC, ()))
        for _, tags, _ in _directories(content)
    )


def with_photo_first(content: bytes | mmap) -> bytes | None:
    """The same TIFF with the photo as its first page; None where its pages hold the photo.

    TIFF/EP and some programs keep a thumbnail as the page and the photo in a directory below it
    (SubIFDs), where readers of pages do not come.
    """
    pages, below = [0], [(0, 0)]
    for at, tags, is_below in _directories(content):
        pixels = next(iter(tags.get(_WIDTH, ())), 0) * next(iter(tags.get(_LENGTH, ())), 0)
        if not is_below:
            pages.append(pixels)
        elif not Page(pixels, next(iter(tags.get(_SUBFILE, ())), 0)).is_aside:
            below.append((pixels, at))
    pixels, at = max(below, key=lambda one: (one[0], -one[1]))
    if pixels <= max(pages):
        return None
    return b"".join((content[:4], struct.pack(byte_order(content) + "I", at), content[8:]))


def _directories(content: bytes | mmap) -> Iterator[tuple[int, dict[int, tuple[int, ...]], bool]]:
    """Offset and tags of each directory, and whether it lies below a page."""
    order = byte_order(content)
    waiting, seen = [(number_at(order + "I", content, 4), False)] if order else [], set[int]()
    while waiting and len(seen) < _MOST:
        at, is_below = waiting.pop()
        if at in seen or at == 0:
            continue
        seen.add(at)
        tags, following = _directory(order, content, at)
        yield at, tags, is_below
        waiting += [*((sub, True) for sub in tags.get(_SUB_DIRECTORIES, ())), (following, is_below)]


def _directory(
    order: str, content: bytes | mmap, at: int
) -> tuple[dict[int, tuple[int, ...]], int]:
    """Whole numbers of the directory at an offset by their tags, and the offset of the next one."""
    tags = {
        tag: numbers(order, content, entry, _MOST)
        for tag, entry in entries(order, content, at).items()
        if entry.count <= _MOST
    }
    return tags, number_at(order + "I", content, at + 2 + 12 * number_at(order + "H", content, at))
