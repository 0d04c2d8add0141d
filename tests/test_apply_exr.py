"""Scene-linear EXR files, against the curve itself and against `oiiotool`."""

from __future__ import annotations

import resource
import signal
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import OpenImageIO as oiio  # noqa: N813
import pytest
from photo_files import CURVE, matrix_profile, oiiotool, pixels_of, random_codes, write, write_spi1d
from PIL import Image

from facecrf_ocio.color.primaries import KNOWN_PRIMARIES
from facecrf_ocio.errors import LutError, OutputError, SettingsError
from facecrf_ocio.image.apply import apply_lut, linear_rows, linearize_photo, write_exr
from facecrf_ocio.image.lookup import curve_lookup
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.values import Photo


def header_of(path: Path) -> Any:
    return oiio.ImageBuf(str(path)).spec()


@pytest.fixture
def jpeg(tmp_path: Path) -> Path:
    return write(
        tmp_path / "photo.jpg",
        random_codes(),
        oiio.UINT8,
        Make="ACME",
        Model="X 1",
        Software="camera 1.0",
        DateTime="2020:01:02 03:04:05",
        ExposureTime=0.01,
        Exif__PhotographicSensitivity=200,
        Exif__ColorSpace=1,
        Orientation=6,
    )


class TestExr:
    def test_equals_oiiotool_within_half_precision(self, tmp_path: Path) -> None:
        photo = read_photo(write(tmp_path / "a.png", random_codes(), oiio.UINT8))
        lut = write_spi1d(tmp_path / "a.spi1d")
        assert photo.path is not None
        expected = oiiotool(photo.path, lut, tmp_path / "expected.exr")
        path = write_exr(tmp_path / "a.exr", apply_lut(photo, lut), photo, provenance={}).path
        assert header_of(path).format.basetype == oiio.HALF
        assert np.allclose(pixels_of(path), expected, rtol=2**-10, atol=2**-24)

    @pytest.mark.parametrize("compression", ["none", "zip", "zips", "piz", "rle"])
    def test_floats_are_exact(self, tmp_path: Path, compression: str) -> None:
        photo = Photo((random_codes() / 255).astype(np.float32))
        linear = linearize_photo(photo, CURVE)
        path = tmp_path / "a.exr"
        write_exr(path, linear, photo, provenance={}, half=False, compression=compression)
        assert np.array_equal(pixels_of(path), linear)
        assert header_of(path).get_string_attribute("compression") == compression

    def test_a_level_changes_bytes_and_no_pixel(self, jpeg: Path) -> None:
        photo, lookup = read_photo(jpeg), curve_lookup(CURVE)
        written = [
            write_exr(
                jpeg.with_name(f"a{level[1:]}.exr"),
                linear_rows(photo, lookup),
                photo,
                provenance={},
                compression=f"zip{level}",
            ).path
            for level in ("", ":4", ":1")
        ]
        own, same, least = (path.read_bytes() for path in written)
        assert own == same != least  # OpenEXR's own level is 4
        first, *others = (pixels_of(path) for path in written)
        assert all(np.array_equal(first, other) for other in others)
        assert header_of(written[2]).get_string_attribute("compression") == "zip"

    @pytest.mark.parametrize("unknown", ["magic", "ZIP", "zip:", "zip:10", "piz:1", "dwaa:x", ""])
    def test_a_compression_that_openimageio_would_pass_over(
        self, tmp_path: Path, unknown: str
    ) -> None:
        photo = Photo((random_codes() / 255).astype(np.float32))
        with pytest.raises(SettingsError, match=r"is not one of|has no levels|give a level from"):
            write_exr(tmp_path / "a.exr", photo.encoded, photo, provenance={}, compression=unknown)
        assert not (tmp_path / "a.exr").exists()

    def test_half_is_clamped_to_its_largest_value(self, tmp_path: Path) -> None:
        photo = Photo(np.full((2, 2, 3), 1e6, np.float32), scene_linear=True)
        write_exr(tmp_path / "a.exr", photo.encoded, photo, provenance={})
        assert (pixels_of(tmp_path / "a.exr") == 65504).all()

    def test_colors_are_multiplied_by_alpha(self, tmp_path: Path) -> None:
        Image.fromarray(random_codes(4)).save(tmp_path / "a.png")
        photo = read_photo(tmp_path / "a.png")
        linear = linearize_photo(photo, CURVE)
        path = write_exr(tmp_path / "a.exr", linear, photo, provenance={}, half=False).path
        assert photo.alpha is not None
        assert header_of(path).channelnames == ("R", "G", "B", "A")
        assert np.array_equal(pixels_of(path)[..., 3], photo.alpha)
        assert np.array_equal(pixels_of(path)[..., :3], linear * photo.alpha[..., None])

    def test_reads_back_as_the_scene_linear_photo_it_is(self, tmp_path: Path) -> None:
        icc = matrix_profile(*KNOWN_PRIMARIES["Rec.2020"])
        Image.fromarray(random_codes()).save(tmp_path / "a.png", icc_profile=icc)
        photo = read_photo(tmp_path / "a.png")
        linear = linearize_photo(photo, CURVE)
        write_exr(tmp_path / "a.exr", linear, photo, provenance={}, half=False)
        again = read_photo(tmp_path / "a.exr")
        assert again.scene_linear
        assert again.primaries is not None
        assert again.primaries.name == "Rec.2020"
        assert np.array_equal(again.encoded, linear)


class TestRows:
    @pytest.mark.parametrize("height", [1, 256, 600])
    @pytest.mark.parametrize("half", [True, False])
    @pytest.mark.parametrize("bits", [8, 12, None])
    def test_in_bands_as_in_one_piece(
        self, tmp_path: Path, height: int, half: bool, bits: int | None
    ) -> None:
        encoded = np.random.default_rng(6).random((height, 30, 3), np.float32)
        if bits is not None:
            maximum = 2**bits - 1
            encoded = (np.rint(encoded * maximum) / maximum).astype(np.float32)
        photo = Photo(encoded, bit_depth=bits)
        rows = linear_rows(photo, curve_lookup(CURVE), half=half)
        write_exr(tmp_path / "a.exr", rows, photo, provenance={}, half=half)
        expected = CURVE.linearize(encoded).astype(np.float16 if half else np.float32)
        assert np.array_equal(pixels_of(tmp_path / "a.exr"), expected)


class TestMetadata:
    def test_what_still_holds_is_kept(self, tmp_path: Path, jpeg: Path) -> None:
        photo = read_photo(jpeg)
        path = write_exr(
            tmp_path / "a.exr", photo.encoded, photo, provenance={"lut": "a.spi1d"}
        ).path
        header = header_of(path)
        assert header.get_string_attribute("Make") == "ACME"
        assert header.get_string_attribute("Model") == "X 1"
        assert header.get_string_attribute("DateTime") == "2020:01:02 03:04:05"
        assert header.get_float_attribute("ExposureTime") == pytest.approx(0.01, rel=2e-4)
        assert header.get_int_attribute("Exif:PhotographicSensitivity") == 200
        assert header.get_string_attribute("facecrf:lut") == "a.spi1d"

    @pytest.mark.parametrize("tile", [0, 16])
    @pytest.mark.parametrize(
        ("at", "frame"), [((10, -5), (0, 0, 64, 48)), ((-4, -4), (0, 0, 24, 16)), ((7, 7), None)]
    )
    def test_pixels_of_an_exr_stay_where_they_are_in_the_frame(
        self, tmp_path: Path, at: tuple[int, int], frame: tuple[int, ...] | None, tile: int
    ) -> None:
        """A render's crop: data and display window, as OpenEXR itself reads them."""
        spec = oiio.ImageSpec(32, 24, 3, oiio.FLOAT)
        (spec.x, spec.y), spec.tile_width, spec.tile_height = at, tile, tile
        first = frame or (*at, 32, 24)
        spec.full_x, spec.full_y, spec.full_width, spec.full_height = first
        light = np.random.default_rng(0).random((24, 32, 3), np.float32)
        source = oiio.ImageOutput.create("openexr")
        assert source.open(str(tmp_path / "a.exr"), spec)
        assert source.write_image(light)
        source.close()
        photo = read_photo(tmp_path / "a.exr")
        path = write_exr(tmp_path / "b.exr", photo.encoded, photo, provenance={}, half=False).path
        with OpenEXR.File(str(tmp_path / "a.exr")) as a, OpenEXR.File(str(path)) as b:
            for window in ("dataWindow", "displayWindow"):
                assert np.array_equal(a.header()[window], b.header()[window]), window
            assert np.array_equal(b.channels()["RGB"].pixels, light)

    def test_what_holds_no_longer_is_dropped(self, tmp_path: Path) -> None:
        icc = matrix_profile(*KNOWN_PRIMARIES["Display P3"])
        exif = Image.Exif()
        exif[0x0112] = 6
        Image.fromarray(random_codes()).save(tmp_path / "a.jpg", icc_profile=icc, exif=exif)
        photo = read_photo(tmp_path / "a.jpg")
        header = header_of(write_exr(tmp_path / "a.exr", photo.encoded, photo, provenance={}).path)
        assert header.get_int_attribute("Orientation") == 1
        assert (header.height, header.width) == photo.encoded.shape[:2]
        for attribute in header.extra_attribs:
            assert not attribute.name.startswith(("ICCProfile", "jpeg:", "thumbnail", "Exif:Color"))

    @pytest.mark.parametrize(
        ("name", "interop_id"),
        [
            ("Rec.709", "lin_rec709_scene"),
            ("Display P3", "lin_p3d65_scene"),
            ("Rec.2020", "lin_rec2020_scene"),
            ("Adobe RGB", "lin_adobergb_scene"),
            ("ProPhoto", "unknown"),
            ("AP0", "lin_ap0_scene"),
            ("AP1", "lin_ap1_scene"),
        ],
    )
    def test_primaries(self, tmp_path: Path, name: str, interop_id: str) -> None:
        icc = matrix_profile(*KNOWN_PRIMARIES[name])
        Image.fromarray(random_codes()).save(tmp_path / "a.png", icc_profile=icc)
        photo = read_photo(tmp_path / "a.png")
        header = header_of(write_exr(tmp_path / "a.exr", photo.encoded, photo, provenance={}).path)
        assert header.get_string_attribute("colorInteropID") == interop_id
        assert header.get_string_attribute("facecrf:primaries") == f"{name} by ICC profile"
        expected = np.ravel(KNOWN_PRIMARIES[name])
        assert np.allclose(header.getattribute("chromaticities"), expected, atol=1e-6)

    def test_an_exr_in_acescg_stays_what_it_is(self, tmp_path: Path) -> None:
        told = np.ravel(KNOWN_PRIMARIES["AP1"]).tolist()
        spec = oiio.ImageSpec(16, 12, 3, oiio.HALF)
        spec.attribute("chromaticities", oiio.TypeDesc("float[8]"), told)
        out = oiio.ImageOutput.create("a.exr")
        assert out.open(str(tmp_path / "a.exr"), spec)
        out.write_image(np.full((12, 16, 3), 0.5, np.float32))
        out.close()
        photo = read_photo(tmp_path / "a.exr")
        header = header_of(write_exr(tmp_path / "b.exr", photo.encoded, photo, provenance={}).path)
        assert header.get_string_attribute("colorInteropID") == "lin_ap1_scene"
        assert np.allclose(header.getattribute("chromaticities"), told, atol=1e-6)

    def test_primaries_that_nobody_told_are_not_guessed(self, tmp_path: Path) -> None:
        photo = Photo(np.zeros((2, 3, 3), np.float32))
        header = header_of(write_exr(tmp_path / "a.exr", photo.encoded, photo, provenance={}).path)
        assert header.get_string_attribute("facecrf:primaries") == "unknown"
        assert header.get_string_attribute("colorInteropID") == "unknown"
        assert header.getattribute("chromaticities") is None

    def test_the_source_may_be_gone(self, tmp_path: Path, jpeg: Path) -> None:
        photo = read_photo(jpeg)
        jpeg.unlink()
        assert write_exr(tmp_path / "a.exr", photo.encoded, photo, provenance={}).path.exists()
        assert oiio.geterror() == ""


class TestRefusals:
    """A file appears whole or not at all."""

    photo = Photo(np.random.default_rng(9).random((64, 64, 3), np.float32))

    def write(self, path: Path, **options: Any) -> Path:
        return write_exr(path, self.photo.encoded, self.photo, provenance={}, **options).path

    def test_existing_file(self, tmp_path: Path) -> None:
        (tmp_path / "a.exr").write_text("mine")
        with pytest.raises(OutputError, match=r"a\.exr: exists already"):
            self.write(tmp_path / "a.exr")
        assert (tmp_path / "a.exr").read_text() == "mine"
        self.write(tmp_path / "a.exr", overwrite=True)
        assert pixels_of(tmp_path / "a.exr").shape == (64, 64, 3)

    def test_the_photo_itself_is_never_replaced(self, tmp_path: Path) -> None:
        photo = read_photo(self.write(tmp_path / "a.exr"))
        before = (tmp_path / "a.exr").read_bytes()
        with pytest.raises(OutputError, match="is the photo itself"):
            write_exr(tmp_path / "a.exr", photo.encoded, photo, provenance={}, overwrite=True)
        assert (tmp_path / "a.exr").read_bytes() == before

    def test_missing_folder(self, tmp_path: Path) -> None:
        with pytest.raises(OutputError, match="cannot be written"):
            self.write(tmp_path / "missing" / "a.exr")
        assert not (tmp_path / "missing").exists()

    def test_other_suffix(self, tmp_path: Path) -> None:
        with pytest.raises(OutputError, match=r"let it end in \.exr"):
            self.write(tmp_path / "a.png")

    def test_pixels_of_another_photo(self, tmp_path: Path) -> None:
        with pytest.raises(SettingsError, match="do not belong"):
            write_exr(tmp_path / "a.exr", np.zeros((2, 2, 3), "f"), self.photo, provenance={})

    @pytest.mark.parametrize("limit", [0, 2000, 20000])
    def test_full_disk(self, tmp_path: Path, limit: int) -> None:
        former = resource.getrlimit(resource.RLIMIT_FSIZE)
        handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        try:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, former[1]))
            with pytest.raises(OutputError, match=r"a\.exr: cannot be written: file too large"):
                self.write(tmp_path / "a.exr")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, former)
            signal.signal(signal.SIGXFSZ, handler)
        assert list(tmp_path.iterdir()) == []

    def test_rows_that_fail_leave_nothing(self, tmp_path: Path) -> None:
        def rows(begin: int, end: int) -> Any:
            raise LutError("a.clf: gives NaN")

        with pytest.raises(LutError, match="gives NaN"):
            write_exr(tmp_path / "a.exr", rows, self.photo, provenance={})
        assert list(tmp_path.iterdir()) == []

    def test_nothing_else_is_left_in_the_folder(self, tmp_path: Path) -> None:
        self.write(tmp_path / "a.exr")
        assert [path.name for path in tmp_path.iterdir()] == ["a.exr"]
