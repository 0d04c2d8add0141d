"""HEIF with a gain map as an item of its own, put together of pictures that encoders wrote."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from gain_map_files import iso_numbers
from PIL import Image, features

_NCLX = b"nclx" + struct.pack(">HHHB", 9, 16, 9, 0x80)  # Rec. 2020, PQ
_ESSENTIAL = (b"av1C", b"hvcC", b"irot")
_BRANDS = {b"avif": b"avifmif1miaftmap", b"heic": b"heicmif1tmap"}


def box(kind: bytes, held: bytes) -> bytes:
    return struct.pack(">I", 8 + len(held)) + kind + held


def boxes(content: bytes) -> list[tuple[bytes, bytes]]:
    found, at = [], 0
    while at < len(content):
        size = int.from_bytes(content[at : at + 4], "big")
        found.append((content[at + 4 : at + 8], content[at + 8 : at + size]))
        at += size
    return found


@dataclass
class Picture:
    """The first item of a file: its coded bytes, its kind, its properties."""

    data: bytes
    kind: bytes
    properties: list[tuple[bytes, bytes]]


def avif_picture(codes: np.ndarray) -> Picture:
    if not features.check("avif"):
        pytest.skip("this Pillow writes no AVIF")
    out = BytesIO()
    Image.fromarray(codes).save(out, "AVIF", quality=100, subsampling="4:4:4", speed=9)
    return _first(out.getvalue())


def heic_picture(codes: np.ndarray) -> Picture:
    pillow_heif = pytest.importorskip("pillow_heif")
    out = BytesIO()
    heif = pillow_heif.from_bytes("RGB", codes.shape[1::-1], codes.tobytes())
    try:
        heif.save(out, quality=-1, chroma=444, matrix_coefficients=0)
    except RuntimeError as error:
        pytest.skip(f"no HEVC encoder: {error}")
    return _first(out.getvalue())


def _first(content: bytes) -> Picture:
    meta = dict(boxes(dict(boxes(content))[b"meta"][4:]))
    _, item = boxes(meta[b"iinf"][6:])[0]
    parts = dict(boxes(meta[b"iprp"]))
    known, links = boxes(parts[b"ipco"]), parts[b"ipma"]
    count = links[10]
    own = [known[(link & 0x7F) - 1] for link in links[11 : 11 + count]]
    mdat = content.find(b"mdat")
    data = content[mdat + 4 :]
    return Picture(data, item[8:12], [(k, h) for k, h in own if k not in (b"irot", b"imir")])


def with_map_item(
    base: Picture,
    values: Picture,
    channels: list[tuple[float, ...]],
    *,
    base_space: bool = True,
    quarter_turns: int = 0,
    least_version: int = 0,
    color: bytes = _NCLX,
) -> bytes:
    """A file of a photo, its map, and the item `tmap` that is made of both (ISO 23008-12, 6.6)."""
    said = iso_numbers(channels, base_space=base_space)[4 + len(b"urn:iso:std:iso:ts:21496:-1\0") :]
    tone_map = b"\0" + struct.pack(">H", least_version) + said[2:]
    turned = [(b"irot", bytes((quarter_turns,)))] if quarter_turns else []
    owned = [
        base.properties + turned,
        [*((k, h) for k, h in base.properties if k in (b"ispe", b"pixi")), (b"colr", color)],
        values.properties + turned,
    ]
    infos = b"".join(
        box(b"infe", bytes((2, 0, 0, hidden)) + struct.pack(">HH", n, 0) + kind + b"\0")
        for n, kind, hidden in ((1, base.kind, 0), (2, b"tmap", 0), (3, values.kind, 1))
    )
    known: list[Any] = []
    links = b""
    for number, properties in enumerate(owned, 1):
        links += struct.pack(">HB", number, len(properties))
        for one in properties:
            known.append(one)
            links += bytes((len(known) | 0x80 * (one[0] in _ESSENTIAL),))
    ipco = box(b"ipco", b"".join(box(*one) for one in known))
    ipma = box(b"ipma", bytes(4) + struct.pack(">I", 3) + links)
    parts = [base.data, tone_map, values.data]

    def meta(start: int) -> bytes:
        places = b""
        for number, part in enumerate(parts, 1):
            places += struct.pack(">HHHII", number, 0, 1, start, len(part))
            start += len(part)
        held = [
            box(b"hdlr", bytes(8) + b"pict" + bytes(13)),
            box(b"pitm", bytes(4) + b"\0\1"),
            box(b"iloc", bytes(4) + b"\x44\x00" + struct.pack(">H", 3) + places),
            box(b"iinf", bytes(4) + struct.pack(">H", 3) + infos),
            box(b"iref", bytes(4) + box(b"dimg", struct.pack(">HHHH", 2, 2, 1, 3))),
            box(b"iprp", ipco + ipma),
            box(b"grpl", box(b"altr", bytes(4) + struct.pack(">IIII", 9, 2, 2, 1))),
        ]
        return box(b"meta", bytes(4) + b"".join(held))

    major = b"avif" if base.kind == b"av01" else b"heic"
    head = box(b"ftyp", major + bytes(4) + _BRANDS[major])
    return head + meta(len(head) + len(meta(0)) + 8) + box(b"mdat", b"".join(parts))
