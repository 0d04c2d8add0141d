"""A JPEG XL that moves is told by its header: ISO/IEC 18181-1, written bit by bit."""

from __future__ import annotations

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from photo_files import write

from facecrf_ocio.photo.containers.jxl_header import moves
from facecrf_ocio.photo.read import read_photo

# (value, bits): heights and widths by 8 and otherwise, and with a ratio in place of the width.
SMALL, SQUARE = [(1, 1), (30, 5), (0, 3), (7, 5)], [(1, 1), (30, 5), (1, 3)]
LARGE = [(0, 1), (1, 2), (4000, 13), (0, 3), (2, 2), (70_000, 18)]
PREVIEW, PREVIEW_BY_8 = [(0, 1), (3, 2), (900, 12), (2, 3)], [(1, 1), (2, 2), (9, 5), (4, 3)]
BOX = b"\0\0\0\x0cJXL \r\n\x87\n"


def codestream(size, *, orientation=0, intrinsic=None, preview=None, animated=False):
    fields = [(0x0AFF, 16), *size, (0, 1), (1, 1), (orientation, 3)]
    for more in (intrinsic, preview):
        fields += [(0, 1)] if more is None else [(1, 1), *more]
    fields += [(int(animated), 1), (2**20 - 1, 20)]
    total, at = 0, 0
    for value, bits in fields:
        total |= value << at
        at += bits
    return total.to_bytes(-(-at // 8), "little")


@pytest.mark.parametrize("size", [SMALL, SQUARE, LARGE])
@pytest.mark.parametrize("intrinsic", [None, SMALL, LARGE])
@pytest.mark.parametrize("preview", [None, PREVIEW, PREVIEW_BY_8])
@pytest.mark.parametrize("animated", [False, True])
def test_an_animation_is_told_behind_all_that_may_come_before(size, intrinsic, preview, animated):
    how = {"intrinsic": intrinsic, "preview": preview, "animated": animated, "orientation": 5}
    assert moves(codestream(size, **how)) is animated


def test_a_header_that_says_no_more_than_its_size_is_of_a_picture_that_does_not_move():
    for told in (1, 2):  # all as usual; nothing besides
        head = (0x0AFF | 0b1_001_11110_1 << 16 | told << 26).to_bytes(8, "little")
        assert not moves(head + b"\xff" * 40)


@pytest.mark.parametrize("kind", [b"jxlc", b"jxlp"])
def test_in_a_container_the_first_part_tells(kind):
    stream = codestream(LARGE, animated=True)
    body = (b"\0\0\0\0" if kind == b"jxlp" else b"") + stream
    exif = (20).to_bytes(4, "big") + b"Exif" + bytes(12)
    wide = (1).to_bytes(4, "big") + b"xml " + (24).to_bytes(8, "big") + bytes(8)
    for last in ((len(body) + 8).to_bytes(4, "big"), bytes(4)):  # 0: to the end of the file
        assert moves(BOX + exif + wide + last + kind + body)


@pytest.mark.parametrize(
    "content", [b"", b"\xff", b"\xff\x0a", BOX, BOX + bytes(40), b"\xff\xd8" * 99]
)
def test_what_is_cut_short_or_something_else_does_not_move(content):
    assert not moves(content)


def test_a_photo_does_not_move(tmp_path):
    codes = np.random.default_rng(1).integers(0, 256, (40, 56, 3)).astype(np.uint8)
    path = write(tmp_path / "a.jxl", codes, oiio.UINT8)
    assert not moves(path.read_bytes())
    assert read_photo(path).notes == ()
