"""Encoding and working spaces, read by OpenColorIO."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from command_line import CommandLine, names_in, write_noise

from facecrf_ocio.color.primaries import known_primaries
from facecrf_ocio.color.working_space import working_space_matrix
from facecrf_ocio.errors import LutError, OutputError, SettingsError
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.values import InverseCRF

NODES = np.linspace(0.0, 1.0, 4096)
CURVE = InverseCRF(NODES, np.stack([NODES**2.4, NODES**2.2, NODES**1.8]))
P3 = known_primaries("Display P3", "ICC profile")


def through_ocio(path: Path, pixels: np.ndarray) -> np.ndarray:
    ocio.ClearAllCaches()
    pixels = np.ascontiguousarray(pixels, np.float32).copy()
    processor = ocio.Config.CreateRaw().getProcessor(ocio.FileTransform(str(path)))
    processor.getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(pixels)
    return pixels


def gray(values: np.ndarray) -> np.ndarray:
    return np.repeat(np.asarray(values)[:, None], 3, axis=1)


@pytest.mark.parametrize(
    ("suffix", "darkest"),
    # Half floats are spaced by 6e-8 below 6e-5; a uniform table has its second entry at 1.5e-5.
    [
        ("ctf", 0.0),
        ("clf", 1e-5),
        *((name, 0.02) for name in ("spi1d", "cube", "iridas.cube", "csp")),
    ],
)
def test_encoding_is_the_inverse_of_the_curve(suffix: str, darkest: float, tmp_path: Path) -> None:
    path = write_lut(CURVE, tmp_path / f"a.{suffix}", direction="encode")
    linear = gray(np.concatenate([np.linspace(darkest, 1.0, 9999), np.geomspace(1e-6, 1, 999)]))
    linear = linear[linear[:, 0] >= darkest]
    got, own = through_ocio(path, linear), CURVE.encode(linear)
    np.testing.assert_allclose(got, own, rtol=0, atol=1e-6 if suffix != "ctf" else 3e-6)


@pytest.mark.parametrize("suffix", ["clf", "ctf"])
@pytest.mark.parametrize("space", ["acescg", "lin_rec709", "lin_p3d65", "aces2065-1"])
def test_the_working_space_follows_the_curve(suffix: str, space: str, tmp_path: Path) -> None:
    path = write_lut(CURVE, tmp_path / f"a.{suffix}", space=space, primaries=P3)
    codes = np.random.default_rng(0).random((4000, 3), np.float32)
    expected = CURVE.linearize(codes) @ working_space_matrix(P3, space).T
    np.testing.assert_allclose(through_ocio(path, codes), expected, rtol=0, atol=1e-6)


@pytest.mark.parametrize("suffix", ["clf", "ctf"])
def test_there_and_back_is_where_it_was(suffix: str, tmp_path: Path) -> None:
    there, back = (
        write_lut(CURVE, tmp_path / f"{d}.{suffix}", direction=d, space="acescg", primaries=P3)
        for d in ("linearize", "encode")
    )
    codes = np.random.default_rng(1).uniform(0.05, 0.99, (4000, 3))
    np.testing.assert_allclose(
        through_ocio(back, through_ocio(there, codes)), codes, rtol=0, atol=2e-5
    )


@pytest.mark.parametrize("suffix", ["clf", "ctf"])
def test_a_process_list_says_which_way_it_goes_and_whither(suffix: str, tmp_path: Path) -> None:
    ids = set()
    for direction in ("linearize", "encode"):
        for space in ("", "acescg"):
            path = tmp_path / f"{direction}{space}.{suffix}"
            write_lut(CURVE, path, direction=direction, space=space)
            root = ElementTree.parse(path).getroot()  # noqa: S314 - our own file
            ends = [root.findtext("InputDescriptor"), root.findtext("OutputDescriptor")]
            encoded, linear = ends if direction == "linearize" else ends[::-1]
            assert encoded == "RGB as encoded by the camera"
            assert (linear or "").startswith(f"linear RGB, {space or 'relative exposure'}")
            ocio.ClearAllCaches()
            processor = ocio.Config.CreateRaw().getProcessor(ocio.FileTransform(str(path)))
            assert processor.getFormatMetadata().getID() == root.get("id")
            ids.add(root.get("id"))
    assert len(ids) == 4


def test_what_a_format_cannot_hold_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LutError, match=r"a\.cube: .cube cannot hold the matrix to acescg; use clf"):
        write_lut(CURVE, tmp_path / "a.cube", space="acescg")
    for name in ("a.icc", "a.v4.icc"):
        with pytest.raises(LutError, match="ICC input profile goes from code values"):
            write_lut(CURVE, tmp_path / name, direction="encode")
    with pytest.raises(SettingsError, match="no direction 'sideways'"):
        write_lut(CURVE, tmp_path / "a.clf", direction="sideways")
    with pytest.raises(SettingsError, match="no working space 'xyz'"):
        write_lut(CURVE, tmp_path / "a.clf", space="xyz")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", ["ctf", "csp", "icc", "iridas.cube", "v4.icc"])
def test_an_existing_file_stays(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(b"former")
    with pytest.raises(OutputError, match="exists already; pass overwrite=True"):
        write_lut(CURVE, path)
    assert path.read_bytes() == b"former"
    assert list(tmp_path.iterdir()) == [path]


def test_the_command_writes_both_directions(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    photo, out = write_noise(tmp_path / "a.png"), tmp_path / "out"
    run = CommandLine(capfd)
    options = ("--estimator", "srgb", "--formats", "clf,ctf", "--direction", "both")
    assert run("calibrate", photo, "-o", out, *options, "--to", "acescg").code == 0
    names = {f"a.png.acescg.{d}{s}" for d in ("", "encode.") for s in ("clf", "ctf")}
    assert names_in(out) == {*names, "a.png.crf.json"}
    assert run("calibrate", photo, "-o", out, "--formats", "cube", "--to", "acescg").code == 2


def test_the_two_styles_of_cube_stand_side_by_side(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    photo, out = write_noise(tmp_path / "a.iridas.png"), tmp_path / "out"
    run = CommandLine(capfd)
    options = ("--estimator", "srgb", "--formats", "cube,iridas.cube,icc,v4.icc")
    assert run("calibrate", photo, "-o", out, *options, "--direction", "both").code == 0
    both = {"cube", "iridas.cube", "encode.cube", "encode.iridas.cube", "icc", "v4.icc"}
    assert names_in(out) == {f"a.iridas.png.{ending}" for ending in (*both, "crf.json")}
    # The photo's own name ends as the other style's files do, and must not choose the style.
    assert "LUT_1D_INPUT_RANGE" in (out / "a.iridas.png.cube").read_text()
    assert "DOMAIN_MAX" in (out / "a.iridas.png.iridas.cube").read_text()
