"""Photos as they lie on disks: misnamed, patched up, in pages, with profiles that are none."""

from __future__ import annotations

import struct
from base64 import b64encode
from io import BytesIO
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from hypothesis import given
from hypothesis import strategies as st
from odd_files import chunk, strip, with_chunks
from odd_files import kind as numbers
from photo_files import (
    app1,
    exif_of,
    matrix_profile,
    random_codes,
    segment,
    with_segments,
    write,
    write_dng,
    write_spi1d,
)
from PIL import Image

from facecrf_ocio import read_photo
from facecrf_ocio.archive.walk import photos_under
from facecrf_ocio.calibrate import assumptions_of
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.containers.jpeg_segments import take_apart
from facecrf_ocio.photo.containers.no_photo import no_photo
from facecrf_ocio.photo.containers.suffixes import KINDS, PHOTO_SUFFIXES, RAW_SUFFIXES, kind_of
from facecrf_ocio.photo.containers.tiff_pages import holds_raw
from facecrf_ocio.photo.decoding.channels import color_channels
from facecrf_ocio.photo.tags.profile import primaries_from_icc, profile_notes

RAMP = np.tile(np.linspace(0, 255, 48).astype(np.uint8)[:, None], (1, 32))
REC709 = ((0.64, 0.33), (0.3, 0.6), (0.15, 0.06), (0.3127, 0.329))


def jpeg_of(gray: np.ndarray = RAMP, **options: int) -> bytes:
    out = BytesIO()
    Image.fromarray(np.repeat(gray[..., None], 3, axis=2)).save(out, "JPEG", quality=95, **options)
    return out.getvalue()


JPEG = jpeg_of()


def pixels(jpeg: bytes) -> np.ndarray:
    """What OpenCV's libjpeg makes of it."""
    codes = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    return codes[..., ::-1] / np.float32(255)


class TestContentBeforeSuffix:
    @pytest.mark.parametrize(
        "suffix", [".dng", ".CR2", ".raw", ".tif", ".png", ".heic", ".xyz", ""]
    )
    def test_jpeg_by_another_name(self, tmp_path: Path, suffix: str) -> None:
        path = tmp_path / f"a{suffix}"
        path.write_bytes(JPEG)
        photo = read_photo(path)
        assert not photo.scene_linear
        assert np.array_equal(photo.encoded, pixels(JPEG))

    @pytest.mark.parametrize("suffix", [".tif", ".jpg", ".dng"])
    def test_camera_raw_by_another_name(self, tmp_path: Path, suffix: str) -> None:
        path = write_dng(tmp_path / f"a{suffix}", np.full((64, 64), 9000.0))
        assert holds_raw(path.read_bytes())
        assert read_photo(path).scene_linear

    def test_an_ordinary_tiff_is_not_camera_raw(self, tmp_path: Path) -> None:
        Image.fromarray(RAMP).save(tmp_path / "a.tif")
        assert not holds_raw((tmp_path / "a.tif").read_bytes())

    @given(st.binary(max_size=300))
    def test_any_bytes_after_a_tiffs_first_are_looked_at_safely(self, tail: bytes) -> None:
        assert holds_raw(b"II*\0" + tail) in (True, False)
        assert holds_raw(b"MM\0*" + tail) in (True, False)

    def test_raw_that_decodes_to_zeros(self, tmp_path: Path) -> None:
        path = write_dng(tmp_path / "a.dng", np.zeros((64, 64)))
        with pytest.raises(PhotoError, match="zeros alone"):
            read_photo(path)

    @pytest.mark.parametrize(
        ("content", "told"),
        [
            (bytes(5000), "begins with zeros alone"),
            (b"\xef\xbb\xbf \n<!DOCTYPE HTML><p>404", "is a web page"),
            (b"<?xml version='1.0'?><Error/>", "is XML"),
            (b"<?xml version='1.0'?><svg></svg>", "is a drawing"),
            (b"version https://git-lfs.github.com/spec/v1\noid", "Git LFS"),
            (b"%PDF-1.7\n", "is a PDF"),
            (b64encode(JPEG), "written as text"),
            (b"data:image/jpeg;base64,/9j/", "written as text"),
            (b"\0\0\0\x18ftypmp42" + bytes(400), "is a video"),
            (b"PK\3\4" + bytes(400), "is a ZIP archive"),
            (b"bplist00" + bytes(400), "as iCloud leaves it"),
            (b"nothing that is known", "is not an image that can be read"),
        ],
    )
    @pytest.mark.parametrize("suffix", [".jpg", ".png"])
    def test_what_is_no_photo_is_called_what_it_is(
        self, tmp_path: Path, suffix: str, content: bytes, told: str
    ) -> None:
        path = tmp_path / f"a{suffix}"
        path.write_bytes(content)
        with pytest.raises(PhotoError, match=told):
            read_photo(path)

    @given(st.binary(max_size=100))
    def test_any_bytes_are_asked_what_they_are(self, head: bytes) -> None:
        told = no_photo(head)
        assert told is None or all(told)


class TestNumbers:
    @pytest.mark.parametrize(("gamma", "linear"), [(0, False), (100000, True), (45455, False)])
    def test_a_gamma_of_zero_says_nothing(self, tmp_path: Path, gamma: int, linear: bool) -> None:
        path = tmp_path / "a.png"
        path.write_bytes(with_chunks(chunk(b"gAMA", struct.pack(">I", gamma))))
        assert read_photo(path).scene_linear is linear

    def test_code_values_as_floating_point_are_no_light(self, tmp_path: Path) -> None:
        ramp = np.repeat(np.arange(256, dtype=np.float32).reshape(16, 16)[..., None], 3, axis=2)
        write(tmp_path / "a.tif", ramp, oiio.FLOAT)
        with pytest.raises(PhotoError, match="holds code values up to 255 as floating point"):
            read_photo(tmp_path / "a.tif")
        for light in (ramp * 64, ramp / 255, np.minimum(ramp, 20), ramp + np.float32(0.25)):
            write(tmp_path / "a.tif", light, oiio.FLOAT)
            assert read_photo(tmp_path / "a.tif").scene_linear

    @pytest.mark.parametrize("scheme", [34925, 50000, 65000])  # LZMA, Zstandard, nobody's
    def test_a_compression_that_is_not_known(self, tmp_path: Path, scheme: int) -> None:
        path = write(tmp_path / "a.tif", random_codes(), oiio.UINT8, compression="none")
        content = bytearray(path.read_bytes())
        at = content.index(struct.pack("<HHI", 259, 3, 1))
        struct.pack_into("<H", content, at + 8, scheme)
        path.write_bytes(content)
        with pytest.raises(PhotoError, match="compressed as cannot be undone here") as refused:
            read_photo(path)
        assert "LZW" in refused.value.remedy


class TestTheTable:
    def test_no_suffix_belongs_to_two_kinds(self) -> None:
        suffixes = [suffix for kind in KINDS for suffix in kind.suffixes]
        assert len(suffixes) == len(set(suffixes)) == len(PHOTO_SUFFIXES)

    def test_kinds_are_told_apart_by_their_first_bytes(self) -> None:
        for kind in KINDS:
            for at, magic in kind.starts:
                assert kind_of(bytes(at) + magic + bytes(16)) is kind

    def test_what_openimageio_writes_is_known(self, tmp_path: Path) -> None:
        for suffix in (
            ".jpg",
            ".png",
            ".tif",
            ".exr",
            ".jp2",
            ".jxl",
            ".webp",
            ".gif",
            ".bmp",
            ".hdr",
        ):
            path = tmp_path / f"a{suffix}"
            out = oiio.ImageOutput.create(str(path))
            if out is None:  # not in every build
                continue
            assert out.open(str(path), oiio.ImageSpec(48, 32, 3, oiio.UINT8))
            out.write_image(np.zeros((32, 48, 3), np.uint8))
            out.close()
            kind = kind_of(path.read_bytes()[:64])
            assert kind is not None, suffix
            assert suffix in kind.suffixes

    def test_a_walk_finds_every_kind(self, tmp_path: Path) -> None:
        for suffix in PHOTO_SUFFIXES | {".txt", ".mov"}:
            (tmp_path / f"a{suffix}").touch()
        assert {path.suffix for path in photos_under(tmp_path)} == PHOTO_SUFFIXES
        assert {".3fr", ".cr3", ".crw", ".mef", ".x3f"} <= RAW_SUFFIXES


class TestJpeg:
    @pytest.mark.parametrize(
        ("flaw", "note"),
        [
            (lambda whole: whole[:20] + b"\x01\x02\x03" + whole[20:], "3 stray bytes"),
            (lambda whole: b"\r\n" + whole, "2 stray bytes"),
            (lambda whole: whole[:-2], "mark that ends"),
            (lambda whole: whole[:-1], "mark that ends"),
            (lambda whole: whole + b"left over " * 9, "90 bytes after"),
        ],
    )
    def test_flaws_that_cost_no_pixel(self, tmp_path: Path, flaw, note: str) -> None:
        path = tmp_path / "a.jpg"
        path.write_bytes(flaw(JPEG))
        photo = read_photo(path)
        assert np.array_equal(photo.encoded, pixels(JPEG))
        assert len(photo.notes) == 1
        assert note in photo.notes[0]
        assert any(note in said for said in assumptions_of(photo))

    @pytest.mark.parametrize("tail", [b"", b"\0" * 64, JPEG, b"\0\0\0\x18ftypmp42" + bytes(99)])
    def test_what_needs_no_note(self, tmp_path: Path, tail: bytes) -> None:
        path = tmp_path / "a.jpg"
        path.write_bytes(JPEG + tail)
        photo = read_photo(path)
        assert np.array_equal(photo.encoded, pixels(JPEG))
        assert photo.notes == ()

    @pytest.mark.parametrize("options", [{}, {"progressive": 1}])
    def test_a_jpeg_cut_within_its_pixels_is_refused(self, tmp_path: Path, options) -> None:
        noise = np.random.default_rng(1).integers(0, 256, (64, 64), np.uint8)
        path = tmp_path / "a.jpg"
        path.write_bytes(jpeg_of(noise, **options)[:-9])
        with pytest.raises(PhotoError, match="cut short"):
            read_photo(path)

    @given(st.binary(max_size=400))
    def test_any_bytes_are_taken_apart(self, tail: bytes) -> None:
        parts = take_apart(b"\xff\xd8\xff" + tail)
        assert parts is not None
        assert (parts.picture[:2], parts.picture[-2:]) == (b"\xff\xd8", b"\xff\xd9")
        assert len(parts.picture) + len(parts.rest) <= len(tail) + 5


def xmp_segment(orientation: int | str, form: str) -> bytes:
    said = {
        "attribute": f'<rdf:Description tiff:Orientation="{orientation}"/>',
        "element": f"<rdf:Description><tiff:Orientation>{orientation}</tiff:Orientation>"
        "</rdf:Description>",
    }[form]
    packet = f"<x:xmpmeta><rdf:RDF>{said}</rdf:RDF></x:xmpmeta>"
    return segment(0xE1, b"http://ns.adobe.com/xap/1.0/\0" + packet.encode())


class TestOrientation:
    @pytest.mark.parametrize("form", ["attribute", "element"])
    def test_of_xmp_where_exif_has_none(self, tmp_path: Path, form: str) -> None:
        path = tmp_path / "a.jpg"
        path.write_bytes(with_segments(JPEG, xmp_segment(6, form)))
        assert np.array_equal(read_photo(path).encoded, np.rot90(pixels(JPEG), -1))

    @pytest.mark.parametrize(
        "said", ['xmlns:t="{0}" t:Orientation=" 6 "', "xmlns:T='{0}' T:Orientation='6'"]
    )
    def test_of_xmp_that_calls_the_namespace_otherwise(self, tmp_path: Path, said: str) -> None:
        path, space = tmp_path / "a.jpg", "http://ns.adobe.com/tiff/1.0/"
        packet = f"<x:xmpmeta><rdf:RDF><rdf:Description {said.format(space)}/></rdf:RDF>"
        xmp = segment(0xE1, b"http://ns.adobe.com/xap/1.0/\0" + packet.encode())
        path.write_bytes(with_segments(JPEG, xmp))
        assert np.array_equal(read_photo(path).encoded, np.rot90(pixels(JPEG), -1))

    @pytest.mark.parametrize("odd", [0, 9, 65535])
    def test_of_xmp_where_that_of_exif_is_none(self, tmp_path: Path, odd: int) -> None:
        path = tmp_path / "a.jpg"
        path.write_bytes(
            with_segments(JPEG, app1(exif_of({274: odd})), xmp_segment(6, "attribute"))
        )
        assert np.array_equal(read_photo(path).encoded, np.rot90(pixels(JPEG), -1))

    @pytest.mark.parametrize("said", ["1" * 5000, "0", "9", "12"], ids=len)
    def test_of_xmp_that_is_none(self, tmp_path: Path, said: str) -> None:
        path, plain = tmp_path / "a.jpg", tmp_path / "b.jpg"
        path.write_bytes(with_segments(JPEG, xmp_segment(said, "attribute")))
        plain.write_bytes(JPEG)
        assert np.array_equal(read_photo(path).encoded, read_photo(plain).encoded)

    def test_exif_goes_before_xmp(self, tmp_path: Path) -> None:
        path = tmp_path / "a.jpg"
        exif = app1(exif_of({274: 3}))
        path.write_bytes(with_segments(JPEG, exif, xmp_segment(6, "attribute")))
        assert np.array_equal(read_photo(path).encoded, np.rot90(pixels(JPEG), 2))


@pytest.mark.parametrize(("kind_of_number", "white"), [(np.uint16, 65535), (np.float32, 1)])
def test_zero_may_be_white(tmp_path: Path, kind_of_number: Any, white: int) -> None:
    tifffile = pytest.importorskip("tifffile")
    codes = np.linspace(0, white, 32 * 48).astype(kind_of_number).reshape(32, 48)
    for name, kind in (("a.tif", "minisblack"), ("b.tif", "miniswhite")):
        tifffile.imwrite(tmp_path / name, codes, photometric=kind)
    plain, inverted = (read_photo(tmp_path / name).encoded for name in ("a.tif", "b.tif"))
    assert np.allclose(inverted, 1 - plain, atol=1e-6)


def test_a_page_marked_as_thumbnail_is_passed_over(tmp_path: Path) -> None:
    tifffile = pytest.importorskip("tifffile")
    with tifffile.TiffWriter(tmp_path / "a.tif") as out:
        out.write(np.full((90, 90, 3), 200, np.uint8), photometric="rgb", subfiletype=1)
        out.write(np.full((30, 40, 3), 100, np.uint8), photometric="rgb", subfiletype=0)
    photo = read_photo(tmp_path / "a.tif")
    assert photo.encoded.shape == (30, 40, 3)
    assert "page 2 of 2" in photo.notes[0]


class TestRaw:
    @pytest.mark.parametrize(("orientation", "shape"), [(1, (40, 60)), (6, (60, 40))])
    def test_the_crop_a_dng_asks_for(self, tmp_path: Path, orientation: int, shape) -> None:
        mosaic = np.full((64, 96), 3000.0)
        mosaic[8:48, 16:76] = 30000.0
        crop = {"t50719": (16, 8), "t50720": (60, 40), "t274": (orientation,)}
        photo = read_photo(write_dng(tmp_path / "a.dng", mosaic, **crop))
        assert photo.encoded.shape[:2] == shape
        inner = photo.encoded[4:-4, 4:-4]
        assert inner.min() == pytest.approx(inner.max(), rel=1e-3)

    def test_black_is_subtracted(self, tmp_path: Path) -> None:
        mosaic = np.full((64, 64), 2048.0)
        mosaic[:, 32:] = 2048.0 + 16000.0
        mosaic[:4] = 65535.0  # so that the scale is the same with and without black
        photo = read_photo(write_dng(tmp_path / "a.dng", mosaic, t50714=(2048,)))
        assert photo.encoded[20:, 4:28].max() < 1e-3
        expected = 16000 / (65535 - 2048)
        assert photo.encoded[20:, 36:60].mean() == pytest.approx(expected, rel=0.01)


def broken(profile: bytes, tag: bytes, content: bytes) -> bytes:
    """A profile with the numbers of one tag replaced."""
    at = profile.index(tag, 128)
    offset = struct.unpack_from(">I", profile, at + 4)[0] + 8
    return profile[:offset] + content + profile[offset + len(content) :]


PROFILE = matrix_profile(*REC709)


class TestProfiles:
    @pytest.mark.parametrize(
        "profile",
        [
            broken(PROFILE, b"chad", bytes(36)),
            broken(broken(PROFILE, b"rXYZ", bytes(12)), b"gXYZ", bytes(12)),
            broken(PROFILE, b"rXYZ", bytes(12)),
            broken(PROFILE, b"gXYZ", PROFILE[PROFILE.index(b"XYZ \0\0\0\0", 132) + 8 :][:12]),
            broken(PROFILE, b"chad", struct.pack(">9i", *([65536] * 9))),
            broken(matrix_profile(*REC709, version=2), b"bXYZ", b"\x80\0\0\0" * 3),
            PROFILE[:200],
            PROFILE[:16] + b"CMYK" + PROFILE[20:],
            PROFILE[:12] + b"link" + PROFILE[16:],
            b"no profile at all" * 20,
        ],
    )
    def test_a_profile_of_no_use_is_set_aside_with_a_note(
        self, tmp_path: Path, profile: bytes
    ) -> None:
        assert primaries_from_icc(profile) is None
        path = tmp_path / "a.jpg"
        icc = segment(0xE2, b"ICC_PROFILE\0\x01\x01" + profile)
        path.write_bytes(with_segments(JPEG, icc, app1(exif_of({271: b"Acme\0"}))))
        photo = read_photo(path)
        assert photo.primaries is None
        assert "ICC profile was set aside" in photo.notes[0]

    @pytest.mark.parametrize(
        ("profile", "fault"),
        [
            (PROFILE[:16] + b"GRAY" + PROFILE[20:], "it is of gray, and the picture is not"),
            (PROFILE[:16] + b"CMYK" + PROFILE[20:], "it is of CMYK, and no photo's"),
            (PROFILE.replace(b"rXYZ", b"xXYZ", 1), "it tells of no primaries, but by tables"),
            (b"", "it is damaged"),
        ],
    )
    @pytest.mark.parametrize("suffix", [".jpg", ".png", ".tif", ".webp"])
    def test_a_profile_that_does_not_fit_the_picture(
        self, tmp_path: Path, profile: bytes, fault: str, suffix: str
    ) -> None:
        path = tmp_path / f"a{suffix}"
        Image.fromarray(random_codes()).save(path, icc_profile=profile or b"no profile" * 9)
        photo = read_photo(path)
        assert photo.primaries is None
        assert photo.notes == (f"its ICC profile was set aside: {fault}",)

    @pytest.mark.parametrize("suffix", [".jpg", ".png", ".tif"])
    def test_a_profile_of_gray_fits_a_gray_picture(self, tmp_path: Path, suffix: str) -> None:
        path = tmp_path / f"a{suffix}"
        gray = PROFILE[:16] + b"GRAY" + PROFILE[20:]
        Image.fromarray(random_codes()[..., 0]).save(path, icc_profile=gray)
        assert read_photo(path).notes == ()

    def test_a_png_whose_profile_cannot_be_inflated(self, tmp_path: Path) -> None:
        (tmp_path / "a.png").write_bytes(with_chunks(chunk(b"iCCP", b"a\0\0" + b"\xff" * 90)))
        (note,) = read_photo(tmp_path / "a.png").notes
        assert note == "its ICC profile was set aside: it is damaged"

    def test_a_sound_profile_gets_no_note(self) -> None:
        assert profile_notes(PROFILE) == () == profile_notes(b"")
        assert primaries_from_icc(PROFILE) is not None

    @given(st.integers(132, len(PROFILE) - 5), st.binary(min_size=1, max_size=4))
    def test_primaries_of_a_damaged_profile_are_finite_or_none(self, at: int, odd: bytes) -> None:
        found = primaries_from_icc(PROFILE[:at] + odd + PROFILE[at + len(odd) :])
        if found is not None:
            assert np.isfinite((found.red, found.green, found.blue, found.white)).all()


def test_a_jpeg_of_which_nothing_is_left_out_is_its_own_picture() -> None:
    content = jpeg_of()
    whole = take_apart(content)
    assert whole.picture is content
    for odd in (b"\0\0" + content, content + b"more", content[:-2]):
        parts = take_apart(odd)
        assert parts.picture == content
        assert parts.picture is not odd


def test_an_exr_of_names_of_objects_is_no_picture(tmp_path: Path) -> None:
    names = np.random.default_rng(0).integers(0, 9, (12, 16, 3), np.uint32)
    path = write(tmp_path / "a.exr", names, oiio.UINT32)
    with pytest.raises(PhotoError, match=r"whole numbers.* no light; use the EXR with"):
        read_photo(path)


def test_names_of_objects_beside_colors_are_left_aside(tmp_path: Path) -> None:
    spec = oiio.ImageSpec(16, 12, 4, oiio.HALF)
    spec.channelnames = ("R", "G", "B", "id")
    spec.channelformats = (oiio.TypeHalf,) * 3 + (oiio.TypeUInt32,)
    output = oiio.ImageOutput.create(str(tmp_path / "a.exr"))
    output.open(str(tmp_path / "a.exr"), spec)
    light = np.random.default_rng(0).random((12, 16, 4), np.float32)
    output.write_image(light)
    output.close()
    photo = read_photo(tmp_path / "a.exr")
    assert photo.scene_linear
    assert photo.encoded == pytest.approx(light[..., :3], rel=1e-3)


class TestWholeFilesOfKindsThatAreNotRead:
    """They are not told to be damaged: a copy of them would be no better."""

    def test_a_jpeg_of_12_bits(self, tmp_path: Path) -> None:
        at = JPEG.index(b"\xff\xc0") + 4
        (tmp_path / "a.jpg").write_bytes(JPEG[:at] + b"\x0c" + JPEG[at + 1 :])
        with pytest.raises(PhotoError, match=r"kind of JPEG that is not read.*12.* 8 bits"):
            read_photo(tmp_path / "a.jpg")

    def test_floating_point_of_24_bits(self, tmp_path: Path) -> None:
        content = strip(bytes(32 * 24 * 9), 32, 24, *numbers(24, 2, 3, 3))
        (tmp_path / "a.tif").write_bytes(content)
        with pytest.raises(PhotoError, match="floating point of 24 bits"):
            read_photo(tmp_path / "a.tif")

    @pytest.mark.parametrize("name", ["Z", "depth", "beauty.Z"])
    def test_distances_are_no_light(self, tmp_path: Path, name: str) -> None:
        path = write(tmp_path / "a.exr", np.ones((12, 16, 1), np.float32), oiio.FLOAT, (name,))
        with pytest.raises(PhotoError, match="but no R, G and B"):
            read_photo(path)


def test_channels_of_16_bits_one_after_another_in_one_strip(tmp_path: Path) -> None:
    codes = np.random.default_rng(1).integers(0, 65536, (200, 16, 3), np.uint16)
    told = {"planarconfig": "separate", "compression": "zip", "tiff:RowsPerStrip": 200}
    path = write(tmp_path / "a.tif", codes, oiio.UINT16, **told)
    assert np.array_equal(np.rint(read_photo(path).encoded * 65535), codes)


def test_a_film_scan_need_not_name_its_channels() -> None:
    spec = oiio.ImageSpec(16, 12, 3, oiio.UINT16)
    spec.channelnames = ("I", "I2", "I3")  # as OpenImageIO calls those of ImageMagick's Cineon
    assert color_channels(Path("a.cin"), spec) == [0, 1, 2]


def test_a_mended_jpeg_that_is_none_is_told_by_no_name_but_its_own(tmp_path: Path) -> None:
    (tmp_path / "a.jpg").write_bytes(b"\xff\xd8junk")
    with pytest.raises(PhotoError) as told:
        read_photo(tmp_path / "a.jpg")
    assert str(told.value).count("/") == str(tmp_path / "a.jpg").count("/")


class TestNotesOnTheTerminal:
    """What was mended or chosen is told wherever a photo is read, whatever comes of it."""

    @pytest.fixture
    def stray(self, tmp_path: Path) -> Path:
        (tmp_path / "a.jpg").write_bytes(JPEG[:20] + b"\x01\x02\x03" + JPEG[20:])
        return tmp_path / "a.jpg"

    @pytest.mark.parametrize("command", ["calibrate", "linearize"])
    def test_beside_a_refusal(self, facecrf, stray: Path, tmp_path: Path, command: str) -> None:
        ended = facecrf(command, stray, "-o", tmp_path / "out")
        refusal, note = ended.err.splitlines()
        assert "not calibrated" in refusal
        assert note.startswith("  note: 3 stray bytes")
        assert ended.code == 4

    def test_of_a_photo_sent_through_a_lut(self, facecrf, stray: Path, tmp_path: Path) -> None:
        lut = write_spi1d(tmp_path / "a.spi1d")
        ended = facecrf("apply", stray, "--lut", lut, "-o", tmp_path / "a.exr")
        assert "\n  note: 3 stray bytes" in ended.out


def write_bmp(path: Path, codes: np.ndarray, masks: tuple[int, ...], header: int) -> Path:
    """A BMP of 32 bits a pixel with its channels at those of the masks."""
    height, width = codes.shape[:2]
    values = np.zeros((height, width), "<u4")
    for channel, mask in zip(np.moveaxis(codes.astype(np.uint64), 2, 0), masks, strict=False):
        shift, most = (mask & -mask).bit_length() - 1, mask // (mask & -mask)
        values |= (channel * most // 255 << shift).astype("<u4")
    told = struct.pack(f"<{len(masks)}I", *masks)
    about = struct.pack("<IiiHHIIiiII", header, width, height, 1, 32, 3, 0, 0, 0, 0, 0)
    about = (about + told).ljust(header, b"\0")
    start = struct.pack("<IHHI", 14 + len(about) + values.nbytes, 0, 0, 14 + len(about))
    path.write_bytes(b"BM" + start + about + values[::-1].tobytes())
    return path


class TestBmpOf32Bits:
    CODES = random_codes()

    @pytest.mark.parametrize("header", [40, 52, 108, 124])
    def test_as_most_programs_write_it(self, tmp_path: Path, header: int) -> None:
        """The fourth byte is nobody's, and no alpha that would make all of an EXR black."""
        masks = (0xFF0000, 0xFF00, 0xFF)
        photo = read_photo(write_bmp(tmp_path / "a.bmp", self.CODES, masks, header))
        assert np.array_equal(np.rint(255 * photo.encoded), self.CODES)
        assert photo.alpha is None
        assert photo.notes == ("its alpha is 0 everywhere, and was set aside",)

    @pytest.mark.parametrize(
        "masks",
        [(0xFF, 0xFF00, 0xFF0000), (0xFF000000, 0xFF0000, 0xFF00), (0x3FF00000, 0xFFC00, 0x3FF)],
    )
    @pytest.mark.parametrize("header", [40, 124])
    def test_another_order_is_told(self, tmp_path: Path, masks, header: int) -> None:
        path = write_bmp(tmp_path / "a.bmp", self.CODES, masks, header)
        with pytest.raises(PhotoError, match=r"channels in an order of its own.*PNG"):
            read_photo(path)


@pytest.mark.parametrize(("alpha", "kept"), [(0, False), (1, True)])
def test_alpha_that_shows_nothing_is_set_aside(tmp_path: Path, alpha: int, kept: bool) -> None:
    codes = np.dstack([random_codes(), np.zeros(random_codes().shape[:2], np.uint8)])
    codes[3, 4, 3] = alpha
    Image.fromarray(codes).save(tmp_path / "a.png")
    photo = read_photo(tmp_path / "a.png")
    assert (photo.alpha is not None) == kept
    assert len(photo.notes) == (not kept)
    assert np.array_equal(np.rint(255 * photo.encoded), codes[..., :3])


def test_a_png_with_a_chunk_that_must_be_known(tmp_path: Path, capfd) -> None:
    (tmp_path / "a.png").write_bytes(with_chunks(chunk(b"ABCD", b"")))
    with pytest.raises(PhotoError, match=r"critical PNG chunk.*ordinary PNG"):
        read_photo(tmp_path / "a.png")
    assert capfd.readouterr().err == ""  # where libpng would write a line of its own


class TestPrimariesOfPng:
    P3 = struct.pack(">8I", 31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000)

    @pytest.mark.parametrize(
        ("chunks", "primaries"),
        [
            ([chunk(b"cHRM", P3)], "Display P3"),
            ([chunk(b"cHRM", P3), chunk(b"sRGB", b"\0")], None),  # PNG, third edition, 4.3
            ([chunk(b"cHRM", P3), chunk(b"cICP", bytes((9, 13, 0, 1)))], "Rec.2020"),
            ([chunk(b"cHRM", bytes(32))], None),
            ([chunk(b"cHRM", P3[:9])], None),
        ],
    )
    def test_by_chromaticities(self, tmp_path: Path, chunks, primaries: str | None) -> None:
        (tmp_path / "a.png").write_bytes(with_chunks(*chunks))
        found = read_photo(tmp_path / "a.png").primaries
        assert (None if found is None else found.name) == primaries


def test_a_profile_of_which_a_segment_is_lost_is_told(tmp_path: Path) -> None:
    part = segment(0xE2, b"ICC_PROFILE\0\x01\x02" + PROFILE[:200])
    (tmp_path / "a.jpg").write_bytes(with_segments(JPEG, part))
    photo = read_photo(tmp_path / "a.jpg")
    assert photo.primaries is None
    assert photo.notes == ("its ICC profile was set aside: it is not whole",)


class TestRadiance:
    """Headers by Ward's description of the format; its pixels are linear light in any case."""

    LIGHT = np.random.default_rng(0).random((12, 16, 3), np.float32)

    def written(self, folder: Path, *lines: str) -> Path:
        whole = cv2.imencode(".hdr", self.LIGHT)[1].tobytes()
        head = "".join(f"{line}\n" for line in lines).encode()
        (folder / "a.hdr").write_bytes(whole.replace(b"FORMAT=", head + b"FORMAT="))
        return folder / "a.hdr"

    @pytest.mark.parametrize(
        ("told", "name"),
        [
            ("0.68 0.32 0.265 0.69 0.15 0.06 0.3127 0.329", "Display P3"),
            (" .640 .330 .290 .600 .150 .060 .3333 .3333", "custom"),  # Radiance's own
            ("nan 0 0 0 0 0 0 0", None),
            ("0.64 0.33 0.29", None),
            ("red", None),
        ],
    )
    def test_its_primaries(self, tmp_path: Path, told: str, name: str | None) -> None:
        photo = read_photo(self.written(tmp_path, f"PRIMARIES={told}"))
        assert (photo.primaries and photo.primaries.name) == name
        assert photo.notes == ()

    @pytest.mark.parametrize(
        ("lines", "note"),
        [
            (["EXPOSURE=2.5", "EXPOSURE= 2"], "its light is 5 times the scene's"),
            (["COLORCORR=1.2 1 0.8"], "red, green and blue are 1.2, 1, 0.8 times"),
            (["GAMMA=2.2"], "GAMMA=2.2: its numbers were taken for light"),
            (["EXPOSURE=4", "EXPOSURE=0.25", "GAMMA=1.0", "COLORCORR=1 1 1"], ""),
            (["EXPOSURE=nan", "EXPOSURE=0", "EXPOSURE=bright", "COLORCORR=-1 1 1", "GAMMA="], ""),
        ],
    )
    def test_what_was_done_to_its_light_is_told(self, tmp_path: Path, lines, note: str) -> None:
        photo = read_photo(self.written(tmp_path, *lines))
        assert photo.scene_linear
        assert photo.encoded == pytest.approx(self.LIGHT[..., ::-1], abs=1 / 128)
        assert (len(photo.notes), note in "".join(photo.notes)) == (bool(note), True)

    def test_one_in_xyz_is_not_read(self, tmp_path: Path) -> None:
        path = self.written(tmp_path)
        path.write_bytes(path.read_bytes().replace(b"rle_rgbe", b"rle_xyze"))
        with pytest.raises(PhotoError, match=r"CIE XYZ.* ra_xyze"):
            read_photo(path)

    def test_old_runs_are_told_from_damage(self, tmp_path: Path) -> None:
        head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 12 +X 16\n"
        row = b"\x80\x40\x20\x80" + b"\1\1\1\x0f"  # a pixel, and that it comes 15 times more
        old, cut = tmp_path / "old.hdr", tmp_path / "cut.hdr"
        old.write_bytes(head + 12 * row)
        cut.write_bytes(head + 100 * row[:4])
        with pytest.raises(PhotoError, match=r"old run-length coding.* ra_xyze"):
            read_photo(old)
        with pytest.raises(PhotoError, match="cut short or damaged"):
            read_photo(cut)
