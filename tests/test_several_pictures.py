"""Files that hold more than one picture: which is read, and that it is told."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from heif_files import box
from PIL import Image, features

from facecrf_ocio import read_photo
from facecrf_ocio.errors import PhotoError

LIGHT = np.random.default_rng(0).random((12, 16, 3), np.float32)
CODES = (255 * LIGHT).astype(np.uint8)


def write_parts(path: Path, *parts: tuple[str, str]) -> Path:
    """An EXR of parts with a name and channels; those of `RGB` are LIGHT, darker in each part."""
    specs, pixels = [], []
    for number, (name, channels) in enumerate(parts, 1):
        spec = oiio.ImageSpec(16, 12, len(channels), oiio.FLOAT)
        spec.channelnames = tuple(channels)
        spec.attribute("oiio:subimagename", name)
        specs.append(spec)
        pixels.append(np.ascontiguousarray(LIGHT[..., : len(channels)] / number))
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), specs), out.geterror()
    for number, spec in enumerate(specs):
        if number:
            assert out.open(str(path), spec, "AppendSubimage"), out.geterror()
        assert out.write_image(pixels[number]), out.geterror()
    out.close()
    return path


class TestExr:
    def test_two_views(self, tmp_path: Path) -> None:
        photo = read_photo(write_parts(tmp_path / "a.exr", ("left", "RGB"), ("right", "RGB")))
        assert np.array_equal(photo.encoded, LIGHT)
        (note,) = photo.notes
        assert note == "part 1 of 2 (left) was read, the first with R, G and B"

    @pytest.mark.parametrize("first", ["Z", "XYZ"])
    def test_colors_behind_another_part(self, tmp_path: Path, first: str) -> None:
        photo = read_photo(write_parts(tmp_path / "a.exr", ("aside", first), ("beauty", "RGB")))
        assert np.array_equal(photo.encoded, LIGHT / np.float32(2))
        assert photo.notes == ("part 2 of 2 (beauty) was read, the first with R, G and B",)

    def test_colors_before_another_part(self, tmp_path: Path) -> None:
        photo = read_photo(write_parts(tmp_path / "a.exr", ("beauty", "RGB"), ("depth", "Z")))
        assert (np.array_equal(photo.encoded, LIGHT), photo.notes) == (True, ())

    def test_no_part_has_colors(self, tmp_path: Path) -> None:
        path = write_parts(tmp_path / "a.exr", ("depth", "Z"), ("places", "XYZ"))
        with pytest.raises(PhotoError, match="channels Z, but no R, G and B"):
            read_photo(path)


@pytest.mark.parametrize("count", [1, 2])
def test_gif(tmp_path: Path, count: int) -> None:
    first, *more = [Image.fromarray(CODES[..., 0] // number) for number in range(1, count + 1)]
    first.save(tmp_path / "a.gif", save_all=True, append_images=more)
    photo = read_photo(tmp_path / "a.gif")
    assert np.allclose(255 * photo.encoded[..., 0], CODES[..., 0])
    assert photo.notes == ("the first of several pictures was read",) * (count - 1)


@pytest.mark.parametrize("count", [1, 2])
def test_avif(tmp_path: Path, count: int) -> None:
    if not features.check("avif"):
        pytest.skip("this Pillow reads no AVIF")
    first, *more = [Image.fromarray(CODES // number) for number in range(1, count + 1)]
    first.save(tmp_path / "a.avif", save_all=True, append_images=more)
    photo = read_photo(tmp_path / "a.avif")
    assert photo.notes == ("the first of several pictures was read",) * (count - 1)


@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("suffix", [".webp", ".png"])
def test_webp_and_png(tmp_path: Path, suffix: str, count: int) -> None:
    first, *more = [Image.fromarray(CODES // number) for number in range(1, count + 1)]
    path = tmp_path / f"a{suffix}"
    first.save(path, save_all=True, append_images=more, lossless=True)
    photo = read_photo(path)
    assert np.array_equal(np.rint(255 * photo.encoded), CODES)
    assert photo.notes == ("the first of several pictures was read",) * (count - 1)


def test_a_webp_that_may_move_and_has_one_frame(tmp_path: Path) -> None:
    first, second = Image.fromarray(CODES), Image.fromarray(255 - CODES)
    first.save(tmp_path / "a.webp", save_all=True, append_images=[second], lossless=True)
    moving = (tmp_path / "a.webp").read_bytes()
    frame = moving[8 : moving.rindex(b"ANMF")]
    (tmp_path / "a.webp").write_bytes(b"RIFF" + struct.pack("<I", len(frame)) + frame)
    photo = read_photo(tmp_path / "a.webp")
    assert np.array_equal(np.rint(255 * photo.encoded), CODES)
    assert photo.notes == ()


def sequence(of: bytes) -> bytes:
    """A HEIC's bytes with a box of a sequence of images, which has none."""
    return of + box(b"moov", box(b"mvhd", bytes(100)))


def test_a_heic_that_moves(tmp_path: Path) -> None:
    pillow_heif = pytest.importorskip("pillow_heif")
    path = tmp_path / "a.heic"
    still = pillow_heif.from_bytes("RGB", (64, 64), bytes(3 * 64 * 64))
    still.save(str(path))
    path.write_bytes(sequence(path.read_bytes()))
    assert read_photo(path).notes == ("it moves: its still picture was read",)


def test_a_heic_that_moves_and_has_no_still_picture(tmp_path: Path) -> None:
    pytest.importorskip("pillow_heif")
    (tmp_path / "a.heic").write_bytes(sequence(box(b"ftyp", b"hevc\0\0\0\0msf1")))
    with pytest.raises(PhotoError, match=r"moves, without a still.* one of its frames as PNG"):
        read_photo(tmp_path / "a.heic")


@pytest.mark.parametrize("first", [0, 1])
def test_a_burst_in_a_heic(tmp_path: Path, first: int) -> None:
    pillow_heif = pytest.importorskip("pillow_heif")
    burst = pillow_heif.HeifFile()
    for gray in (40, 200):
        burst.add_from_pillow(Image.fromarray(np.full((64, 64, 3), gray, np.uint8)))
    burst.save(str(tmp_path / "a.heic"), primary_index=first)
    photo = read_photo(tmp_path / "a.heic")
    assert photo.encoded.mean() * 255 == pytest.approx((40, 200)[first], abs=3)
    assert "of 2 pictures" in photo.notes[0]
