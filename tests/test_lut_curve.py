"""The curve of a LUT file that keeps the channels apart, or one line that says why not."""

from __future__ import annotations

import numpy as np
import pytest
from archive_photos import exposed, write_picture
from command_line import CommandLine

from facecrf_ocio import write_lut
from facecrf_ocio.errors import LutError
from facecrf_ocio.image.lut_curve import curve_of_lut
from facecrf_ocio.synthetic import gamma_curve
from facecrf_ocio.values import InverseCRF

CODES = np.linspace(0.0, 1.0, 33)
FINE = np.linspace(0.0, 1.0, 4096)  # as LUTs have it
APART = InverseCRF(FINE, np.stack([FINE**1.8, FINE**2.2, FINE**2.6]))


def cube(path, rows):
    lines = [f"LUT_1D_SIZE {len(rows)}", *(" ".join(f"{v:.6f}" for v in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


def alike(values):
    return np.repeat(np.asarray(values, float)[:, None], 3, axis=1)


@pytest.mark.parametrize("name", ["a.spi1d", "a.cube", "a.clf", "a.ctf", "a.csp"])
def test_a_lut_is_read_as_the_curve_that_it_was_written_from(tmp_path, name):
    write_lut(APART, tmp_path / name)
    found = curve_of_lut(tmp_path / name)
    at = np.linspace(0.0, 1.0, 999)
    for mine, own in zip(found.linear, APART.linear, strict=True):
        assert np.abs(np.interp(at, found.encoded, mine) - np.interp(at, FINE, own)).max() < 2e-6


def test_light_of_another_scale_has_white_at_one(tmp_path):
    found = curve_of_lut(cube(tmp_path / "a.cube", alike(100.0 * CODES**2.2)))
    assert np.abs(np.interp(CODES, found.encoded, found.linear[0]) - CODES**2.2).max() < 1e-5


def test_a_lut_that_changes_nothing_is_a_curve(tmp_path):
    found = curve_of_lut(cube(tmp_path / "a.cube", alike([0.0, 1.0])))
    assert np.allclose(found.linear, found.encoded)


def three_dimensional(path):
    grid = np.linspace(0.0, 1.0, 2)
    rows = [f"{r} {g} {b}" for b in grid for g in grid for r in grid]
    path.write_text("\n".join(["LUT_3D_SIZE 2", *rows]) + "\n")
    return path


def to_acescg(path):
    write_lut(APART, path, space="acescg")
    return path


FALLING = np.array([0.0, 0.1, 0.3, 0.2, 0.6, 1.0])
REFUSED = {
    "three dimensions": (three_dimensional, "a.cube", "is a 3-D LUT or has a matrix"),
    "a matrix": (to_acescg, "a.clf", "is a 3-D LUT or has a matrix"),
    "it falls": (lambda p: cube(p, alike(FALLING)), "a.cube", "R falls at code 102 of 255"),
    "upside down": (lambda p: cube(p, alike(1.0 - CODES)), "a.cube", "R does not rise"),
    "constant": (lambda p: cube(p, alike(0 * CODES)), "a.cube", "R does not rise"),
    "no black": (lambda p: cube(p, alike(0.2 + 0.8 * CODES**2)), "a.cube", "0.20 of white of code"),
    "encodes": (lambda p: cube(p, alike(CODES**0.45)), "a.cube", "from light to code values"),
    "encodes, says its name": (
        lambda p: write_lut(APART, p, direction="encode"),
        "a.encode.clf",
        "goes from light to code values, by",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_curve_of_light_is_refused_in_one_line(tmp_path, case):
    make, name, says = REFUSED[case]
    make(tmp_path / name)
    with pytest.raises(LutError, match=says) as caught:
        curve_of_lut(tmp_path / name)
    assert str(caught.value).startswith(f"{tmp_path / name}: ")
    assert "; " in str(caught.value)
    assert "\n" not in str(caught.value)


def bracket(folder):
    curve, light = gamma_curve(2.2), np.random.default_rng(0).uniform(0.02, 1.0, (24, 24, 3))
    scene = np.kron(light, np.ones((16, 16, 1))).astype(np.float32)
    return curve, [
        write_picture(
            folder / f"{n}.jpg", np.clip(scene * np.float32(2.0**s), 0, 1), curve, **exposed(n, s)
        )
        for n, s in enumerate((-4, -2, 0))
    ]


def test_a_bracket_is_merged_by_a_lut(capfd, tmp_path):
    curve, photos = bracket(tmp_path)
    write_lut(curve, tmp_path / "camera.spi1d")
    target = tmp_path / "hdr.exr"
    ended = CommandLine(capfd)("merge", *photos, "-o", target, "--curve", tmp_path / "camera.spi1d")
    assert (ended.code, ended.err) == (0, "")
    assert "curve by the LUT camera.spi1d" in ended.out
    assert target.is_file()


def test_a_bracket_is_not_merged_by_a_lut_that_encodes(capfd, tmp_path):
    _, photos = bracket(tmp_path)
    lut = cube(tmp_path / "camera.cube", alike(CODES**0.45))
    target = tmp_path / "hdr.exr"
    ended = CommandLine(capfd)("merge", *photos, "-o", target, "--curve", lut)
    assert ended.code != 0
    assert f"{lut}: goes from light to code values" in ended.err
    assert not target.exists()
