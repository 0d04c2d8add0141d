"""Gain maps in HEIF: the item `tmap`, written byte by byte, and the auxiliary image it is of."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from gain_map_files import iso_numbers
from heif_files import Picture, avif_picture, box, heic_picture, with_map_item

from facecrf_ocio import read_photo
from facecrf_ocio.image.hdr_rendition import hdr_rows
from facecrf_ocio.photo.decoding.gain_map import APPLE
from facecrf_ocio.photo.decoding.heif import _gain_map
from facecrf_ocio.photo.decoding.tone_map_item import tone_map_item
from facecrf_ocio.photo.tags.exif import load_exif

SAMSUNG = "urn:com:samsung:photo:2024:aux:hdrgainmap"
NUMBERS = iso_numbers([(0.0, 2.25, 1.0, 0.0, 0.0)])[4 + len(b"urn:iso:std:iso:ts:21496:-1\0") :]
VALUES = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)


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
    assert numbers(heif(version=version, wide=wide)) == NUMBERS
    if version:
        assert numbers(heif(version=version, wide=wide, in_idat=True)) == NUMBERS


def test_files_without_the_item_and_damaged_ones() -> None:
    whole = heif()
    assert tone_map_item(b"") is None
    assert tone_map_item(whole.replace(b"tmap", b"mime")) is None
    assert tone_map_item(b"\0\0\0\2" * 1_000_000) is None  # boxes shorter than their heads
    for end in range(len(whole)):
        assert NUMBERS.startswith(numbers(whole[:end]))
    for place in range(len(whole)):
        tone_map_item(whole[:place] + b"\xff" + whole[place + 1 :])


def numbers(content: bytes) -> bytes:
    told = tone_map_item(content)
    return told.numbers if told else b""


def decoded(*names: str):
    """What pillow-heif gives of a file with such auxiliary images."""
    pytest.importorskip("pillow_heif", reason="needs the extra heif")
    return SimpleNamespace(
        info={"aux": {name: [7] for name in names}}, get_aux_image=lambda _: VALUES, size=(8, 8)
    )


def test_the_map_that_the_item_is_of() -> None:
    found, notes = _gain_map(decoded("urn:other", SAMSUNG), load_exif(b""), heif())
    assert notes == ()
    assert found is not None
    assert found.standard == "ISO 21496-1"
    assert found.high == pytest.approx(2.25)
    assert np.array_equal(found.values, VALUES / np.float32(255))


def test_a_map_of_no_use_is_set_aside() -> None:
    newer = b"\0\1" + NUMBERS[2:]
    for told, why in ((newer, "readers of version 1"), (NUMBERS[:9], "")):
        found, notes = _gain_map(decoded(SAMSUNG), load_exif(b""), heif(told=told))
        assert found is None
        assert "its gain map was set aside" in notes[0]
        assert why in notes[0]
    assert _gain_map(decoded(SAMSUNG), load_exif(b""), b"") == (None, ())
    found, notes = _gain_map(decoded(APPLE), load_exif(b""), heif())
    assert found is None
    assert "how bright" in notes[0]


BASE = (np.indices((64, 96)).sum(axis=0)[..., None] * (1.0, 0.8, 0.6) + 60).clip(0, 255)
BASE = BASE.astype(np.uint8)
MAP = (np.indices((32, 48)).sum(axis=0)[..., None] * (3.0, 2.0, 1.0)).clip(0, 255).astype(np.uint8)
CHANNELS = [(-0.1, 2.0, 1.25, 1 / 64, 1 / 64), (0.0, 2.5, 1.0, 0.0, 0.0), (0.5, 1.0, 2.0, 0.1, 0.0)]


@pytest.mark.parametrize("picture", [avif_picture, heic_picture])
@pytest.mark.parametrize("turns", [0, 1, 2, 3])
def test_a_map_that_is_an_item_alone(
    tmp_path: Path, picture: Callable[[np.ndarray], Picture], turns: int
) -> None:
    """As libavif writes it: no auxiliary image, but an item from which `tmap` is derived."""
    path = tmp_path / "a.heif"
    path.write_bytes(with_map_item(picture(BASE), picture(MAP), CHANNELS, quarter_turns=turns))
    photo = read_photo(path)
    assert np.abs(photo.encoded * 255 - np.rot90(BASE, turns)).max() <= 2
    found = photo.gain_map
    assert found is not None
    assert np.abs(found.values * 255 - np.rot90(MAP, turns)).max() <= 2
    assert found.high == pytest.approx([2.0, 2.5, 1.0], abs=1e-4)
    assert (found.primaries, found.rendition.name) == (None, "Rec.2020")


def test_light_by_the_formula_of_the_standard(tmp_path: Path) -> None:
    """ISO 21496-1, 6: (light + base offset) 2^g - offset, in the space that `tmap` is tagged as."""
    path = tmp_path / "a.avif"
    large = np.repeat(np.repeat(MAP, 2, axis=0), 2, axis=1)
    content = with_map_item(avif_picture(BASE), avif_picture(large), CHANNELS, base_space=False)
    path.write_bytes(content)
    photo = read_photo(path)
    found = photo.gain_map
    assert found.primaries.name == "Rec.2020"
    code = photo.encoded.astype(float)
    light = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)
    to_2020 = np.array(  # ITU-R BT.2087, 2.4
        [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]
    )
    low, high, gamma, base_offset, offset = np.array(CHANNELS).T
    gain = low + (high - low) * found.values ** (1 / gamma)
    expected = (light @ to_2020.T + base_offset) * 2**gain - offset
    assert hdr_rows(photo, found, 0, 64) == pytest.approx(expected, rel=2e-3, abs=1e-3)


def test_a_coarser_map_lies_in_the_middle_of_what_it_stands_for(tmp_path: Path) -> None:
    path = tmp_path / "a.avif"
    path.write_bytes(with_map_item(avif_picture(BASE), avif_picture(MAP), CHANNELS))
    photo = read_photo(path)
    rows = np.concatenate([hdr_rows(photo, photo.gain_map, a, b) for a, b in ((0, 7), (7, 64))])
    fine = cv2.resize(photo.gain_map.values, (96, 64), interpolation=cv2.INTER_LINEAR)
    same = replace(photo.gain_map, values=fine)
    assert rows == pytest.approx(hdr_rows(photo, same, 0, 64), rel=1e-5, abs=1e-6)
    larger = np.repeat(np.repeat(MAP, 4, axis=0), 4, axis=1)
    path.write_bytes(with_map_item(avif_picture(BASE), avif_picture(larger), CHANNELS))
    assert read_photo(path).gain_map.values.shape == (64, 96, 3)


def test_what_libavif_refuses_for_its_map_alone_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.avif"
    zero = [(low, high, 0.0, 0.0, 0.0) for low, high, *_ in CHANNELS]
    path.write_bytes(with_map_item(avif_picture(BASE), avif_picture(MAP), zero))
    photo = read_photo(path)
    assert photo.gain_map is None
    assert "its gain map was set aside: its numbers make no sense" in photo.notes
    content = with_map_item(avif_picture(BASE), avif_picture(MAP), CHANNELS, least_version=1)
    path.write_bytes(content)
    assert "readers of version 1" in " ".join(read_photo(path).notes)
