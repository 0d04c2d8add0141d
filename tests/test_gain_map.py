"""Photos with gain maps: the encoded picture is the photo, the map gives the HDR rendition."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from click.testing import CliRunner
from gain_map_files import iso_numbers, jpeg, ultra_hdr_numbers, with_gain_map, xmp
from photo_files import app1, exif_of, matrix_profile, segment, with_segments

from facecrf_ocio import Photo, read_photo
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.color.primaries import KNOWN_PRIMARIES
from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.image.hdr_rendition import exact_base, hdr_rows, write_rendition
from facecrf_ocio.photo.decoding.gain_map import APPLE
from facecrf_ocio.photo.decoding.orientation import upright
from facecrf_ocio.values import GainMap

Y, X = np.mgrid[:96, :128]
BASE = np.clip(np.stack([40 + X, 60 + Y, 220 - X], axis=2), 0, 255).astype(np.uint8)
VALUES = np.clip(np.hypot(X - 64, Y - 48) * 3, 0, 255).astype(np.uint8)
NUMBERS = (-0.5, 2.5, 0.8, 0.02, 0.01)
XMP = ultra_hdr_numbers(GainMapMin=-0.5, GainMapMax=2.5, Gamma=0.8, OffsetSDR=0.02, OffsetHDR=0.01)


def write(path: Path, numbers: bytes = XMP, values: np.ndarray = VALUES, base=BASE) -> Path:
    path.write_bytes(with_gain_map(base, values, numbers))
    return path


def rendition(photo: Photo) -> np.ndarray:
    assert photo.gain_map is not None
    exact = exact_base(photo, photo.gain_map)
    return hdr_rows(exact, photo.gain_map, 0, photo.encoded.shape[0])


def of_libultrahdr(path: Path) -> np.ndarray:
    """(H, W, 3) light, turned as the file says."""
    image = oiio.ImageBuf(str(path))
    if str(image.spec().format) != "half":
        pytest.skip("this OpenImageIO was built without libultrahdr")
    turned = upright(image.get_pixels(oiio.FLOAT)[..., :3], read_photo(path).gain_map.orientation)
    return np.asarray(turned)


def error_of(path: Path) -> np.ndarray:
    """Relative error, below 0.02 % of white against that, where half floats end."""
    expected = of_libultrahdr(path)
    return np.abs(rendition(read_photo(path)) - expected) / np.maximum(expected, 2e-4)


@pytest.mark.parametrize(
    "numbers", [XMP, iso_numbers([NUMBERS]), iso_numbers([NUMBERS] * 3)], ids=["xmp", "1", "3"]
)
@pytest.mark.parametrize("coarser", [1, 2, 4])
def test_the_rendition_is_that_of_libultrahdr(tmp_path: Path, numbers: bytes, coarser: int) -> None:
    path = write(tmp_path / "a.jpg", numbers, VALUES[::coarser, ::coarser].copy())
    assert error_of(path).max() < 0.01


@pytest.mark.parametrize("coarser", [1, 2, 3, 4])
@pytest.mark.parametrize("channels", [1, 3])
def test_offsets_that_leave_little_light(tmp_path: Path, coarser: int, channels: int) -> None:
    """A program's numbers: of dark places nearly all light is taken off again."""
    numbers = [(0.03, 3.5, 0.34, 0.2256, 0.2256), (0.0, 3.1, 0.36, 0.2256, 0.2256)]
    values = np.stack([VALUES, VALUES[::-1], VALUES.T.repeat(2, axis=1)[:96, :128]], axis=2)
    values = values if channels == 3 else VALUES
    dark = np.minimum(BASE, np.hypot(X - 64, Y - 48)[..., None]).astype(np.uint8)
    said = iso_numbers([numbers[0]] * channels if channels == 1 else [*numbers, numbers[0]])
    path = write(tmp_path / "a.jpg", said, values[::coarser, ::coarser].copy(), dark)
    assert rendition(read_photo(path)).min() < 0.005
    assert error_of(path).max() < 0.01


@pytest.mark.parametrize("width", [127, 128])
@pytest.mark.parametrize("sampling", ["4:2:0", "4:2:2"])
def test_halved_color_differences_stand_for_two_or_four_pixels_each(
    tmp_path: Path, sampling: str, width: int
) -> None:
    colorful = np.random.default_rng(0).integers(30, 220, (12, 16, 3)).astype(np.uint8)
    base = colorful.repeat(8, axis=0).repeat(8, axis=1)[:95, :width].copy()
    path = tmp_path / "a.jpg"
    path.write_bytes(with_gain_map(base, VALUES[:95, :width].copy(), XMP, sampling=sampling))
    assert error_of(path).max() < 0.01


@pytest.mark.parametrize("orientation", range(1, 9))
def test_a_coarser_map_begins_where_the_file_does(tmp_path: Path, orientation: int) -> None:
    content = with_gain_map(BASE, VALUES[::4, ::4].copy(), XMP)
    path = tmp_path / "a.jpg"
    path.write_bytes(with_segments(content, app1(exif_of({274: orientation}))))
    assert error_of(path).max() < 0.01


@pytest.mark.parametrize("size", [(95, 127), (93, 125), (96, 125)])
def test_sizes_that_are_no_multiple_of_the_map(tmp_path: Path, size: tuple[int, int]) -> None:
    base = BASE[: size[0], : size[1]].copy()
    values = cv2.resize(VALUES, (size[1] // 4, size[0] // 4), interpolation=cv2.INTER_AREA)
    assert error_of(write(tmp_path / "a.jpg", XMP, values, base)).max() < 0.01


def test_a_map_that_ends_a_row_early(tmp_path: Path) -> None:
    base, values = np.tile(BASE, (3, 2, 1))[:193], np.tile(VALUES, (2, 2))[::4, ::4]
    assert error_of(write(tmp_path / "a.jpg", XMP, values.copy(), base)).max() < 0.01


@pytest.mark.parametrize(
    "numbers",
    [XMP, iso_numbers([NUMBERS]), iso_numbers([NUMBERS], base_space=False)],
    ids=["xmp", "base", "map"],
)
@pytest.mark.parametrize(
    ("base", "map_"), [("Display P3", "Rec.709"), ("Rec.709", "Display P3"), ("Rec.2020", "")]
)
def test_the_maps_profile_tells_the_space_of_the_rendition(
    tmp_path: Path, numbers: bytes, base: str, map_: str
) -> None:
    profiles = [matrix_profile(*KNOWN_PRIMARIES[name]) if name else b"" for name in (base, map_)]
    path = tmp_path / "a.jpg"
    path.write_bytes(
        with_gain_map(BASE, VALUES, numbers, base_icc=profiles[0], map_icc=profiles[1])
    )
    expected = of_libultrahdr(path)
    away = np.abs(rendition(read_photo(path)) - expected).max(axis=2) / expected.max(axis=2)
    assert away.max() < 0.01  # of the brightest channel: a matrix leaves little of others
    spec = oiio.ImageBuf(str(write_rendition(tmp_path / "a.exr", read_photo(path)).path)).spec()
    red, *_ = KNOWN_PRIMARIES[map_ or base]
    assert spec.getattribute("chromaticities")[:2] == pytest.approx(red, abs=1e-3)


def test_the_photo_is_the_encoded_picture(tmp_path: Path) -> None:
    photo = read_photo(write(tmp_path / "a.jpg"))
    assert photo.bit_depth == 8
    assert not photo.scene_linear
    assert photo.notes == ()
    assert np.abs(photo.encoded * 255 - BASE).max() < 4  # quality 100


def test_numbers_a_channel_are_kept_apart(tmp_path: Path) -> None:
    xmp_said = ultra_hdr_numbers(GainMapMin=[-1, 0, 1], GainMapMax=[2, 3, 4], Gamma=[1, 2, 0.5])
    iso_said = iso_numbers([(-1, 2, 1, 0, 0), (0, 3, 2, 0, 0), (1, 4, 0.5, 0, 0)], common=True)
    for numbers in (xmp_said, iso_said):
        found = read_photo(write(tmp_path / "a.jpg", numbers)).gain_map
        assert found is not None
        assert (*found.low, *found.high, *found.gamma) == (-1, 0, 1, 2, 3, 4, 1, 2, 0.5)


def test_the_map_is_turned_with_the_photo(tmp_path: Path) -> None:
    content = with_gain_map(BASE, VALUES, XMP)
    (tmp_path / "a.jpg").write_bytes(content)
    (tmp_path / "b.jpg").write_bytes(with_segments(content, app1(exif_of({274: 6}))))
    plain, turned = read_photo(tmp_path / "a.jpg"), read_photo(tmp_path / "b.jpg")
    assert np.allclose(rendition(turned), np.rot90(rendition(plain), -1), rtol=1e-5)


def test_apples_map(tmp_path: Path) -> None:
    said = xmp(
        f'apdi:AuxiliaryImageType="{APPLE}" HDRGainMap:HDRGainMapVersion="65536" '
        'HDRGainMap:HDRGainMapHeadroom="4"'
    )
    photo = read_photo(write(tmp_path / "a.jpg", said, np.full_like(VALUES, 255)))
    assert photo.gain_map is not None
    assert photo.gain_map.standard == "Apple"
    exact = exact_base(photo, photo.gain_map)
    assert np.allclose(rendition(photo), 4 * decode_srgb(exact.encoded), rtol=1e-4)


def test_the_exact_picture_is_the_photo_before_it_is_rounded(tmp_path: Path) -> None:
    content = with_segments(with_gain_map(BASE, VALUES, XMP), app1(exif_of({274: 6})))
    (tmp_path / "a.jpg").write_bytes(content)
    photo = read_photo(tmp_path / "a.jpg")
    assert photo.gain_map is not None
    exact = exact_base(photo, photo.gain_map).encoded
    assert exact.shape == photo.encoded.shape == (128, 96, 3)
    away = np.abs(exact - photo.encoded) * 255
    assert 0.4 < away.max() < 0.6
    assert exact_base(photo, replace(photo.gain_map, base=b"no JPEG")) is photo


def fraction_by_zero() -> bytes:
    said = struct.pack(">HHB", 0, 0, 0x40) + struct.pack(">IIII", 0, 1, 3, 1) + bytes(40)
    return segment(0xE2, b"urn:iso:std:iso:ts:21496:-1\0" + said)


@pytest.mark.parametrize(
    ("numbers", "why"),
    [
        (ultra_hdr_numbers(GainMapMax="much"), "could not convert"),
        (ultra_hdr_numbers(GainMapMax="nan"), "make no sense"),
        (ultra_hdr_numbers(GainMapMax=400), "make no sense"),
        (ultra_hdr_numbers(GainMapMax=2, Gamma=0), "make no sense"),
        (ultra_hdr_numbers(GainMapMax=2, GainMapMin=3), "make no sense"),
        (ultra_hdr_numbers(GainMapMax=2, OffsetSDR=-1), "make no sense"),
        (ultra_hdr_numbers(GainMapMax=2, OffsetHDR=1e9), "leaves nothing of the light"),
        (ultra_hdr_numbers(GainMapMax=2, OffsetSDR=1e9), "make no sense"),
        (ultra_hdr_numbers(GainMapMax=[1, 2]), "2 numbers"),
        (ultra_hdr_numbers(GainMapMax=2, BaseRenditionIsHDR="True"), "itself is the HDR"),
        (iso_numbers([NUMBERS])[:-20], ""),
        (segment(0xE2, b"urn:iso:std:iso:ts:21496:-1\0" + bytes(4) + b"\x40\0"), "cut short"),
        (fraction_by_zero(), "make no sense"),
        (ultra_hdr_numbers(), "does not say how far it brightens"),
        (xmp(f'apdi:AuxiliaryImageType="{APPLE}"'), "how bright"),
    ],
)
def test_a_map_of_no_use_is_set_aside(tmp_path: Path, numbers: bytes, why: str) -> None:
    photo = read_photo(write(tmp_path / "a.jpg", numbers))
    assert photo.gain_map is None
    if why:
        assert "its gain map was set aside" in photo.notes[0]
        assert why in photo.notes[0]
    with pytest.raises(SettingsError, match="no gain map"):
        write_rendition(tmp_path / "a.exr", photo)


def test_a_damaged_list_of_pictures_costs_nothing(
    tmp_path: Path, recwarn: pytest.WarningsRecorder
) -> None:
    """The list (MPF) is left aside; Pillow warns of it, in lines of its own."""
    path = write(tmp_path / "a.jpg", ultra_hdr_numbers(GainMapMax=2))
    content = path.read_bytes()
    at = content.index(b"MPF\0") + 20
    path.write_bytes(content[:at] + b"\xff\xff\xff\x7f" + content[at + 4 :])
    write_rendition(tmp_path / "a.exr", read_photo(path))
    assert not recwarn.list


def test_a_map_that_is_cut_short_is_set_aside(tmp_path: Path) -> None:
    """Its decoder would fill what is missing with gray, and the rendition with light of no one."""
    path = write(tmp_path / "a.jpg", ultra_hdr_numbers(GainMapMax=2))
    path.write_bytes(path.read_bytes()[:-40])
    photo = read_photo(path)
    assert photo.gain_map is None
    assert photo.notes == ("its gain map was set aside: it is cut short",)


def test_a_map_that_is_announced_and_missing_is_told(tmp_path: Path) -> None:
    path = write(tmp_path / "a.jpg", ultra_hdr_numbers(GainMapMax=2))
    path.write_bytes(path.read_bytes().partition(b"\xff\xd9")[0] + b"\xff\xd9")
    photo = read_photo(path)
    assert photo.gain_map is None
    assert "the gain map that it announces is missing" in " ".join(photo.notes)


@pytest.mark.parametrize(
    "between",
    [b"", bytes(700), jpeg(BASE[::2, ::2].copy())],
    ids=["nothing", "padding", "a preview"],
)
def test_a_map_that_nothing_announces_is_found(tmp_path: Path, between: bytes) -> None:
    """ISO 21496-1 alone: no XMP, no directory of pictures."""
    path = tmp_path / "a.jpg"
    path.write_bytes(jpeg(BASE) + between + with_segments(jpeg(BASE), iso_numbers([NUMBERS])))
    found = read_photo(path).gain_map
    assert found is not None
    assert found.standard == "ISO 21496-1"


def test_any_prefix_of_the_namespace(tmp_path: Path) -> None:
    said = XMP.replace(b"hdrgm:", b"gains:").replace(b"xmlns:hdrgm", b"xmlns:gains")
    photo = read_photo(write(tmp_path / "a.jpg", said))
    assert photo.gain_map is not None
    assert photo.gain_map.high == pytest.approx(2.5)


def test_a_second_picture_that_is_no_map(tmp_path: Path) -> None:
    (tmp_path / "a.jpg").write_bytes(jpeg(BASE) + jpeg(BASE))
    photo = read_photo(tmp_path / "a.jpg")
    assert photo.gain_map is None
    assert photo.notes == ()


def test_a_gain_map_needs_sound_numbers() -> None:
    zero, one = np.zeros(3), np.ones(3)
    with pytest.raises(SettingsError, match="finite"):
        GainMap(np.zeros((2, 2, 3), np.float32), zero, one * np.nan, one, zero, zero, "Apple")


class TestLinearize:
    @staticmethod
    def run(path: Path, *options: str) -> tuple[int, str]:
        exr = path.with_suffix(".exr")
        result = CliRunner().invoke(main, ["linearize", str(path), "-o", str(exr), *options])
        return result.exit_code, result.output

    @pytest.mark.parametrize("options", [(), ("--hdr", "map"), ("--float",)])
    def test_by_the_map(self, tmp_path: Path, options: tuple[str, ...]) -> None:
        path = write(tmp_path / "a.jpg")
        code, said = self.run(path, *options)
        assert code == 0
        assert "by its gain map (Ultra HDR, 2.5 stops of headroom)" in said
        image = oiio.ImageBuf(str(tmp_path / "a.exr"))
        assert image.get_pixels(oiio.FLOAT) == pytest.approx(rendition(read_photo(path)), rel=1e-3)
        assert image.get_pixels(oiio.FLOAT).max() > 2
        spec = image.spec()
        assert spec.get_string_attribute("colorInteropID") == "unknown"
        assert "not proven scene light" in spec.get_string_attribute("facecrf:hdr")

    def test_by_the_curve(self, tmp_path: Path) -> None:
        path = write(tmp_path / "a.jpg")
        code, _ = self.run(path, "--hdr", "curve", "--estimator", "srgb")
        assert code == 0
        pixels = oiio.ImageBuf(str(tmp_path / "a.exr")).get_pixels(oiio.FLOAT)
        assert pixels == pytest.approx(decode_srgb(read_photo(path).encoded), abs=2e-3)

    def test_no_map_to_go_by(self, tmp_path: Path) -> None:
        (tmp_path / "a.jpg").write_bytes(jpeg(BASE))
        code, said = self.run(tmp_path / "a.jpg", "--hdr", "map")
        assert code == 2
        assert "has no gain map" in said
        code, said = self.run(tmp_path / "a.jpg", "--hdr", "map", "--to", "acescg")
        assert code == 2


@pytest.mark.slow
def test_real_gain_maps(development_data: Path) -> None:
    folder = development_data / "gainmap"
    if not folder.is_dir():
        pytest.skip("there are no photos with gain maps in the development data")
    paths = sorted(folder.glob("*.jpg"))
    assert paths
    for path in paths:
        photo = read_photo(path)
        assert photo.gain_map is not None, path.name
        assert photo.notes == ()
        image = oiio.ImageInput.open(str(path))
        if str(image.spec().format) != "half":
            continue
        expected = image.read_scanlines(0, 0, 0, 512, 0, 0, 3, oiio.FLOAT)
        rows = hdr_rows(exact_base(photo, photo.gain_map), photo.gain_map, 0, 512)
        error = np.abs(rows - expected.reshape(rows.shape)) / np.maximum(rows, 2e-4)
        assert np.mean(error < 0.01) > 0.9999, path.name
