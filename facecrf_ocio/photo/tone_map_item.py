"""The derived item `tmap` of HEIF: what ISO 21496-1 says of a gain map that is an image of its own.

Boxes are those of ISO 14496-12 (8.11: `meta`, `iinf`, `iloc`, `idat`).
"""

from __future__ import annotations

from collections.abc import Iterator

_TONE_MAP = b"tmap"
_IN_FILE, _IN_IDAT = 0, 1  # construction methods of `iloc` that are read
_MOST = 1 << 12  # [byte] of an item of some hundred
_NONE = memoryview(b"")


def tone_map_item(content: bytes) -> bytes:
    """Metadata of the first `tmap`, from its versions on; empty where there is none."""
    try:
        whole = memoryview(content)  # of which boxes are parts, not copies
        meta = _child(whole, b"meta")[4:]  # a version and flags come first
        item = next(_items(_child(meta, b"iinf")), None)
        if item is None:
            return b""
        found = bytes(_content(whole, meta, item))
    except IndexError:
        return b""
    return found[1:] if found[:1] == b"\0" else b""  # version 0 of the item is the one there is


def _child(content: memoryview, kind: bytes) -> memoryview:
    """What the first box of a kind holds; empty where there is none."""
    return next((held for found, held in _boxes(content) if found == kind), _NONE)


def _boxes(content: memoryview) -> Iterator[tuple[bytes, memoryview]]:
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


def _items(infos: memoryview) -> Iterator[int]:
    """Numbers of the items `tmap` in `iinf`."""
    for kind, held in _boxes(infos[8 if infos[0] else 6 :]):
        wide = bytes(held[:1]) == b"\3"  # `infe` of version 3 has items of 32 bits, of 2 of 16
        name = 10 if wide else 8
        if kind == b"infe" and bytes(held[name : name + 4]) == _TONE_MAP:
            yield int.from_bytes(held[4 : name - 2], "big")


def _content(content: memoryview, meta: memoryview, item: int) -> memoryview:
    """Bytes of an item's one extent, by `iloc`."""
    place = _child(meta, b"iloc")
    version, sizes = place[0], int.from_bytes(place[4:6], "big")
    offset_size, length_size, base_size = sizes >> 12, sizes >> 8 & 15, sizes >> 4 & 15
    index_size = sizes & 15 if version else 0
    wide = 4 if version == 2 else 2
    at = 6

    def taken(size: int) -> int:
        nonlocal at
        if at + size > len(place):
            raise IndexError
        at += size
        return int.from_bytes(place[at - size : at], "big")

    for _ in range(taken(wide)):
        number = taken(wide)
        method = taken(2) & 15 if version else _IN_FILE
        taken(2)  # which file, of several
        base, count = taken(base_size), taken(2)
        for _ in range(count):
            taken(index_size)
            start, length = base + taken(offset_size), taken(length_size)
            if number == item:
                inside = content if method == _IN_FILE else _child(meta, b"idat")
                known = method in (_IN_FILE, _IN_IDAT) and length <= _MOST
                return inside[start : start + length] if known else _NONE
    return _NONE
