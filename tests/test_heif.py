"""HEIC and AVIF, which phones write."""

from __future__ import annotations

import builtins
import struct
from pathlib import Path

import numpy as np
import pytest
from photo_files import exif_of, matrix_profile
from PIL import Image, features

from facecrf_ocio import read_photo
from facecrf_ocio.color.primaries import KNOWN_PRIMARIES
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.tags.exif import apple_headroom, load_exif

CODES = np.clip(
    (np.indices((64, 96)).sum(axis=0)[..., None] * 6.0) * (1.0, 0.8, 0.6), 0, 1023
).astype(np.uint16)


def write_heic(path: Path, codes: np.ndarray = CODES, **options: object) -> Path:
    pillow_heif = pytest.importorskip("pillow_heif")
    mode, data = "RGB;16", (codes * 64).astype(np.uint16)
    if codes.dtype == np.uint8:
        mode, data = "RGB", codes
    heif = pillow_heif.from_bytes(mode, codes.shape[1::-1], data.tobytes())
    try:
        heif.save(path, quality=-1, chroma=444, matrix_coefficients=0, **options)
    except RuntimeError as error:
        pytest.skip(f"no HEVC encoder: {error}")
    return path


def test_ten_bits(tmp_path: Path) -> None:
    photo = read_photo(write_heic(tmp_path / "a.heic"))
    assert photo.bit_depth == 10
    assert not photo.scene_linear
    assert np.abs(photo.encoded * 1023 - CODES).max() <= 1


def test_eight_bits_camera_and_profile(tmp_path: Path) -> None:
    codes = (CODES // 4).astype(np.uint8)
    exif = b"Exif\0\0" + exif_of({271: b"Acme\0", 272: b"Phone\xe9\0", 274: 6})
    profile = matrix_profile(*KNOWN_PRIMARIES["Display P3"])
    # Content before suffix; and EXIF's orientation, which repeats the file's boxes, turns nothing.
    path = write_heic(tmp_path / "a.jpg.heic", codes, exif=exif, icc_profile=profile)
    path = path.rename(tmp_path / "a.jpg")
    photo = read_photo(path)
    assert photo.bit_depth == 8
    assert photo.primaries is not None
    assert photo.primaries.name == "Display P3"
    assert (photo.camera.make, photo.camera.model) == ("Acme", "Phoneé")
    assert {photo.encoded.shape[:2]} <= {(64, 96), (96, 64)}


def test_a_damaged_heic(tmp_path: Path) -> None:
    path = write_heic(tmp_path / "a.heic")
    path.write_bytes(path.read_bytes()[:-300])
    with pytest.raises(PhotoError, match="cut short or damaged"):
        read_photo(path)


def test_a_heic_whose_image_has_no_decoder(tmp_path: Path) -> None:
    path = write_heic(tmp_path / "a.heic")
    path.write_bytes(path.read_bytes().replace(b"hvcC", b"hvcN"))
    with pytest.raises(PhotoError, match="cut short or damaged"):
        read_photo(path)


def test_without_the_extra_one_line_names_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.heic"
    path.write_bytes(b"\0\0\0\x1cftypheic" + bytes(100))
    really = builtins.__import__

    def without(name: str, *rest: object, **named: object) -> object:
        if name == "pillow_heif":
            raise ImportError(name)
        return really(name, *rest, **named)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(PhotoError, match=r"needs pillow-heif; install .*facecrf-ocio\[heif\]"):
        read_photo(path)


@pytest.mark.parametrize(
    ("transfer", "curve", "linear"),
    [(8, "", True), (13, "", False), (16, "PQ", False), (18, "HLG", False)],
)
def test_heic_says_which_signal_it_holds(
    tmp_path: Path, transfer: int, curve: str, linear: bool
) -> None:
    """As cameras do that write HDR stills (.HIF): PQ by Canon, HLG by Sony."""
    said = {"color_primaries": 9, "transfer_characteristics": transfer, "save_nclx_profile": True}
    photo = read_photo(write_heic(tmp_path / "a.hif", **said))
    assert (photo.named_curve, photo.scene_linear) == (curve, linear)
    assert photo.primaries is not None
    assert photo.primaries.name == "Rec.2020"
    profile = matrix_profile(*KNOWN_PRIMARIES["Display P3"])
    by_profile = read_photo(write_heic(tmp_path / "b.hif", icc_profile=profile, **said))
    assert by_profile.named_curve == ""


@pytest.mark.skipif(not features.check("avif"), reason="this Pillow reads no AVIF")
@pytest.mark.parametrize(("transfer", "said"), [(8, ""), (13, ""), (16, "PQ"), (18, "HLG")])
def test_avif_says_which_signal_it_holds(tmp_path: Path, transfer: int, said: str) -> None:
    path = tmp_path / "a.avif"
    Image.fromarray((CODES // 4).astype(np.uint8)).save(path)
    content = bytearray(path.read_bytes())
    at = content.find(b"colrnclx") + 8
    content[at : at + 4] = struct.pack(">HH", 9, transfer)
    path.write_bytes(bytes(content))
    photo = read_photo(path)
    assert (photo.named_curve, photo.scene_linear) == (said, transfer == 8)
    assert photo.primaries is not None
    assert photo.primaries.name == "Rec.2020"


@pytest.mark.skipif(not features.check("avif"), reason="this Pillow reads no AVIF")
def test_avif(tmp_path: Path) -> None:
    codes = (CODES // 4).astype(np.uint8)
    image = Image.fromarray(codes)
    exif = Image.Exif()
    exif[271], exif[274] = "Acme", 6
    image.save(tmp_path / "a.avif", quality=100, subsampling="4:4:4", exif=exif)
    photo = read_photo(tmp_path / "a.avif")
    assert photo.camera.make == "Acme"
    assert np.abs(photo.encoded * 255 - np.rot90(codes, -1)).mean() < 2
    (tmp_path / "b.avif").write_bytes((tmp_path / "a.avif").read_bytes()[:-200])
    with pytest.raises(PhotoError, match="cut short or damaged"):
        read_photo(tmp_path / "b.avif")


def apple_exif(**told: float) -> bytes:
    """EXIF whose maker notes hold fractions by their tags; they stand behind the directory."""
    behind = 14 + 2 + 12 * len(told)
    notes = b"Apple iOS\0\0\x01MM" + struct.pack(">H", len(told))
    for number, name in enumerate(told):
        notes += struct.pack(">HHII", int(name[1:]), 10, 1, behind + 8 * number)
    notes += b"".join(struct.pack(">ii", round(value * 1e4), 10000) for value in told.values())
    within = struct.pack("<HHHII", 1, 0x927C, 7, len(notes), 26 + 18) + bytes(4)
    content = b"II*\0" + struct.pack("<I", 8) + struct.pack("<HHHII", 1, 0x8769, 4, 1, 26)
    return content + bytes(4) + within + notes


@pytest.mark.parametrize(
    ("told", "stops"),
    [
        ({"_33": 0.5, "_48": 0.0}, 1.8),
        ({"_33": 0.5, "_48": 1.0}, 1.5),
        ({"_33": 1.0, "_48": 0.0}, 3.0),
        ({"_33": 1.5, "_48": 1.0}, 2.0),
        ({"_33": 0.5, "_48": 0.005}, 1.7),
        ({"_33": 0.88}, 1.8),
        ({"_48": 1.0}, 1.5),
    ],
)
def test_how_bright_an_iphone_makes_white(told: dict[str, float], stops: float) -> None:
    # Apple, "Applying Apple HDR effect to your photos".
    assert apple_headroom(load_exif(apple_exif(**told))) == pytest.approx(2**stops, rel=1e-3)
    assert apple_headroom(load_exif(apple_exif(_34=1.0))) == 0
    assert apple_headroom(load_exif(b"no EXIF")) == 0
