"""TIFFs as few programs write them: the photo below a page, and bits in reverse order."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from odd_files import ASCII, LONG, SHORT, directory, kind, strip
from photo_files import HEIGHT, WIDTH, random_codes

from facecrf_ocio import read_photo
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.containers.tiff_pages import holds_raw, with_photo_first

CODES = random_codes()
REVERSED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))


def photo_below(order: str, size: tuple[int, int] = (4, 3), subfile: int = 0) -> bytes:
    """A gray page of some size, and below it (SubIFDs) the photo, of that NewSubfileType."""
    aside = (0x00FE, LONG, 1, struct.pack(order + "I", subfile))
    colors = [
        (0x0102, SHORT, 3, struct.pack(order + "3H", 8, 8, 8)),
        (0x0106, SHORT, 1, struct.pack(order + "H", 2)),
        (0x0115, SHORT, 1, struct.pack(order + "H", 3)),
    ]
    photo = strip(CODES.tobytes(), WIDTH, HEIGHT, aside, *colors, order=order)
    photo += bytes(-len(photo) % 2)
    entries = [
        (0x0100, LONG, size[0]),
        (0x0101, LONG, size[1]),
        (0x0102, SHORT, 8),
        (0x0103, SHORT, 1),
        (0x0106, SHORT, 1),
        (0x0111, LONG, 8),  # any bytes will do for its pixels
        (0x0112, SHORT, 6),
        (0x0115, SHORT, 1),
        (0x0116, LONG, size[1]),
        (0x0117, LONG, size[0] * size[1]),
        (0x014A, LONG, 8),
    ]
    page = struct.pack(order + "H", len(entries))
    for tag, form, value in entries:
        number = struct.pack(order + ("I" if form == LONG else "H"), value).ljust(4, b"\0")
        page += struct.pack(order + "HHI", tag, form, 1) + number
    return photo[:4] + struct.pack(order + "I", len(photo)) + photo[8:] + page + bytes(4)


class TestThePhotoBelowItsPage:
    @pytest.mark.parametrize("order", ["<", ">"])
    def test_is_read_and_turned_as_the_page_says(self, tmp_path: Path, order: str) -> None:
        (tmp_path / "a.tif").write_bytes(photo_below(order))
        photo = read_photo(tmp_path / "a.tif")
        assert np.array_equal(np.rint(255 * photo.encoded), np.rot90(CODES, -1))
        assert photo.notes == ("the photo was read that lies below its first page, a thumbnail",)

    def test_a_smaller_copy_below_is_passed_over(self) -> None:
        assert with_photo_first(photo_below("<", size=(WIDTH, HEIGHT))) is None

    def test_what_calls_itself_a_thumbnail_is_passed_over(self) -> None:
        assert with_photo_first(photo_below("<", subfile=1)) is None

    @pytest.mark.parametrize("content", [b"", b"II*\0", b"II*\0\xff\xff\xff\x7f", b"BM" + bytes(9)])
    def test_what_has_no_directory_has_no_photo_below(self, content: bytes) -> None:
        assert with_photo_first(content) is None
        assert not holds_raw(content)


def reversed_bits(codes: np.ndarray, rows: int) -> bytes:
    """A TIFF of deflated strips with FillOrder 2 (TIFF 6.0, sec. 8)."""
    height, width = codes.shape[:2]
    parts = [codes[top : top + rows].tobytes() for top in range(0, height, rows)]
    strips = [zlib.compress(part).translate(REVERSED) for part in parts]
    sizes = [len(one) for one in strips]

    def made(start: int) -> bytes:
        offsets = [start + sum(sizes[:number]) for number in range(len(sizes))]
        return directory(
            [
                (0x0100, LONG, 1, struct.pack("<I", width)),
                (0x0101, LONG, 1, struct.pack("<I", height)),
                (0x0103, SHORT, 1, struct.pack("<H", 8)),
                (0x010A, SHORT, 1, struct.pack("<H", 2)),
                (0x010F, ASCII, 5, b"Acme\0"),
                (0x0111, LONG, len(sizes), struct.pack(f"<{len(sizes)}I", *offsets)),
                (0x0116, LONG, 1, struct.pack("<I", rows)),
                (0x0117, LONG, len(sizes), struct.pack(f"<{len(sizes)}I", *sizes)),
                *kind(8 * codes.itemsize, 2, 3),
            ]
        )

    return made(len(made(0))) + b"".join(strips)


class TestReversedBits:
    @pytest.mark.parametrize("dtype", ["<u1", "<u2"])
    @pytest.mark.parametrize("rows", [1, 5, HEIGHT])
    def test_deflated_strips_are_whole(self, tmp_path: Path, dtype: str, rows: int) -> None:
        codes = random_codes(3, np.uint8 if dtype == "<u1" else np.uint16).astype(dtype)
        (tmp_path / "a.tif").write_bytes(reversed_bits(codes, rows))
        photo = read_photo(tmp_path / "a.tif")
        assert np.array_equal(np.rint(photo.encoded * np.iinfo(codes.dtype).max), codes)

    def test_damage_is_told(self, tmp_path: Path) -> None:
        (tmp_path / "a.tif").write_bytes(reversed_bits(CODES, HEIGHT)[:-99] + bytes(99))
        with pytest.raises(PhotoError, match="cut short or damaged"):
            read_photo(tmp_path / "a.tif")
