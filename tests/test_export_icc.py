"""ICC profiles, read by littleCMS (Pillow's) and OpenColorIO."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import PIL
import pytest
from PIL import Image, ImageCms

from facecrf_ocio.color.primaries import known_primaries
from facecrf_ocio.lut.formats.icc import colorants
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.photo.tags.profile import primaries_from_icc
from facecrf_ocio.values import InverseCRF

NODES = np.linspace(0.0, 1.0, 4096)
CURVE = InverseCRF(NODES, np.stack([NODES**2.4, NODES**2.2, NODES**1.8]))
P3 = known_primaries("Display P3", "ICC profile")
# Float, three channels of four bytes: RGB and XYZ, as littleCMS' lcms2.h encodes pixel types.
RGB_FLOAT, XYZ_FLOAT = (1 << 22 | space << 16 | 3 << 3 | 4 for space in (4, 9))

either_version = pytest.mark.parametrize("ending", ["icc", "v4.icc"])


def littlecms() -> ctypes.CDLL:
    """Pillow offers littleCMS for 8 bits only; the library its wheel brings can do floats."""
    folder = Path(PIL.__file__).parent.parent / "pillow.libs"
    found = sorted(folder.glob("liblcms2-*.so*"))
    if not found:
        pytest.skip("this Pillow brings no littleCMS library of its own")
    library = ctypes.CDLL(str(found[0]))
    for name in ("cmsOpenProfileFromMem", "cmsCreateXYZProfile", "cmsCreateTransform"):
        getattr(library, name).restype = ctypes.c_void_p
    return library


def through_littlecms(path: Path, pixels: np.ndarray, intent: int) -> np.ndarray:
    """Return (N, 3) CIE XYZ of the connection space, in floats."""
    library, content = littlecms(), path.read_bytes()
    profile = ctypes.c_void_p(library.cmsOpenProfileFromMem(content, len(content)))
    connection = ctypes.c_void_p(library.cmsCreateXYZProfile())
    transform = ctypes.c_void_p(
        library.cmsCreateTransform(profile, RGB_FLOAT, connection, XYZ_FLOAT, intent, 0)
    )
    assert profile
    assert transform
    given = np.ascontiguousarray(pixels, np.float32)
    found = np.empty_like(given)
    pointers = (ctypes.c_void_p(array.ctypes.data) for array in (given, found))
    library.cmsDoTransform(transform, *pointers, len(given))
    library.cmsDeleteTransform(transform)
    for opened in (profile, connection):
        library.cmsCloseProfile(opened)
    return found.astype(np.float64)


def gray(values: np.ndarray) -> np.ndarray:
    return np.repeat(np.asarray(values)[:, None], 3, axis=1)


@either_version
def test_littlecms_reads_the_profile(ending: str, tmp_path: Path) -> None:
    path = write_lut(CURVE, tmp_path / f"a.{ending}", primaries=P3)
    found = primaries_from_icc(path.read_bytes())
    assert found is not None
    assert found.name == "Display P3"
    ramp = Image.fromarray(np.repeat(np.arange(256, dtype=np.uint8), 3).reshape(16, 16, 3))
    # Back to the same primaries with sRGB's curve, so that the curve alone is seen.
    other = tmp_path / "srgb.icc"
    srgb = np.where(NODES <= 0.04045, NODES / 12.92, ((NODES + 0.055) / 1.055) ** 2.4)
    target = write_lut(InverseCRF(NODES, np.stack([srgb] * 3)), other, primaries=P3)
    transform = ImageCms.buildTransform(str(path), str(target), "RGB", "RGB", 1)
    got = np.asarray(ImageCms.applyTransform(ramp, transform)).reshape(-1, 3)
    linear = CURVE.linearize(gray(np.arange(256) / 255.0))
    expected = np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
    assert np.abs(got[8:] - 255.0 * expected[8:]).max() <= 1.0


@pytest.mark.parametrize("intent", range(4))
def test_version_4_is_exact_in_the_shadows_to_littlecms(intent: int, tmp_path: Path) -> None:
    codes = np.concatenate([np.arange(256) / 255, np.random.default_rng(0).random(5000)])
    codes = np.sort(np.float32(codes)).astype(np.float64)
    linear = CURVE.linearize(gray(codes))
    expected = linear @ colorants(P3).T
    found = {
        ending: through_littlecms(
            write_lut(CURVE, tmp_path / f"a.{ending}", primaries=P3), gray(codes), intent
        )
        for ending in ("icc", "v4.icc")
    }
    np.testing.assert_allclose(found["v4.icc"], expected, rtol=1e-5, atol=1e-12)
    # What the 16 bits of version 2 make of it.
    np.testing.assert_allclose(found["icc"], expected, rtol=0, atol=5e-5)
    dark = np.searchsorted(codes, 2 / 255)
    assert abs(found["icc"][dark, 0] / expected[dark, 0] - 1) > 0.05


def test_version_4_stays_within_its_domain(tmp_path: Path) -> None:
    path = write_lut(CURVE, tmp_path / "a.v4.icc", primaries=P3)
    found = through_littlecms(path, gray(np.array([-1.0, 0.0, 1.0, 2.0])), 1)
    white = colorants(P3).sum(axis=1)
    np.testing.assert_allclose(found, [0 * white, 0 * white, white, white], rtol=0, atol=1e-6)


def test_version_4_has_what_its_standard_asks_for(tmp_path: Path) -> None:
    remark = {"Source": "Zoë 日本.jpg"}
    path = write_lut(CURVE, tmp_path / "a.v4.icc", primaries=P3, provenance=remark)
    profile = ImageCms.ImageCmsProfile(str(path)).profile
    assert profile.version == pytest.approx(4.4)
    assert profile.device_class == "scnr"
    assert profile.profile_description == "Inverse camera response of one photo"
    assert "Zoë 日本.jpg" in (profile.copyright or "")
    assert profile.media_white_point is not None
    # Display P3's white is D65; Bradford's matrix to D50 as ICC publishes it for sRGB.
    published = [
        (1.047882, 0.022918, -0.050217),
        (0.029587, 0.990479, -0.017075),
        (-0.009247, 0.015075, 0.751678),
    ]
    np.testing.assert_allclose(profile.chromatic_adaptation[0], published, atol=2e-4)
    assert path.stat().st_size == int.from_bytes(path.read_bytes()[:4], "big")


def test_the_profile_id_is_the_one_littlecms_computes(tmp_path: Path) -> None:
    content = write_lut(CURVE, tmp_path / "a.v4.icc").read_bytes()
    library = littlecms()
    profile = ctypes.c_void_p(library.cmsOpenProfileFromMem(content, len(content)))
    assert library.cmsMD5computeID(profile)
    computed = (ctypes.c_uint8 * 16)()
    library.cmsGetHeaderProfileID(profile, computed)
    library.cmsCloseProfile(profile)
    assert content[84:100] == bytes(computed)


@either_version
def test_a_curve_can_be_read_by_a_matrix_reader(ending: str, tmp_path: Path) -> None:
    """Readers such as darktable take red, green, blue TRC and colorants, in either version."""
    path = write_lut(CURVE, tmp_path / f"a.{ending}", primaries=P3)
    profile = ImageCms.ImageCmsProfile(str(path)).profile
    assert profile.is_matrix_shaper
    assert not any(uses[0] for uses in profile.clut.values())
    columns = (profile.red_colorant, profile.green_colorant, profile.blue_colorant)
    found = np.array([column[0] for column in columns]).T
    np.testing.assert_allclose(found, colorants(P3), rtol=0, atol=1e-5)
