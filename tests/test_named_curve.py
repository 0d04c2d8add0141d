"""Curves that a file names are used, not estimated."""

from __future__ import annotations

import struct
import zlib
from functools import partial
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from photo_files import matrix_profile, random_codes
from PIL import Image

from facecrf_ocio import calibrate, read_photo
from facecrf_ocio.color.signals import decode_film_scan, decode_hlg, decode_log, decode_pq
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.image.linearize import write_linear
from facecrf_ocio.photo.tags.named_curve import curve_of_profile, curve_of_scan
from facecrf_ocio.values import Outcome, Verdict

PROFILE = matrix_profile((0.64, 0.33), (0.3, 0.6), (0.15, 0.06), (0.3127, 0.329))


def with_curve(curve: bytes) -> bytes:
    """The profile with another curve for all channels, at its end."""
    result = bytearray(PROFILE)
    for name in (b"rTRC", b"gTRC", b"bTRC"):
        struct.pack_into(">II", result, PROFILE.index(name, 128) + 4, len(PROFILE), len(curve))
    result += curve
    struct.pack_into(">I", result, 0, len(result))
    return bytes(result)


def formula(kind: int, *numbers: float) -> bytes:
    fixed = (round(number * 65536) for number in numbers)
    return b"para\0\0\0\0" + struct.pack(f">HH{len(numbers)}i", kind, 0, *fixed)


def table(light: np.ndarray) -> bytes:
    return (
        b"curv\0\0\0\0"
        + struct.pack(">I", light.size)
        + np.rint(light * 65535).astype(">u2").tobytes()
    )


GRID = np.linspace(0, 1, 1024)


@pytest.mark.parametrize(
    ("curve", "name"),
    [
        (formula(0, 1), "linear"),
        (formula(1, 1, 1, 0), "linear"),
        (formula(2, 1, 1, 0, 0), "linear"),
        (formula(3, 1, 1, 0, 1, 0), "linear"),
        (formula(3, 2.4, 0.9, 0.1, 1, 1.5), "linear"),  # the line goes beyond white
        (formula(4, 1, 1, 0, 1, 0.5, 0, 0), "linear"),
        (formula(0, 2.2), ""),
        (formula(3, 2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045), ""),
        (formula(9, 1), ""),
        (formula(4, 1, 1)[:14], ""),
        (table(GRID), "linear"),
        (table(decode_pq(GRID)), "PQ"),
        (table(decode_hlg(GRID)), "HLG"),
        (table(GRID**2.2), ""),
        (table(GRID)[:500], ""),
        (table(GRID)[:501], ""),  # half a sample
    ],
)
def test_curves_of_profiles(curve: bytes, name: str) -> None:
    assert curve_of_profile(with_curve(curve)) == name


@pytest.mark.parametrize("name", ["PQ", "HLG"])
def test_the_curves_are_opencolorios(name: str) -> None:
    style = {"PQ": "CURVE - ST-2084_to_LINEAR", "HLG": "CURVE - HLG-OETF-INVERSE"}[name]
    transform = ocio.BuiltinTransform(style)
    cpu = ocio.Config.CreateRaw().getProcessor(transform).getDefaultCPUProcessor()
    pixels = np.repeat(np.linspace(0, 1, 65, dtype=np.float32)[:, None], 3, axis=1)
    ours = {"PQ": decode_pq, "HLG": decode_hlg}[name](pixels[:, 0])
    cpu.applyRGB(pixels)
    theirs = pixels[:, 0]
    assert ours == pytest.approx(theirs / theirs[-1], rel=2e-3, abs=1e-6)


def test_the_log_of_film_scans_is_opencolorios_and_kodaks() -> None:
    black = 10.0 ** ((95 - 685) / 300)
    transform = ocio.LogAffineTransform(
        logSideSlope=[300 / 1023] * 3,
        logSideOffset=[685 / 1023] * 3,
        linSideSlope=[1 - black] * 3,
        linSideOffset=[black] * 3,
        direction=ocio.TRANSFORM_DIR_INVERSE,
    )
    transform.setBase(10.0)
    cpu = ocio.Config.CreateRaw().getProcessor(transform).getDefaultCPUProcessor()
    codes = np.arange(1024)
    pixels = np.repeat((codes / 1023).astype(np.float32)[:, None], 3, axis=1)
    cpu.applyRGB(pixels)
    light = decode_film_scan(codes / 1023)
    to_white = light / light[685]
    assert to_white[95:] == pytest.approx(pixels[95:, 0], rel=1e-3, abs=1e-5)
    assert not light[:96].any()
    assert light[-1] == 1.0
    assert to_white[470] == pytest.approx(0.18, abs=0.005)  # Kodak's gray card


def dpx(path: Path, transfer: int) -> Path:
    """Ten bits, with a code of SMPTE ST 268-1 for what they are."""
    codes = random_codes().astype(np.uint16) * np.uint16(257)
    spec = oiio.ImageSpec(codes.shape[1], codes.shape[0], 3, oiio.UINT16)
    spec.attribute("oiio:BitsPerSample", 10)
    output = oiio.ImageOutput.create(str(path))
    output.open(str(path), spec)
    output.write_image(codes)
    output.close()
    content = bytearray(path.read_bytes())
    content[801] = transfer  # of the first channel
    path.write_bytes(content)
    return path


@pytest.mark.parametrize(
    ("transfer", "name"), [(1, "Cineon log"), (3, "Cineon log"), (2, ""), (4, ""), (6, "")]
)
def test_a_dpx_says_that_it_is_a_film_scan(tmp_path: Path, transfer: int, name: str) -> None:
    photo = read_photo(dpx(tmp_path / "a.dpx", transfer))
    assert photo.named_curve == name
    if name:
        estimate = calibrate(photo)
        assert estimate.outcome is Outcome.NAMED
        codes = np.arange(0, 1024) / 1023
        found = estimate.curve.linearize(np.repeat(codes[:, None], 3, axis=1))
        assert found[:, 0] == pytest.approx(decode_film_scan(codes), rel=2e-3, abs=1e-5)


def test_a_cineon_file_is_a_film_scan() -> None:
    assert curve_of_scan("cineon", "") == "Cineon log"
    assert curve_of_scan("tiff", "Logarithmic") == ""


def with_cicp(
    path: Path, primaries: int, transfer: int, icc: bytes | None = None, full: int = 1
) -> Path:
    Image.fromarray(random_codes()).save(path, icc_profile=icc)
    content = path.read_bytes()
    chunk = b"cICP" + bytes([primaries, transfer, 0, full])
    chunk = struct.pack(">I", 4) + chunk + struct.pack(">I", zlib.crc32(chunk))
    path.write_bytes(content[:33] + chunk + content[33:])
    return path


@pytest.mark.parametrize(
    ("transfer", "name", "decode"),
    [
        (9, "log 100:1", partial(decode_log, decades=2.0)),
        (16, "PQ", decode_pq),
        (18, "HLG", decode_hlg),
    ],
)
def test_a_png_says_which_signal_it_holds(tmp_path: Path, transfer: int, name: str, decode) -> None:
    # cICP goes before the profile.
    photo = read_photo(with_cicp(tmp_path / "a.png", 9, transfer, with_curve(formula(0, 1))))
    assert (photo.named_curve, photo.scene_linear) == (name, False)
    for estimator in ("auto", "face"):
        estimate = calibrate(photo, estimator=estimator)
        assert estimate.outcome is Outcome.NAMED
        assert name in estimate.reason
        assert estimate.confidence is not None
        assert estimate.confidence.verdict is Verdict.WEAK
        codes = np.arange(16, 256) / 255
        found = estimate.curve.linearize(np.repeat(codes[:, None], 3, axis=1))
        assert found[:, 0] == pytest.approx(decode(codes), rel=2e-3)
    exr = write_linear(tmp_path / "a.exr", photo, estimate).path
    assert oiio.ImageBuf(str(exr)).spec().get_string_attribute("colorInteropID") == "unknown"


@pytest.mark.parametrize(("number", "name"), [(1, "Rec.709"), (9, "Rec.2020"), (12, "Display P3")])
def test_a_png_says_its_primaries(tmp_path: Path, number: int, name: str) -> None:
    primaries = read_photo(with_cicp(tmp_path / "a.png", number, 13)).primaries
    assert primaries is not None
    assert primaries.name == name


def test_the_narrow_range_of_video_is_refused(tmp_path: Path) -> None:
    path = with_cicp(tmp_path / "a.png", 9, 16, full=0)
    with pytest.raises(PhotoError, match="narrow range; export it"):
        read_photo(path)


def test_a_fixed_curve_that_is_asked_for_is_given(tmp_path: Path) -> None:
    photo = read_photo(with_cicp(tmp_path / "a.png", 9, 16))
    assert calibrate(photo, estimator="srgb").outcome is Outcome.FALLBACK


def test_linear_integers(tmp_path: Path) -> None:
    assert read_photo(with_cicp(tmp_path / "a.png", 1, 8)).scene_linear
    Image.fromarray(random_codes()).save(
        tmp_path / "b.png", icc_profile=with_curve(formula(2, 1, 1, 0, 0))
    )
    assert read_photo(tmp_path / "b.png").scene_linear
