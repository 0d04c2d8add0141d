"""A linter finds what is broken, and nothing in what is whole."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from facecrf_ocio.errors import LutError
from facecrf_ocio.export import FORMATS, write_lut
from facecrf_ocio.lint import lint
from facecrf_ocio.values import InverseCRF

NODES = np.linspace(0.0, 1.0, 4096)
CURVE = InverseCRF(NODES, np.stack([NODES**2.4, NODES**2.2, NODES**1.8]))
RAMP = "".join(f"{v:.6g} {v:.6g} {v:.6g}\n" for v in np.linspace(0, 1, 32))
SPI1D = f"Version 1\nFrom 0 1\nLength 32\nComponents 3\n{{\n{RAMP}}}\n"
CUBE = f"LUT_1D_SIZE 32\nLUT_1D_INPUT_RANGE 0 1\n{RAMP}"

BROKEN = {
    "NaN": ("a.spi1d", SPI1D.replace("0.0322581 ", "nan ", 1), 7, "error", "NaN"),
    "reversed": ("a.spi1d", SPI1D.replace("From 0 1", "From 1 0"), 2, "error", "reversed"),
    "commas": ("a.cube", CUBE.replace("0.", "0,"), 4, "error", "decimal comma"),
    "decreasing": ("a.cube", CUBE.replace("0.0645161 ", "0.01 ", 1), 5, "error", "decreases"),
    "length": ("a.cube", CUBE.replace("SIZE 32", "SIZE 33"), None, "error", "33 are promised"),
    "3-D": ("a.cube", CUBE.replace("1D_SIZE", "3D_SIZE"), 1, "error", "3-D LUT"),
    "jump": ("a.cube", CUBE.replace("\n0.", "\n0.0"), None, "warning", "jumps"),
    "not XML": ("a.clf", "<ProcessList", 1, "error", "no XML"),
    "not ICC": ("a.icc", "x", None, "error", "no ICC profile"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_each_fault_is_found(name: str, tmp_path: Path) -> None:
    file, text, line, severity, problem = BROKEN[name]
    (tmp_path / file).write_text(text)
    found = [f for f in lint(tmp_path / file) if problem in f.problem]
    assert found
    assert found[0].severity == severity
    assert line is None or found[0].line == line
    assert file in str(found[0])


def test_clipped_ends_are_found(tmp_path: Path) -> None:
    values = np.minimum(1.0, np.linspace(0, 1.5, 32))
    rows = "".join(f"{v:.6g} {v:.6g} {v:.6g}\n" for v in values)
    (tmp_path / "a.cube").write_text(f"LUT_1D_SIZE 32\n{rows}")
    found = lint(tmp_path / "a.cube")
    assert {f.severity for f in found} == {"warning"}
    assert "clipped" in found[0].problem


@pytest.mark.parametrize("direction", ["linearize", "encode"])
@pytest.mark.parametrize("suffix", FORMATS)
def test_what_we_write_is_clean(suffix: str, direction: str, tmp_path: Path) -> None:
    if suffix.endswith("icc") and direction == "encode":
        pytest.skip("an ICC input profile has one direction")
    path = write_lut(CURVE, tmp_path / f"a.{suffix}", direction=direction)
    assert lint(path) == ()


@pytest.mark.parametrize("text", [SPI1D, CUBE])
def test_a_ramp_is_clean(text: str, tmp_path: Path) -> None:
    path = tmp_path / ("a.cube" if text is CUBE else "a.spi1d")
    path.write_text(text)
    assert lint(path) == ()


def test_what_cannot_be_read_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(LutError, match="cannot be read: no such file"):
        lint(tmp_path / "a.cube")
    with pytest.raises(LutError, match="lint knows"):
        lint(tmp_path / "a.exr")


@pytest.mark.parametrize(("name", "code"), [("jump", 5), ("reversed", 6)])
def test_the_command_tells_and_ends_by_severity(name: str, code: int, tmp_path: Path) -> None:
    file, text, *_ = BROKEN[name]
    (tmp_path / file).write_text(text)
    run = "from facecrf_ocio.cli_lint import lint; lint()"
    arguments = [sys.executable, "-c", run, "--json", str(tmp_path / file)]
    ended = subprocess.run(arguments, capture_output=True, text=True, check=False)
    assert ended.returncode == code
    assert json.loads(ended.stdout.splitlines()[0])["path"] == str(tmp_path / file)
