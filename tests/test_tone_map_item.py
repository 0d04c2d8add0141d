"""Gain maps in HEIF: the item `tmap`, written byte by byte, and the auxiliary image it is of."""

from __future__ import annotations

import struct
from types import SimpleNamespace

import numpy as np
import pytest
from gain_map_files import iso_numbers

from facecrf_ocio.photo.exif import load_exif
from facecrf_ocio.photo.gain_map import APPLE
from facecrf_ocio.photo.heif import _gain_map
from facecrf_ocio.photo.tone_map_item import tone_map_item

SAMSUNG = "urn:com:samsung:photo:2024:aux:hdrgainmap"
NUMBERS = iso_numbers([(0.0, 2.25, 1.0, 0.0, 0.0)])[4 + len(b"urn:iso:std:iso:ts:21496:-1\0") :]
VALUES = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)


def box(kind: bytes, held: bytes) -> bytes:
    return struct.pack(">I", 8 + len(held)) + kind + held


def heif(*, version: int = 1, in_idat: bool = False, wide: bool = False, told=NUMBERS) -> bytes:
    """A file of two items, the second of which is `tmap`; its extent lies in `mdat` or `idat`."""
    number = ">I" if wide else ">H"
    infos = [
        box(
            b"infe",
            bytes((3 if wide else 2, 0, 0, 0)) + struct.pack(number, n) + b"\0\0" + kind + b"\0",
        )
        for n, kind in ((1, b"hvc1"), (2, b"tmap"))
    ]
    iinf = box(b"iinf", bytes(4) + struct.pack(">H", 2) + b"".join(infos))
    item = b"\0" + told

    def meta(place: int) -> bytes:
        entries = b""
        for n, start, length in ((1, 0, 4), (2, place, len(item))):
            entries += struct.pack(">I" if version == 2 else ">H", n)
            entries += struct.pack(">H", in_idat and n == 2) if version else b""
            entries += struct.pack(">HHII", 0, 1, start, length)
        count = struct.pack(">I" if version == 2 else ">H", 2)
        iloc = box(b"iloc", bytes((version, 0, 0, 0)) + b"\x44\x00" + count + entries)
        idat = box(b"idat", b"....." + item) if in_idat else b""
        return box(b"meta", bytes(4) + iinf + iloc + idat)

    start = box(b"ftyp", b"heic\0\0\0\0tmap")
    place = 5 if in_idat else len(start) + len(meta(0)) + 8
    return start + meta(place) + box(b"mdat", item)


@pytest.mark.parametrize("version", [0, 1, 2])
@pytest.mark.parametrize("wide", [False, True])
def test_the_items_bytes_are_found(version: int, wide: bool) -> None:
    assert tone_map_item(heif(version=version, wide=wide)) == NUMBERS
    if version:
        assert tone_map_item(heif(version=version, wide=wide, in_idat=True)) == NUMBERS


def test_files_without_the_item_and_damaged_ones() -> None:
    whole = heif()
    assert tone_map_item(b"") == b""
    assert tone_map_item(whole.replace(b"tmap", b"mime")) == b""
    assert tone_map_item(b"\0\0\0\2" * 1_000_000) == b""  # boxes shorter than their heads
    for end in range(len(whole)):
        assert NUMBERS.startswith(tone_map_item(whole[:end]))
    for place in range(len(whole)):
        tone_map_item(whole[:place] + b"\xff" + whole[place + 1 :])


def decoded(*names: str):
    """What pillow-heif gives of a file with such auxiliary images."""
    return SimpleNamespace(
        info={"aux": {name: [7] for name in names}}, get_aux_image=lambda _: VALUES
    )


def test_the_map_that_the_item_is_of() -> None:
    found, notes = _gain_map(decoded("urn:other", SAMSUNG), load_exif(b""), heif())
    assert notes == ()
    assert found is not None
    assert found.standard == "ISO 21496-1"
    assert found.high == pytest.approx(2.25)
    assert np.array_equal(found.values, VALUES / np.float32(255))


def test_a_map_of_no_use_is_set_aside() -> None:
    elsewhere = bytes((*NUMBERS[:4], 0)) + NUMBERS[5:]
    for told, why in ((elsewhere, "another color space"), (NUMBERS[:9], "")):
        found, notes = _gain_map(decoded(SAMSUNG), load_exif(b""), heif(told=told))
        assert found is None
        assert "its gain map was set aside" in notes[0]
        assert why in notes[0]
    assert _gain_map(decoded(SAMSUNG), load_exif(b""), b"") == (None, ())
    found, notes = _gain_map(decoded(APPLE), load_exif(b""), heif())
    assert found is None
    assert "how bright" in notes[0]
