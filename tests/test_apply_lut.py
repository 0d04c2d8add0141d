"""`apply --lut` does what the LUT file says, or refuses; and says where it led."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from command_line import CommandLine
from lut_files import (
    CURVE,
    LOG_TO_INFINITY,
    MIXES,
    REC709_TO_AP1,
    half_floats,
    matrix,
    through_ocio,
    write_clf,
    write_half_domain,
)
from photo_files import GRID, matrix_profile, pixels_of, random_codes, write
from PIL import Image

from facecrf_ocio import read_photo
from facecrf_ocio.color.primaries import KNOWN_PRIMARIES
from facecrf_ocio.errors import LutError, SettingsError
from facecrf_ocio.image.apply import apply_lut
from facecrf_ocio.image.lut_lookup import lut_lookup, lut_processor
from facecrf_ocio.lut.usable import why_unusable
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.values import InverseCRF, Photo

GAMMA = InverseCRF(GRID, np.stack([GRID**2.2] * 3))
RAMP = np.repeat(np.linspace(0, 1, 33, dtype=np.float32)[None, :, None], 3, axis=2)


def tag_of(exr: Path) -> str:
    return str(oiio.ImageBuf(str(exr)).spec().get_string_attribute("colorInteropID"))


class TestDirection:
    def test_profiles_run_toward_light(self, tmp_path: Path) -> None:
        profile = write_lut(GAMMA, tmp_path / "a.icc", primaries=None)
        found = apply_lut(Photo(RAMP), profile)
        assert np.abs(found - through_ocio(profile, RAMP, inverse=True)).max() < 1e-6
        assert np.allclose(found[..., 1], RAMP[..., 1] ** 2.2, atol=1e-4)  # Y of gray
        back = lut_lookup(profile, "encode").apply(np.ascontiguousarray(found))
        assert np.allclose(back[:, 1:], RAMP[:, 1:], atol=1e-3)  # 16 bits tell no black

    @pytest.mark.parametrize("name", ["a.encode.clf", "a.encode.ctf", "a.encode.spi1d"])
    def test_what_encodes_by_its_name_is_refused(self, name: str, tmp_path: Path) -> None:
        lut = write_lut(GAMMA, tmp_path / name, direction="encode")
        with pytest.raises(LutError, match='by its name; pass direction="linearize" to'):
            lut_lookup(lut)
        assert np.allclose(lut_lookup(lut, "linearize").apply(RAMP), RAMP**2.2, atol=1e-5)
        assert np.allclose(lut_lookup(lut, "encode").apply(RAMP), RAMP ** (1 / 2.2), atol=1e-2)

    @pytest.mark.parametrize("suffix", ["clf", "ctf", "spi1d", "cube", "csp", "iridas.cube"])
    def test_what_encodes_under_another_name_is_refused(self, suffix: str, tmp_path: Path) -> None:
        lut = write_lut(GAMMA, tmp_path / f"a.{suffix}", direction="encode")
        by = "description" if suffix in ("clf", "ctf") else "the shape of its curve"
        with pytest.raises(LutError, match=f"encodes, by .*{by}"):
            lut_lookup(lut)

    @pytest.mark.parametrize("power", [1.0, 1.2, 2.2, 4.0])
    def test_what_darkens_or_hardly_brightens_does_not_encode(
        self, power: float, tmp_path: Path
    ) -> None:
        lut = write_lut(InverseCRF(GRID, np.stack([GRID**power] * 3)), tmp_path / "a.cube")
        assert np.allclose(lut_lookup(lut).apply(RAMP), RAMP**power, atol=1e-5)

    def test_a_lut_that_linearizes_can_be_run_backward(self, tmp_path: Path) -> None:
        lookup = lut_lookup(write_lut(GAMMA, tmp_path / "a.cube"), "encode")
        assert np.allclose(lookup.apply(RAMP**2.2), RAMP, atol=1e-3)
        assert lookup.leads_to(Photo(RAMP).primaries) is None

    @pytest.mark.parametrize("suffix", [".cube", ".CUBE", ".spi1d"])
    def test_decimal_commas_are_refused(self, suffix: str, tmp_path: Path) -> None:
        """OpenColorIO takes `0,5` for 0, and the image came out black."""
        rows = ["0,0 0,0 0,0", "0,5 0,5 0,5", "1,0 1,0 1,0"]
        head = ["LUT_1D_SIZE 3"]
        if suffix == ".spi1d":
            head, rows = ["Version 1", "From 0 1", "Length 3", "Components 3", "{"], [*rows, "}"]
        lut = tmp_path / f"a{suffix}"
        lut.write_text("\n".join([*head, *rows]) + "\n", encoding="ascii")
        with pytest.raises(LutError, match=f"line {len(head) + 1} has a decimal comma"):
            lut_processor(lut)
        lut.write_text("\n".join([*head, *rows]).replace(",", ".") + "\n", encoding="ascii")
        assert lut_processor(lut) is not None

    def test_unknown_directions_are_refused(self, tmp_path: Path) -> None:
        with pytest.raises(SettingsError, match="no direction 'back'; known: linearize, encode"):
            lut_lookup(write_lut(GAMMA, tmp_path / "a.cube"), "back")

    def test_by_the_command(self, facecrf: CommandLine, tmp_path: Path) -> None:
        photo = write(tmp_path / "a.png", random_codes(), oiio.UINT8)
        lut = write_lut(GAMMA, tmp_path / "a.encode.clf", direction="encode")
        exr = tmp_path / "a.exr"
        ended = facecrf("apply", photo, "--lut", lut, "-o", exr)
        assert ended.code == 3
        assert "--direction linearize" in ended.err
        assert not exr.exists()
        ended = facecrf("apply", photo, "--lut", lut, "--direction", "linearize", "-o", exr)
        assert ended.code == 0
        assert np.allclose(pixels_of(exr), GAMMA.linearize(read_photo(photo).encoded), atol=1e-3)


class TestTags:
    """The LUT's own records, then the photo's primaries if it keeps channels apart, or unknown."""

    def tagged(self, tmp_path: Path, lut: Path, known: str = "Display P3", **way: str) -> str:
        icc = matrix_profile(*KNOWN_PRIMARIES[known]) if known else None
        Image.fromarray(random_codes()).save(tmp_path / "a.png", icc_profile=icc)
        photo = read_photo(tmp_path / "a.png")
        space = lut_lookup(lut, **way).leads_to(photo.primaries)
        return "unknown" if space is None else space.name

    def test_a_matrix_to_a_known_space(self, tmp_path: Path) -> None:
        lut = write_clf(tmp_path / "a.clf", CURVE, matrix(REC709_TO_AP1))
        for known in ("", "Display P3", "Rec.709"):
            assert self.tagged(tmp_path, lut, known) == "AP1"

    def test_any_other_matrix(self, tmp_path: Path) -> None:
        lut = write_clf(tmp_path / "a.clf", CURVE, matrix(MIXES))
        assert self.tagged(tmp_path, lut) == "unknown"

    def test_a_curve_alone(self, tmp_path: Path) -> None:
        lut = write_clf(tmp_path / "a.clf", CURVE)
        assert self.tagged(tmp_path, lut) == "Display P3"
        assert self.tagged(tmp_path, lut, "") == "unknown"

    @pytest.mark.parametrize(
        ("after", "space"),
        [
            ("ACES2065-1", "AP0"),
            ("ACEScg", "AP1"),
            ("linear Rec.709 primaries, D65 white point", "Rec.709"),
            ("Rec.709 camera OETF Rec.709 primaries", "unknown"),
            ("ACEScct", "unknown"),
            ("CIE XYZ, D65 white point", "CIE XYZ"),
        ],
    )
    def test_a_description(self, after: str, space: str, tmp_path: Path) -> None:
        lut = write_clf(tmp_path / "a.clf", matrix(MIXES), before="LogC", after=after)
        assert self.tagged(tmp_path, lut) == space

    @pytest.mark.parametrize("space", ["acescg", "lin_rec709", "lin_p3d65", "aces2065-1"])
    def test_our_own_luts_to_working_spaces(self, space: str, tmp_path: Path) -> None:
        names = {"acescg": "AP1", "lin_rec709": "Rec.709", "lin_p3d65": "Display P3"}
        for suffix in ("clf", "ctf"):
            lut = write_lut(GAMMA, tmp_path / f"a.{suffix}", space=space)
            assert self.tagged(tmp_path, lut, "") == names.get(space, "AP0")
            back = tmp_path / f"a.encode.{suffix}"
            write_lut(GAMMA, back, space=space, direction="encode")
            assert self.tagged(tmp_path, back, direction="encode") == "unknown"

    def test_a_profile_leads_to_xyz(self, tmp_path: Path, facecrf: CommandLine) -> None:
        photo = write(tmp_path / "a.png", random_codes(), oiio.UINT8)
        lut, exr = write_lut(GAMMA, tmp_path / "a.icm.icc"), tmp_path / "a.exr"
        assert facecrf("apply", photo, "--lut", lut, "-o", exr).code == 0
        assert tag_of(exr) == "lin_ciexyzd65_scene"


class TestBeyondWhatALutTakes:
    def test_tables_infinite_where_no_photo_goes(self, tmp_path: Path) -> None:
        values = half_floats()
        with np.errstate(over="ignore", invalid="ignore"):
            values = np.where(values > 8, np.exp2(values * 10.0), values)
        lut = write_half_domain(tmp_path / "a.clf", values)
        assert np.isinf(values[np.isfinite(half_floats())]).any()
        found = apply_lut(Photo(RAMP), lut)
        assert np.array_equal(found, through_ocio(lut, RAMP))

    @pytest.mark.parametrize("at", [0.5, 2.0])
    def test_a_nan_at_a_number_is_the_luts_fault(self, at: float, tmp_path: Path) -> None:
        values = half_floats()
        values[values == at] = np.nan
        with pytest.raises(LutError, match="holds NaN or infinite values; make the LUT again"):
            lut_lookup(write_half_domain(tmp_path / "a.clf", values))

    @pytest.mark.parametrize("dtype", [np.float16, np.float32])
    def test_a_pixel_beyond_is_brought_back(self, dtype: type, tmp_path: Path) -> None:
        lut = write_clf(tmp_path / "a.clf", LOG_TO_INFINITY, matrix(MIXES))
        pixels = np.full((9, 7, 3), 0.4, dtype)
        pixels[3, 4] = (2000, 1500, 900)
        expected = through_ocio(lut, pixels)
        assert not np.isfinite(expected[3, 4]).all()
        for kind in (np.float16, np.float32):
            found = lut_lookup(lut).apply(pixels, dtype=kind)
            assert np.isfinite(found).all()
            assert found[3, 4].max() >= 65504
            rest = np.ones((9, 7), bool)
            rest[3, 4] = False
            assert np.allclose(found[rest], expected[rest], rtol=2e-3)


def test_hanging_files_are_named(tmp_path: Path, facecrf: CommandLine) -> None:
    (tmp_path / "a.csp").write_bytes(b"CSPLUTV100\n1D\n\nBEGIN METADATA\n# c\nEND ")
    photo = write(tmp_path / "a.png", random_codes(), oiio.UINT8)
    ended = facecrf("apply", photo, "--lut", tmp_path / "a.csp", "-o", tmp_path / "a.exr")
    assert ended.code == 3
    assert "a.csp: it ends before its table; copy it again" in ended.err
    assert "OpenColorIO does not come to an end with it" in why_unusable(tmp_path / "a.csp")


def test_oiiotool_is_told_what_the_pixels_are(tmp_path: Path) -> None:
    """The way the README gives it: what follows does not linearize a second time."""
    oiiotool = Path(sys.executable).parent / "oiiotool"
    if not oiiotool.exists():
        pytest.skip("oiiotool is not beside this Python")
    photo = write(tmp_path / "a.jpg", random_codes(), oiio.UINT8)
    lut, exr = write_lut(GAMMA, tmp_path / "a.spi1d"), tmp_path / "a.exr"
    linear = ("-d", "float", "--ociofiletransform", lut, "--iscolorspace", "lin_rec709_scene")
    on = ("--colorconfig", "ocio://default", "--tocolorspace", "ACEScg", "-o", exr)
    subprocess.run([str(x) for x in (oiiotool, photo, *linear, *on)], check=True)
    light = GAMMA.linearize(read_photo(photo).encoded)
    expected = light @ np.reshape(REC709_TO_AP1, (3, 3)).T
    assert np.abs(pixels_of(exr) - expected).max() < 1e-4
    assert tag_of(exr) == "lin_ap1_scene"


FALLS = "LUT_1D_SIZE 3\n0.9 0.9 0.9\n0.5 0.5 0.5\n0 0 0\n"


@pytest.mark.parametrize("command", ["apply", "ocio-config"])
def test_what_lint_finds_is_told_where_a_lut_is_used(
    command: str, facecrf: CommandLine, tmp_path: Path
) -> None:
    (tmp_path / "a.cube").write_text(FALLS)
    photo = write(tmp_path / "a.png", random_codes(), oiio.UINT8)
    given = (photo, "--lut") if command == "apply" else ()
    out = tmp_path / ("a.exr" if command == "apply" else "a.ocio")
    ended = facecrf(command, *given, tmp_path / "a.cube", "-o", out)
    assert (ended.code, out.exists()) == (0, True)
    assert "note: a.cube: R decreases (and 2 more by facecrf lint)" in ended.out


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"\xef\xbb\xbfLUT_1D_SIZE 2\n0 0 0\n1 1 1\n", "line 1: it begins with a byte-order"),
        ("LUT_1D_SIZE 2\n0 0 0\n1 1 1\n".encode("utf-16"), "line 1: it is UTF-16"),
        (b"LUT_1D_SIZE 3\n0 0 0\n1 1 1\n", "line 1: 2 entries where 3 are promised"),
        (b"", "no size is given"),
    ],
)
def test_why_a_lut_is_refused_is_told_as_by_lint(
    content: bytes, told: str, facecrf: CommandLine, tmp_path: Path
) -> None:
    (tmp_path / "a.cube").write_bytes(content)
    photo = write(tmp_path / "a.png", random_codes(), oiio.UINT8)
    ended = facecrf("apply", photo, "--lut", tmp_path / "a.cube", "-o", tmp_path / "a.exr")
    assert (ended.code, ended.err.count("\n")) == (3, 1)
    assert f"a.cube: {told}" in ended.err
