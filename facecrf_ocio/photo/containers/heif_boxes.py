"""Boxes of HEIF (ISO 14496-12, 8.11; ISO 23008-12): its items, and what they are made of.

Views of the file are handed on, not copies. What a damaged file lacks is empty, or an IndexError.
"""

from __future__ import annotations

from collections.abc import Iterator

_IN_FILE, _IN_IDAT = 0, 1  # construction methods of `iloc` that are read
_MOST = 1 << 12  # [byte] of an item of some hundred
_NONE = memoryview(b"")


def meta_box(content: memoryview) -> memoryview:
    """What the box `meta` holds, behind its version and flags."""
    return child(content, b"meta")[4:]


def child(content: memoryview, kind: bytes) -> memoryview:
    """What the first box of a kind holds; empty where there is none."""
    return next((held for found, held in boxes(content) if found == kind), _NONE)


def boxes(content: memoryview) -> Iterator[tuple[bytes, memoryview]]:
    """Kind and content of each box."""
    at = 0
    while at + 8 <= len(content):
        size, head = int.from_bytes(content[at : at + 4], "big"), 8
        if size == 1:
            size, head = int.from_bytes(content[at + 8 : at + 16], "big"), 16
        end = len(content) if size == 0 else at + size
        if end < at + head:
            return
        yield bytes(content[at + 4 : at + 8]), content[at + head : end]
        at = end


class _Numbers:
    """Reads numbers one after the other."""

    def __init__(self, content: memoryview, at: int) -> None:
        self._content, self._at = content, at

    def take(self, size: int) -> int:
        """The next number, of so many bytes; IndexError where there are no more."""
        begin, self._at = self._at, self._at + size
        if self._at > len(self._content):
            raise IndexError
        return int.from_bytes(self._content[begin : self._at], "big")


def items(meta: memoryview, kind: bytes) -> Iterator[int]:
    """Numbers of the items of a kind, by `iinf`."""
    infos = child(meta, b"iinf")
    for found, held in boxes(infos[8 if infos[0] else 6 :]):
        wide = bytes(held[:1]) == b"\3"  # `infe` of version 3 has items of 32 bits, of 2 of 16
        name = 10 if wide else 8
        if found == b"infe" and bytes(held[name : name + 4]) == kind:
            yield int.from_bytes(held[4 : name - 2], "big")


def item_content(content: memoryview, meta: memoryview, item: int) -> memoryview:
    """Bytes of an item's one extent, by `iloc`; empty where it is long, or kept elsewhere."""
    place = child(meta, b"iloc")
    version, sizes = place[0], int.from_bytes(place[4:6], "big")
    offset_size, length_size, base_size = sizes >> 12, sizes >> 8 & 15, sizes >> 4 & 15
    index_size = sizes & 15 if version else 0
    wide = 4 if version == 2 else 2
    numbers = _Numbers(place, 6)
    for _ in range(numbers.take(wide)):
        number = numbers.take(wide)
        method = numbers.take(2) & 15 if version else _IN_FILE
        numbers.take(2)  # which file, of several
        base, count = numbers.take(base_size), numbers.take(2)
        for _ in range(count):
            numbers.take(index_size)
            start, length = base + numbers.take(offset_size), numbers.take(length_size)
            if number == item:
                inside = content if method == _IN_FILE else child(meta, b"idat")
                known = method in (_IN_FILE, _IN_IDAT) and length <= _MOST
                return inside[start : start + length] if known else _NONE
    return _NONE


def made_of(meta: memoryview, item: int) -> list[int]:
    """Items from which another is derived, by `dimg` of `iref`, in their order."""
    told = child(meta, b"iref")
    wide = 4 if bytes(told[:1]) == b"\1" else 2
    for kind, held in boxes(told[4:]):
        numbers = _Numbers(held, 0)
        if kind == b"dimg" and numbers.take(wide) == item:
            return [numbers.take(wide) for _ in range(numbers.take(2))]
    return []


def properties(meta: memoryview, item: int) -> Iterator[tuple[bytes, memoryview]]:
    """Kind and content of each property of an item, by `ipma` and `ipco` of `iprp`."""
    told = child(meta, b"iprp")
    known, links = list(boxes(child(told, b"ipco"))), child(told, b"ipma")
    wide, size = 4 if bytes(links[:1]) != b"\0" else 2, 2 if links[3] & 1 else 1
    numbers = _Numbers(links, 4)
    for _ in range(numbers.take(4)):
        number = numbers.take(wide)
        for _ in range(numbers.take(1)):
            place = numbers.take(size) & (1 << 8 * size - 1) - 1  # the first bit: essential
            if number == item and 0 < place <= len(known):
                yield known[place - 1]


def with_primary(content: bytes, item: int) -> bytes:
    """The file with another item for its picture, so that decoders give that one."""
    changed = bytearray(content)
    meta = meta_box(memoryview(changed))
    primary = child(meta, b"pitm")[4:]
    primary[:] = item.to_bytes(len(primary), "big")
    infos = child(meta, b"iinf")
    for kind, held in boxes(infos[8 if infos[0] else 6 :]):
        wide = held[0] == 3
        if kind == b"infe" and int.from_bytes(held[4 : 8 if wide else 6], "big") == item:
            held[3] &= 0xFE  # no longer hidden
    return bytes(changed)


def without_brand(content: bytes, brand: bytes) -> bytes:
    """The file without one of the brands with which it claims to be compatible."""
    changed = bytearray(content)
    brands = child(memoryview(changed), b"ftyp")[8:]
    for at in range(0, len(brands) - 3, 4):
        if brands[at : at + 4] == brand:
            brands[at : at + 4] = b"mif1"  # that of every image file
    return bytes(changed)
