"""What `read_photo` makes of a file, against Pillow and against what was written."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from hypothesis import given
from hypothesis import strategies as st
from photo_files import HEIGHT, WIDTH, matrix_profile, random_codes, write
from PIL import Image, ImageOps

from facecrf_ocio.color.primaries import KNOWN_PRIMARIES
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.raster.pixels import code_values
from facecrf_ocio.photo.read import read_photo

ORIENTATION = 0x0112


class TestCodeValues:
    """Integer files: code values divided by their maximum, exactly as they stand in the file."""

    @pytest.mark.parametrize("name", ["a.png", "a.tif", "a.bmp", "a.webp"])
    def test_eight_bits(self, tmp_path: Path, name: str) -> None:
        codes = random_codes()
        Image.fromarray(codes).save(tmp_path / name, lossless=True)
        photo = read_photo(tmp_path / name)
        assert photo.encoded.dtype == np.float32
        assert np.array_equal(photo.encoded, (codes / 255).astype(np.float32))
        assert (photo.bit_depth, photo.scene_linear, photo.grayscale) == (8, False, False)
        assert photo.alpha is None

    @pytest.mark.parametrize("progressive", [False, True])
    def test_a_jpeg_read_in_several_bands_is_that_read_at_once(
        self, tmp_path: Path, progressive: bool
    ) -> None:
        codes = np.tile(random_codes(), (9, 2, 1))[:150]  # rows: neither of bands nor of blocks
        Image.fromarray(codes).save(tmp_path / "a.jpg", quality=85, progressive=progressive)
        expected = np.asarray(Image.open(tmp_path / "a.jpg"))
        assert np.array_equal(read_photo(tmp_path / "a.jpg").pixels, expected)

    def test_jpeg_is_decoded_as_pillow_does(self, tmp_path: Path) -> None:
        Image.fromarray(random_codes()).save(tmp_path / "a.jpg", quality=90)
        expected = np.asarray(Image.open(tmp_path / "a.jpg"))
        assert np.array_equal(np.rint(read_photo(tmp_path / "a.jpg").encoded * 255), expected)

    @pytest.mark.parametrize("name", ["a.png", "a.tif"])
    def test_sixteen_bits(self, tmp_path: Path, name: str) -> None:
        codes = random_codes(dtype=np.uint16)
        photo = read_photo(write(tmp_path / name, codes, oiio.UINT16))
        assert np.array_equal(photo.encoded, (codes / 65535).astype(np.float32))
        assert photo.bit_depth == 16

    @pytest.mark.parametrize("bits", [10, 12])
    def test_ten_and_twelve_bits_are_those_of_the_file(self, tmp_path: Path, bits: int) -> None:
        codes = random_codes(dtype=np.uint16) >> (16 - bits)
        full_range = np.rint(codes * (65535 / (2**bits - 1))).astype(np.uint16)
        path = write(tmp_path / "a.tif", full_range, oiio.UINT16, oiio__BitsPerSample=bits)
        photo = read_photo(path)
        assert photo.bit_depth == bits
        assert np.array_equal(photo.encoded, (codes / (2**bits - 1)).astype(np.float32))

    @given(bits=st.integers(9, 15), data=st.data())
    def test_both_ways_to_scale_a_code_up_are_undone(self, bits: int, data: st.DataObject) -> None:
        code = data.draw(st.integers(0, 2**bits - 1))
        rounded = round(code * 65535 / (2**bits - 1))
        replicated = (code << (16 - bits)) | (code >> (2 * bits - 16))
        values = code_values(np.array([rounded, replicated], np.uint16), bits)
        assert np.array_equal(values, np.full(2, code / (2**bits - 1), np.float32))

    def test_palettes_give_the_bits_of_their_colors(self, tmp_path: Path) -> None:
        image = Image.fromarray(random_codes()).quantize(8)
        image.save(tmp_path / "a.png", bits=4)
        photo = read_photo(tmp_path / "a.png")
        assert photo.bit_depth == 8
        assert np.array_equal(np.rint(photo.encoded * 255), np.asarray(image.convert("RGB")))

    def test_nothing_can_be_written_to(self, tmp_path: Path) -> None:
        Image.fromarray(random_codes(4)).save(tmp_path / "a.png")
        photo = read_photo(tmp_path / "a.png")
        assert not photo.encoded.flags.writeable
        assert photo.alpha is not None
        assert not photo.alpha.flags.writeable

    def test_path_and_digest(self, tmp_path: Path) -> None:
        Image.fromarray(random_codes()).save(tmp_path / "a.png")
        photo = read_photo(str(tmp_path / "a.png"))
        assert photo.path == tmp_path / "a.png"
        assert photo.sha256 == hashlib.sha256((tmp_path / "a.png").read_bytes()).hexdigest()

    def test_the_suffix_may_lie(self, tmp_path: Path) -> None:
        Image.fromarray(random_codes()).save(tmp_path / "a.png")
        (tmp_path / "a.png").rename(tmp_path / "b?c=1.jpg")
        assert read_photo(tmp_path / "b?c=1.jpg").encoded.shape == (HEIGHT, WIDTH, 3)

    def test_one_pixel_is_a_photo(self, tmp_path: Path) -> None:
        Image.new("RGB", (1, 1), (255, 0, 51)).save(tmp_path / "a.png")
        assert np.allclose(read_photo(tmp_path / "a.png").encoded, [[[1, 0, 0.2]]])


class TestOrientation:
    @pytest.mark.parametrize("orientation", range(1, 9))
    @pytest.mark.parametrize("mode", ["RGB", "L"])
    def test_upright_as_pillow_has_it(self, tmp_path: Path, orientation: int, mode: str) -> None:
        exif = Image.Exif()
        exif[ORIENTATION] = orientation
        Image.fromarray(random_codes()).convert(mode).save(tmp_path / "a.jpg", exif=exif)
        upright = ImageOps.exif_transpose(Image.open(tmp_path / "a.jpg")).convert("RGB")
        assert np.array_equal(np.rint(read_photo(tmp_path / "a.jpg").encoded * 255), upright)

    def test_alpha_turns_with_the_colors(self, tmp_path: Path) -> None:
        codes = random_codes(4)
        photo = read_photo(
            write(tmp_path / "a.tif", codes, oiio.UINT8, Orientation=6, oiio__UnassociatedAlpha=1)
        )
        assert photo.alpha is not None
        assert np.array_equal(np.rint(photo.encoded * 255), np.rot90(codes[..., :3], -1))
        assert np.array_equal(np.rint(photo.alpha * 255), np.rot90(codes[..., 3], -1))

    def test_a_number_that_means_nothing_changes_nothing(self, tmp_path: Path) -> None:
        exif = Image.Exif()
        exif[ORIENTATION] = 9
        Image.fromarray(random_codes()).save(tmp_path / "a.jpg", exif=exif)
        assert read_photo(tmp_path / "a.jpg").encoded.shape == (HEIGHT, WIDTH, 3)


class TestAlpha:
    @pytest.mark.parametrize("name", ["a.png", "a.tif", "a.tga"])
    def test_kept_aside_and_colors_untouched(self, tmp_path: Path, name: str) -> None:
        codes = random_codes(4)
        Image.fromarray(codes).save(tmp_path / name)
        photo = read_photo(tmp_path / name)
        assert photo.alpha is not None
        assert np.array_equal(np.rint(photo.encoded * 255), codes[..., :3])
        assert np.array_equal(np.rint(photo.alpha * 255), codes[..., 3])

    @pytest.mark.parametrize(("name", "linear"), [("a.tif", False), ("a.exr", True)])
    def test_colors_stored_multiplied_by_alpha_are_divided(
        self, tmp_path: Path, name: str, linear: bool
    ) -> None:
        alpha = np.full((HEIGHT, WIDTH), 0.5, np.float32)
        alpha[0] = 0
        color = np.full((HEIGHT, WIDTH, 3), 0.75, np.float32)
        stored = np.dstack([color * alpha[..., None], alpha])
        kind = oiio.FLOAT if linear else oiio.UINT16
        photo = read_photo(write(tmp_path / name, stored, kind))
        assert photo.alpha is not None
        assert np.allclose(photo.alpha, alpha, atol=1e-5)
        assert np.allclose(photo.encoded[1:], 0.75, atol=4e-5)
        assert (photo.encoded[0] == 0).all()


class TestChannels:
    @pytest.mark.parametrize("name", ["a.jpg", "a.png", "a.tif"])
    def test_gray_is_repeated(self, tmp_path: Path, name: str) -> None:
        Image.fromarray(random_codes(1)[..., 0]).save(tmp_path / name)
        photo = read_photo(tmp_path / name)
        assert photo.grayscale
        assert np.array_equal(photo.encoded, np.repeat(photo.encoded[..., :1], 3, axis=2))
        assert np.array_equal(
            np.rint(photo.encoded[..., 0] * 255), np.asarray(Image.open(tmp_path / name))
        )

    def test_gray_with_alpha(self, tmp_path: Path) -> None:
        codes = random_codes(2)
        Image.fromarray(codes, "LA").save(tmp_path / "a.png")
        photo = read_photo(tmp_path / "a.png")
        assert photo.grayscale
        assert photo.alpha is not None
        assert np.array_equal(np.rint(photo.encoded[..., 2] * 255), codes[..., 0])
        assert np.array_equal(np.rint(photo.alpha * 255), codes[..., 1])

    def test_three_equal_channels_are_gray(self, tmp_path: Path) -> None:
        gray = np.repeat(random_codes(1), 3, axis=2)
        Image.fromarray(gray).save(tmp_path / "gray.png")
        gray[5, 7, 1] ^= 1
        Image.fromarray(gray).save(tmp_path / "color.png")
        assert read_photo(tmp_path / "gray.png").grayscale
        assert not read_photo(tmp_path / "color.png").grayscale

    def test_colors_are_found_by_name(self, tmp_path: Path) -> None:
        pixels = np.random.default_rng(1).random((HEIGHT, WIDTH, 5), np.float32)
        names = ("diffuse.B", "diffuse.G", "diffuse.R", "Z", "N.X")
        path = write(tmp_path / "a.exr", pixels, oiio.FLOAT, names)
        assert np.array_equal(read_photo(path).encoded, pixels[..., [2, 1, 0]])

    def test_the_layer_without_a_prefix_comes_first(self, tmp_path: Path) -> None:
        pixels = np.random.default_rng(1).random((HEIGHT, WIDTH, 6), np.float32)
        names = ("a.R", "a.G", "a.B", "R", "G", "B")
        path = write(tmp_path / "a.exr", pixels, oiio.FLOAT, names)
        assert np.array_equal(read_photo(path).encoded, pixels[..., 3:])

    def test_no_colors_at_all(self, tmp_path: Path) -> None:
        pixels = np.zeros((HEIGHT, WIDTH, 3), np.float32)
        path = write(tmp_path / "a.exr", pixels, oiio.FLOAT, ("N.X", "N.Y", "N.Z"))
        with pytest.raises(PhotoError, match=r"N\.X, N\.Y, N\.Z, but no R, G and B"):
            read_photo(path)

    @pytest.mark.parametrize("name", ["a.jpg", "a.tif"])
    def test_cmyk_is_refused(self, tmp_path: Path, name: str) -> None:
        Image.fromarray(random_codes()).convert("CMYK").save(tmp_path / name)
        with pytest.raises(PhotoError, match=r"is CMYK.*use the RGB original"):
            read_photo(tmp_path / name)

    def test_lab_is_refused(self, tmp_path: Path) -> None:
        Image.fromarray(random_codes()).convert("LAB").save(tmp_path / "a.tif")
        with pytest.raises(PhotoError, match="is CIELab"):
            read_photo(tmp_path / "a.tif")

    @pytest.mark.parametrize("largest", [0, 1, 2])
    def test_the_largest_page_of_several(self, tmp_path: Path, largest: int) -> None:
        pages = [Image.new("RGB", (3, 2), "red") for _ in range(3)]
        pages[largest] = Image.new("RGB", (5, 4), "blue")
        pages[0].save(tmp_path / "a.tif", save_all=True, append_images=pages[1:])
        photo = read_photo(tmp_path / "a.tif")
        assert np.array_equal(photo.encoded, np.tile([0, 0, 1], (4, 5, 1)))
        assert f"page {largest + 1} of 3" in photo.notes[0]

    def test_the_first_page_of_equals(self, tmp_path: Path) -> None:
        first, second = Image.new("RGB", (3, 2), "red"), Image.new("RGB", (3, 2), "blue")
        first.save(tmp_path / "a.tif", save_all=True, append_images=[second])
        assert np.array_equal(read_photo(tmp_path / "a.tif").encoded, np.tile([1, 0, 0], (2, 3, 1)))


class TestSceneLinear:
    @pytest.mark.parametrize(
        ("name", "kind"), [("a.exr", oiio.HALF), ("a.exr", oiio.FLOAT), ("a.tif", oiio.FLOAT)]
    )
    def test_floating_point(self, tmp_path: Path, name: str, kind: Any) -> None:
        pixels = np.random.default_rng(1).integers(0, 2000, (HEIGHT, WIDTH, 3)) / np.float32(256)
        photo = read_photo(write(tmp_path / name, pixels.astype(np.float32), kind))
        assert photo.scene_linear
        assert photo.bit_depth is None
        assert np.array_equal(photo.encoded, pixels)

    def test_radiance_hdr(self, tmp_path: Path) -> None:
        pixels = np.full((HEIGHT, WIDTH, 3), 4.0, np.float32)
        photo = read_photo(write(tmp_path / "a.hdr", pixels, oiio.FLOAT))
        assert photo.scene_linear
        assert np.allclose(photo.encoded, 4, rtol=1 / 128)

    def test_floats_that_say_they_are_encoded(self, tmp_path: Path) -> None:
        pixels = np.full((HEIGHT, WIDTH, 3), 0.5, np.float32)
        path = write(tmp_path / "a.exr", pixels, oiio.FLOAT, oiio__ColorSpace="srgb_rec709_scene")
        assert not read_photo(path).scene_linear

    def test_integers_whose_profile_is_linear(self, tmp_path: Path) -> None:
        icc = matrix_profile(*KNOWN_PRIMARIES["Rec.709"], gamma=1.0)
        Image.fromarray(random_codes()).save(tmp_path / "a.tif", icc_profile=icc)
        assert read_photo(tmp_path / "a.tif").scene_linear

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    def test_not_a_number_is_refused(self, tmp_path: Path, bad: float) -> None:
        pixels = np.ones((HEIGHT, WIDTH, 3), np.float32)
        pixels[3, 4, 1] = bad
        with pytest.raises(PhotoError, match="NaN or infinite"):
            read_photo(write(tmp_path / "a.exr", pixels, oiio.FLOAT))


def test_names_of_channels_that_are_no_text_are_told_as_text(tmp_path):
    pixels = np.zeros((4, 4, 3), np.float32)
    image = oiio.ImageBuf(oiio.ImageSpec(4, 4, 3, oiio.FLOAT))
    image.set_pixels(oiio.ROI(), pixels)
    image.specmod().channelnames = ("R", "G", "Q")
    path = tmp_path / "a.exr"
    assert image.write(str(path))
    path.write_bytes(path.read_bytes().replace(b"Q\0", b"\xc7\0"))
    with pytest.raises(PhotoError, match="no R, G and B") as caught:
        read_photo(path)
    assert "\xc7" in str(caught.value)
    str(caught.value).encode()
