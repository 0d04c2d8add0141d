"""The OpenImageIO node, against `ociofiletransform`, `oiiotool` and the curve."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813
import pytest
from photo_files import (
    CURVE,
    matrix_profile,
    oiiotool,
    pixels_of,
    random_codes,
    write,
    write_spi1d,
)
from PIL import Image

from facecrf_ocio.color.primaries import KNOWN_PRIMARIES
from facecrf_ocio.errors import LutError, PhotoError, SettingsError
from facecrf_ocio.image.lut_lookup import lut_lookup
from facecrf_ocio.lut.write import write_lut

NODE = Path(__file__).parents[1] / "nodes" / "oiio"
sys.path.insert(0, str(NODE))

from facecrf_oiio import linearize, store  # noqa: E402
from facecrf_oiio.command import run  # noqa: E402

HEIGHT, WIDTH = 40, 60
TYPES = [oiio.UINT8, oiio.UINT16, oiio.HALF, oiio.FLOAT]


@pytest.fixture
def lut(tmp_path: Path) -> Path:
    return write_spi1d(tmp_path / "a.spi1d")


def image_of(kind: Any, channels: int = 3, **said: Any) -> oiio.ImageBuf:
    spec = oiio.ImageSpec(WIDTH, HEIGHT, channels, kind)
    for name, value in said.items():
        spec.attribute(name.replace("__", ":"), value)
    image = oiio.ImageBuf(spec)
    values = np.random.default_rng(3).random((HEIGHT, WIDTH, channels), np.float32)
    assert image.set_pixels(oiio.ROI(), values)
    return image


def floats(image: oiio.ImageBuf) -> npt.NDArray[np.float32]:
    return np.asarray(image.get_pixels(oiio.FLOAT))


def by_oiio(image: oiio.ImageBuf, lut: Path) -> npt.NDArray[np.float32]:
    return floats(oiio.ImageBufAlgo.ociofiletransform(image.copy(oiio.FLOAT), str(lut), False))


class TestBuffer:
    @pytest.mark.parametrize("kind", TYPES)
    @pytest.mark.parametrize("suffix", ["spi1d", "cube", "clf", "ctf", "csp"])
    def test_equals_openimageio(self, tmp_path: Path, kind: Any, suffix: str) -> None:
        lut = write_lut(CURVE, tmp_path / f"a.{suffix}")
        image = image_of(kind)
        expected = by_oiio(image, lut)
        full = linearize(image, lut, dtype=oiio.FLOAT)
        assert full.spec().format.basetype == oiio.FLOAT
        assert np.abs(floats(full) - expected).max() < 1e-6
        half = linearize(image, lut)
        assert half.spec().format.basetype == oiio.HALF
        assert np.allclose(floats(half), expected, rtol=2**-11, atol=1e-6)

    @pytest.mark.parametrize("kind", [oiio.INT16, oiio.UINT32, oiio.DOUBLE])
    def test_rarer_types(self, lut: Path, kind: Any) -> None:
        image = image_of(kind)
        found = linearize(image, lut, dtype=oiio.FLOAT)
        assert np.abs(floats(found) - by_oiio(image, lut)).max() < 1e-6

    @pytest.mark.parametrize("kind", TYPES)
    def test_alpha_and_extra_channels_are_untouched(self, lut: Path, kind: Any) -> None:
        spec = oiio.ImageSpec(WIDTH, HEIGHT, 6, kind)
        spec.channelnames = ("Z", "A", "B", "G", "R", "mask")
        spec.attribute("oiio:UnassociatedAlpha", 1)
        image = oiio.ImageBuf(spec)
        values = np.random.default_rng(3).random((HEIGHT, WIDTH, 6), np.float32)
        image.set_pixels(oiio.ROI(), values)
        before = floats(image)
        found = floats(linearize(image, lut, dtype=oiio.FLOAT))
        assert np.abs(found[..., [4, 3, 2]] - CURVE.linearize(before[..., [4, 3, 2]])).max() < 1e-6
        assert np.abs(found[..., [0, 1, 5]] - before[..., [0, 1, 5]]).max() < 1e-7

    @pytest.mark.parametrize("kind", TYPES)
    def test_colors_multiplied_by_alpha(self, lut: Path, kind: Any) -> None:
        image = image_of(kind, 4)
        oiio.ImageBufAlgo.premult(image, image)
        expected = oiio.ImageBufAlgo.ociofiletransform(
            image.copy(oiio.FLOAT), str(lut), unpremult=True
        )
        found = linearize(image, lut, dtype=oiio.FLOAT)
        assert np.abs(floats(found) - floats(expected)).max() < 2e-6
        straight = linearize(image, lut, dtype=oiio.FLOAT, unpremult=False)
        assert np.abs(floats(straight) - by_oiio(image, lut)).max() < 1e-6

    @pytest.mark.parametrize("kind", TYPES)
    def test_region(self, lut: Path, kind: Any) -> None:
        image = image_of(kind)
        region = oiio.ROI(10, 300, 5, 17)
        part = linearize(image, lut, dtype=oiio.FLOAT, roi=region)
        assert (part.xbegin, part.xend, part.ybegin, part.yend) == (10, WIDTH, 5, 17)
        assert np.abs(floats(part) - by_oiio(image, lut)[5:17, 10:]).max() < 1e-6

    def test_channels_outside_of_the_region(self, lut: Path) -> None:
        image = image_of(oiio.UINT8)
        region = oiio.ROI(0, WIDTH, 0, HEIGHT, 0, 1, 1, 2)
        found = floats(linearize(image, lut, dtype=oiio.FLOAT, roi=region))
        assert np.abs(found[..., 1] - by_oiio(image, lut)[..., 1]).max() < 1e-6
        assert np.array_equal(found[..., [0, 2]], floats(image)[..., [0, 2]])

    def test_data_window_with_an_offset(self, lut: Path) -> None:
        spec = oiio.ImageSpec(20, 10, 3, oiio.UINT8)
        spec.x, spec.y, spec.full_width, spec.full_height = -5, 7, 100, 90
        image = oiio.ImageBuf(spec)
        image.set_pixels(image.roi, np.random.default_rng(1).random((10, 20, 3), np.float32))
        found = linearize(image, lut, dtype=oiio.FLOAT)
        assert (found.roi, found.roi_full) == (image.roi, image.roi_full)
        assert np.abs(floats(found) - by_oiio(image, lut)).max() < 1e-6

    def test_into_a_given_buffer(self, lut: Path) -> None:
        image = image_of(oiio.UINT8)
        buffer = oiio.ImageBuf(oiio.ImageSpec(WIDTH, HEIGHT, 3, oiio.FLOAT))
        oiio.ImageBufAlgo.fill(buffer, (7.0, 7.0, 7.0))
        found = linearize(image, lut_lookup(lut), out=buffer, roi=oiio.ROI(0, WIDTH, 0, 9))
        assert found is buffer
        assert np.abs(floats(buffer)[:9] - by_oiio(image, lut)[:9]).max() < 1e-6
        assert (floats(buffer)[9:] == 7).all()
        with pytest.raises(SettingsError, match="`out` is"):
            linearize(image, lut, out=image_of(oiio.UINT8))

    def test_the_source_is_left_alone(self, lut: Path) -> None:
        image = image_of(oiio.FLOAT, Make="ACME")
        before = floats(image)
        linearize(image, lut, dtype=oiio.FLOAT)
        assert np.array_equal(floats(image), before)
        assert image.spec().get_string_attribute("colorInteropID") == ""

    def test_infinite_input_is_clamped_as_in_openimageio(self, lut: Path) -> None:
        image = image_of(oiio.FLOAT)
        odd = np.array([[[np.nan, -1.0, 2.0], [np.inf, -np.inf, 0.5]]], np.float32)
        image.set_pixels(oiio.ROI(0, 2, 0, 1, 0, 1, 0, 3), odd)
        assert np.array_equal(floats(linearize(image, lut, dtype=oiio.FLOAT)), by_oiio(image, lut))

    def test_refusals(self, tmp_path: Path, lut: Path) -> None:
        image = image_of(oiio.UINT8)
        with pytest.raises(SettingsError, match="no pixels in common"):
            linearize(image, lut, roi=oiio.ROI(500, 600, 0, 10))
        with pytest.raises(SettingsError, match="half or float"):
            linearize(image, lut, dtype=oiio.UINT8)
        with pytest.raises(LutError, match="does not exist"):
            linearize(image, tmp_path / "none.cube")
        with pytest.raises(PhotoError, match="R, G and B"):
            linearize(image_of(oiio.UINT8, 2), lut)
        with pytest.raises(PhotoError, match="can be read"):
            linearize(oiio.ImageBuf(), lut)
        deep = oiio.ImageSpec(4, 4, 3, oiio.FLOAT)
        deep.deep = True
        with pytest.raises(PhotoError, match="deep"):
            linearize(oiio.ImageBuf(deep), lut)


class TestStore:
    """Pixels into an ImageBuf, by files in memory and without them."""

    @pytest.fixture(params=["in memory", "by set_pixels", "no room for files", "cached"])
    def way(self, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Any:
        if request.param == "by set_pixels":
            monkeypatch.setattr(store, "has_files_in_memory", lambda: False)
        elif not store.has_files_in_memory():
            pytest.skip("no files in memory here")
        if request.param == "no room for files":
            refuse = OSError(24, "Too many open files")
            monkeypatch.setattr(store.os, "ftruncate", lambda *_: (_ for _ in ()).throw(refuse))
        oiio.attribute("imagebuf:use_imagecache", int(request.param == "cached"))
        monkeypatch.setattr(store, "_BAND", 20000)  # so that files are used again
        yield
        oiio.attribute("imagebuf:use_imagecache", 0)

    @pytest.mark.usefixtures("way")
    @pytest.mark.parametrize("channels", [1, 2, 3, 4, 5, 9])
    @pytest.mark.parametrize(
        ("kind", "dtype"),
        [(oiio.UINT8, "u1"), (oiio.UINT16, "u2"), (oiio.HALF, "f2"), (oiio.FLOAT, "f4")],
    )
    def test_every_bit_arrives(self, kind: Any, dtype: str, channels: int) -> None:
        spec = oiio.ImageSpec(301, 270, channels, kind)
        spec.x, spec.y = -7, 11
        image = oiio.ImageBuf(spec)
        size = 270 * 301 * channels * np.dtype(dtype).itemsize
        # Bits of all kinds, so NaN and infinities among them.
        pixels = np.random.default_rng(5).integers(0, 256, size, np.uint8).view(dtype)
        pixels = pixels.reshape(270, 301, channels)

        def make(band: oiio.ROI, out: npt.NDArray[Any]) -> None:
            out[...] = pixels[band.ybegin - 11 : band.yend - 11]

        store.store(image, image.roi, make)
        found = image.get_pixels(kind).reshape(pixels.shape)
        same = found.view(f"u{found.itemsize}") == pixels.view(f"u{found.itemsize}")
        assert (same | (np.isnan(found) & np.isnan(pixels))).all()
        assert (image.spec().nchannels, image.roi) == (channels, spec.roi)

    @pytest.mark.usefixtures("way")
    def test_large_images_equal_opencolorio(self, lut: Path) -> None:
        spec = oiio.ImageSpec(400, 300, 3, oiio.UINT16)
        image = oiio.ImageBuf(spec)
        image.set_pixels(oiio.ROI(), np.random.default_rng(3).random((300, 400, 3), np.float32))
        found = linearize(image, lut, dtype=oiio.FLOAT)
        assert np.abs(floats(found) - by_oiio(image, lut)).max() < 1e-6

    @pytest.mark.usefixtures("way")
    def test_only_the_region_is_written(self, lut: Path) -> None:
        image = oiio.ImageBuf(oiio.ImageSpec(400, 300, 3, oiio.UINT8))
        image.set_pixels(oiio.ROI(), np.random.default_rng(3).random((300, 400, 3), np.float32))
        buffer = oiio.ImageBuf(oiio.ImageSpec(400, 300, 3, oiio.FLOAT))
        oiio.ImageBufAlgo.fill(buffer, (7.0, 7.0, 7.0))
        linearize(image, lut, out=buffer, roi=oiio.ROI(50, 350, 100, 200))
        found, inside = floats(buffer), (slice(100, 200), slice(50, 350))
        assert np.abs(found[inside] - by_oiio(image, lut)[inside]).max() < 1e-6
        found[inside] = 7
        assert (found == 7).all()

    @pytest.mark.skipif(not store.has_files_in_memory(), reason="no files in memory here")
    def test_no_file_stays_open(self, lut: Path) -> None:
        image = oiio.ImageBuf(oiio.ImageSpec(400, 300, 3, oiio.UINT8))
        linearize(image, lut)
        before = len(list(Path("/proc/self/fd").iterdir()))
        linearize(image, lut)
        assert len(list(Path("/proc/self/fd").iterdir())) == before


class TestTags:
    @pytest.mark.parametrize(
        ("said", "expected"),
        [
            ({}, "unknown"),
            ({"oiio__ColorSpace": "srgb_rec709_scene"}, "lin_rec709_scene"),
            ({"Exif__ColorSpace": 1}, "lin_rec709_scene"),
            ({"colorInteropID": "srgb_rec709_scene"}, "lin_rec709_scene"),
            ({"oiio__ColorSpace": "srgb_p3d65_scene"}, "lin_p3d65_scene"),
        ],
    )
    def test_of_what_the_source_says(self, lut: Path, said: dict[str, Any], expected: str) -> None:
        spec = linearize(image_of(oiio.UINT8, **said), lut).spec()
        assert spec.get_string_attribute("oiio:ColorSpace") == expected
        assert spec.get_string_attribute("colorInteropID") == expected
        assert spec.get_int_attribute("Exif:ColorSpace", -1) == -1

    def test_of_a_profile(self, tmp_path: Path, lut: Path) -> None:
        icc = matrix_profile(*KNOWN_PRIMARIES["Rec.2020"])
        Image.fromarray(random_codes()).save(tmp_path / "a.png", icc_profile=icc)
        spec = linearize(oiio.ImageBuf(str(tmp_path / "a.png")), lut).spec()
        assert spec.get_string_attribute("oiio:ColorSpace") == "lin_rec2020_scene"
        assert not [a.name for a in spec.extra_attribs if a.name.startswith("ICCProfile")]

    def test_a_jpeg_that_tells_nothing_is_not_called_srgb(self, tmp_path: Path, lut: Path) -> None:
        image = oiio.ImageBuf(str(write(tmp_path / "a.jpg", random_codes(), oiio.UINT8)))
        assert image.spec().get_string_attribute("oiio:ColorSpace") == "srgb_rec709_scene"
        assert linearize(image, lut).spec().get_string_attribute("oiio:ColorSpace") == "unknown"

    def test_luts_say_themselves_where_they_lead(self, tmp_path: Path) -> None:
        lut = write_lut(CURVE, tmp_path / "a.clf", space="acescg")
        image = image_of(oiio.UINT8)
        spec = linearize(image, lut).spec()
        assert spec.get_string_attribute("oiio:ColorSpace") == "lin_ap1_scene"

    def test_luts_that_mix_channels_are_unknown_unless_told(self, tmp_path: Path) -> None:
        lut = write_mixing_lut(tmp_path / "a.clf")
        image = image_of(oiio.UINT8, oiio__ColorSpace="srgb_rec709_scene")
        assert linearize(image, lut).spec().get_string_attribute("oiio:ColorSpace") == "unknown"
        told = linearize(image, lut, dtype=oiio.FLOAT, colorspace="lin_ap1_scene")
        assert told.spec().get_string_attribute("oiio:ColorSpace") == "lin_ap1_scene"
        assert np.abs(floats(told) - by_oiio(image, lut)).max() < 1e-6

    def test_other_metadata_are_kept(self, lut: Path) -> None:
        spec = linearize(image_of(oiio.UINT8, Make="ACME", Orientation=6), lut).spec()
        assert spec.get_string_attribute("Make") == "ACME"
        assert spec.get_int_attribute("Orientation") == 6


def write_mixing_lut(path: Path) -> Path:
    """A matrix that leads to no known space."""
    path.write_text(
        '<ProcessList compCLFversion="3" id="a"><Matrix inBitDepth="32f" outBitDepth="32f">'
        '<Array dim="3 3">0.5 0.5 0 0 1 0 0 0.1 0.9</Array></Matrix></ProcessList>'
    )
    return path


def command(*arguments: object) -> int:
    return run([str(argument) for argument in arguments])


class TestCommand:
    @pytest.mark.parametrize("name", ["a.png", "a.tif", "a.jpg"])
    @pytest.mark.parametrize("output", ["b.exr", "b.tif"])
    def test_equals_oiiotool(self, tmp_path: Path, lut: Path, name: str, output: str) -> None:
        source = write(tmp_path / name, random_codes(), oiio.UINT8)
        expected = oiiotool(source, lut, tmp_path / "expected.exr")
        assert command(source, "--lut", lut, "-d", "float", "-o", tmp_path / output) == 0
        assert np.abs(pixels_of(tmp_path / output) - expected).max() < 1e-6
        assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
            {"a.spi1d", name, output, "expected.exr"}
        )

    def test_tags_and_compression(self, tmp_path: Path, lut: Path) -> None:
        source = write(tmp_path / "a.jpg", random_codes(), oiio.UINT8, Make="ACME")
        assert command(source, "--lut", lut, "--compression", "piz", "-o", tmp_path / "b.exr") == 0
        spec = oiio.ImageBuf(str(tmp_path / "b.exr")).spec()
        assert spec.format.basetype == oiio.HALF
        assert spec.get_string_attribute("compression") == "piz"
        assert spec.get_string_attribute("colorInteropID") == "unknown"
        assert spec.get_string_attribute("Make") == "ACME"

    @pytest.mark.parametrize("name", ["magic", "zip:0", "piz:1"])
    def test_a_compression_that_openimageio_would_pass_over(
        self, tmp_path: Path, lut: Path, name: str, capsys: pytest.CaptureFixture[str]
    ) -> None:
        source, output = write(tmp_path / "a.tif", random_codes(), oiio.UINT8), tmp_path / "b.exr"
        assert command(source, "--lut", lut, "--compression", name, "-o", output) == 2
        assert repr(name) in capsys.readouterr().err
        assert not output.exists()

    def test_straight_alpha_is_multiplied(self, tmp_path: Path, lut: Path) -> None:
        codes = random_codes(4)
        Image.fromarray(codes).save(tmp_path / "a.png")
        assert (
            command(tmp_path / "a.png", "--lut", lut, "-d", "float", "-o", tmp_path / "b.exr") == 0
        )
        alpha = (codes[..., 3:] / 255).astype(np.float32)
        found = pixels_of(tmp_path / "b.exr")
        assert np.abs(found[..., :3] - CURVE.linearize(codes[..., :3] / 255) * alpha).max() < 1e-6
        assert np.array_equal(found[..., 3:], alpha)

    def test_multi_part_and_precise_depth(self, tmp_path: Path, lut: Path) -> None:
        source = tmp_path / "a.exr"
        rng = np.random.default_rng(4)
        color, depth = oiio.ImageSpec(30, 20, 4, oiio.FLOAT), oiio.ImageSpec(30, 20, 1, oiio.FLOAT)
        color.channelnames, depth.channelnames = ("R", "G", "B", "Z"), ("Z",)
        color.channelformats = tuple(oiio.TypeDesc(t) for t in ("half", "half", "half", "float"))
        specs = [color, depth, oiio.ImageSpec(color)]
        pixels = [rng.random((20, 30, spec.nchannels), np.float32) for spec in specs]
        for number, spec in enumerate(specs):
            spec.attribute("oiio:subimagename", f"part{number}")
        output = oiio.ImageOutput.create("a.exr")
        assert output.open(str(source), specs)
        for number, spec in enumerate(specs):
            assert number == 0 or output.open(str(source), spec, "AppendSubimage")
            assert output.write_image(pixels[number])
        output.close()
        assert command(source, "--lut", lut, "-o", tmp_path / "b.exr") == 0
        for number in range(3):
            found = oiio.ImageBuf(str(tmp_path / "b.exr"), number, 0)
            spec = found.spec()
            assert spec.get_string_attribute("oiio:subimagename") == f"part{number}"
            z = spec.channelnames.index("Z")
            assert str(spec.channelformat(z)) == "float"
            assert np.array_equal(floats(found)[..., z], pixels[number][..., -1])
            if spec.nchannels == 4:
                assert {str(spec.channelformat(c)) for c in range(4) if c != z} == {"half"}
                given = pixels[number][..., :3].astype(np.float16).astype(np.float32)
                order = [spec.channelnames.index(name) for name in "RGB"]
                assert np.allclose(
                    floats(found)[..., order], CURVE.linearize(given), rtol=2**-11, atol=1e-6
                )

    @pytest.mark.parametrize("region", [False, True])
    def test_tiles(self, tmp_path: Path, lut: Path, region: bool) -> None:
        spec = oiio.ImageSpec(64, 48, 3, oiio.UINT16)
        spec.tile_width = spec.tile_height = 16
        codes = random_codes(dtype=np.uint16)
        codes = np.resize(codes, (48, 64, 3))
        output = oiio.ImageOutput.create("a.tif")
        assert output.open(str(tmp_path / "a.tif"), spec)
        assert output.write_image(codes)
        output.close()
        options = ("--roi", "20x9+3+4") if region else ()
        target = tmp_path / "b.exr"
        assert command(tmp_path / "a.tif", "--lut", lut, "-d", "float", *options, "-o", target) == 0
        expected = CURVE.linearize((codes / 65535).astype(np.float32))
        found = oiio.ImageBuf(str(target))
        assert (found.spec().tile_width, found.spec().tile_height) == (16, 16)
        expected = expected[4:13, 3:23] if region else expected
        assert (found.xbegin, found.ybegin) == ((3, 4) if region else (0, 0))
        assert np.abs(floats(found) - expected).max() < 1e-6


class TestCommandRefuses:
    @pytest.fixture
    def source(self, tmp_path: Path) -> Path:
        return write(tmp_path / "a.png", random_codes(), oiio.UINT8)

    def told(self, capsys: pytest.CaptureFixture[str]) -> str:
        said = capsys.readouterr().err
        assert said.count("\n") == 1
        assert said.startswith("facecrf-oiio: ")
        return said

    def test_existing_file(
        self, tmp_path: Path, lut: Path, source: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        target = tmp_path / "b.exr"
        target.write_text("mine")
        assert command(source, "--lut", lut, "-o", target) == 1
        assert "b.exr: exists already; pass --overwrite to replace it\n" in self.told(capsys)
        assert target.read_text() == "mine"
        assert command(source, "--lut", lut, "-o", target, "--overwrite") == 0
        assert oiio.ImageBuf(str(target)).spec().width == random_codes().shape[1]

    def test_the_image_itself(
        self, tmp_path: Path, lut: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        source = write(tmp_path / "a.tif", random_codes(), oiio.UINT8)
        before = source.read_bytes()
        assert command(source, "--lut", lut, "-o", source, "--overwrite") == 1
        assert "is the image itself" in self.told(capsys)
        assert source.read_bytes() == before

    @pytest.mark.parametrize(
        ("options", "code", "problem"),
        [
            (("missing.png", "--lut", "a.spi1d", "-o", "b.exr"), 3, "does not exist"),
            (("a.png", "--lut", "none.cube", "-o", "b.exr"), 3, "does not exist"),
            (("a.png", "--lut", "a.png", "-o", "b.exr"), 3, "cannot read it"),
            (("a.spi1d", "--lut", "a.spi1d", "-o", "b.exr"), 3, "is not an image"),
            (("a.png", "--lut", "a.spi1d", "-o", "b.png"), 1, "cannot hold linear light"),
            (("a.png", "--lut", "a.spi1d", "-o", "no/b.exr"), 1, "create the folder first"),
            (("a.png", "--lut", "a.spi1d", "-o", "b.exr", "--roi", "1"), 2, "is no region"),
            (("a.png", "--lut", "a.spi1d", "-o", "b.exr", "--roi", "2x2+900+0"), 2, "in common"),
        ],
    )
    def test_what_cannot_be(
        self,
        tmp_path: Path,
        lut: Path,
        source: Path,
        options: tuple[str, ...],
        code: int,
        problem: str,
        capsys: pytest.CaptureFixture[str],
        monkeypatch: pytest.MonkeyPatch,
    ) -> None:
        monkeypatch.chdir(tmp_path)
        assert command(*options) == code
        assert problem in self.told(capsys)
        assert {path.name for path in tmp_path.iterdir()} == {"a.png", "a.spi1d"}

    def test_wrong_usage(self, capsys: pytest.CaptureFixture[str]) -> None:
        with pytest.raises(SystemExit) as ended:
            command("a.png")
        assert ended.value.code == 2
        assert "required" in self.told(capsys)

    def test_damaged_image(
        self, tmp_path: Path, lut: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        source = write(tmp_path / "a.jpg", random_codes(), oiio.UINT8)
        source.write_bytes(source.read_bytes()[:700])
        assert command(source, "--lut", lut, "-o", tmp_path / "b.exr") == 3
        self.told(capsys)
        assert not (tmp_path / "b.exr").exists()

    @pytest.mark.parametrize("limit", [0, 700])
    def test_full_disk(
        self,
        tmp_path: Path,
        lut: Path,
        source: Path,
        limit: int,
        capsys: pytest.CaptureFixture[str],
    ) -> None:
        former = resource.getrlimit(resource.RLIMIT_FSIZE)
        handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        try:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, former[1]))
            assert command(source, "--lut", lut, "-o", tmp_path / "b.exr") == 1
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, former)
            signal.signal(signal.SIGXFSZ, handler)
        assert "file too large" in self.told(capsys)
        assert {path.name for path in tmp_path.iterdir()} == {"a.png", "a.spi1d"}

    def test_runs_as_a_module(self, tmp_path: Path, lut: Path, source: Path) -> None:
        places = os.pathsep.join([str(NODE), str(NODE.parents[1])])
        subprocess.run(
            [sys.executable, "-m", "facecrf_oiio", source, "--lut", lut, "-o", tmp_path / "b.exr"],
            check=True,
            env={**os.environ, "PYTHONPATH": places},
        )
        assert (tmp_path / "b.exr").exists()
