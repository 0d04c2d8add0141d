"""A LUT format is one file and one row: whatever names formats goes by the table."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import CODE, write_noise

from facecrf_ocio.errors import LutError
from facecrf_ocio.lut.format_table import FORMATS, format_of, of_suffix

# Cineon's own 1-D table under a suffix that OpenColorIO knows by content alone: a .spi1d by name.
TOY = """
from pathlib import Path
from facecrf_ocio.lut.format_table import LutFormat, register
from facecrf_ocio.lut.formats.spi1d import spi1d_text
from facecrf_ocio.lut.lint.finding import Finding, Table

def write(recipe, comments):
    return spi1d_text(recipe, comments)

def read(path, content):
    toy = Finding(Path(path), 1, "warning", "it is a toy", "take another")
    return [Table([(1, [0.0]), (2, [1.0])], 2, (toy,))]

register(LutFormat("toy.spi1d", "toy_format:write", "toy_format:read", default=True))
register(LutFormat("toylut", "toy_format:write", "toy_format:read"))
"""


def run(folder: Path, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run the command where every process registers the toy formats before anything else."""
    (folder / "toy_format.py").write_text(TOY)
    (folder / "sitecustomize.py").write_text("import toy_format\n")
    root = str(Path(__file__).resolve().parents[1])
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(folder), root))}
    return subprocess.run(
        [sys.executable, "-c", CODE, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
        cwd=folder,
    )


@pytest.mark.slow
def test_a_format_with_a_row_is_everywhere(tmp_path: Path) -> None:
    photos = tmp_path / "photos"
    photos.mkdir()
    photo = write_noise(photos / "a.png")
    for command in ("calibrate", "batch"):
        told = " ".join(run(tmp_path, command, "--help").stdout.split())
        assert "v4.icc, toy.spi1d, toylut." in told
        assert "[default: spi1d,cube,clf,toy.spi1d]" in told
    blind = ("--estimator", "srgb")
    ended = run(tmp_path, "calibrate", photo, "-o", "one", "--formats", "toy.spi1d", *blind)
    assert ended.returncode == 0, ended.stderr
    assert (tmp_path / "one" / "a.png.toy.spi1d").is_file()
    ended = run(tmp_path, "batch", photos, "-o", "all", *blind)
    assert ended.returncode == 0, ended.stderr
    assert (tmp_path / "all" / "a.png.toy.spi1d").is_file()
    toylut = tmp_path / "a.toylut"
    toylut.write_bytes((tmp_path / "one" / "a.png.toy.spi1d").read_bytes())
    assert "warning: it is a toy; take another" in run(tmp_path, "lint", toylut).stdout
    config = run(tmp_path, "ocio-config", "one", "-o", "c.ocio")
    assert config.returncode == 0, config.stderr
    assert "facecrf_a" in (tmp_path / "c.ocio").read_text()
    encoded = ("--direction", "encode", "--to", "acescg")
    refused = run(tmp_path, "calibrate", photo, "-o", "b", "--formats", "toylut", *encoded, *blind)
    assert ".toylut cannot hold the matrix to acescg; use clf or ctf" in refused.stderr


def test_the_longest_ending_counts() -> None:
    assert format_of(Path("a.iridas.CUBE")) is FORMATS["iridas.cube"]
    assert format_of(Path("a.b.cube")) is FORMATS["cube"]
    with pytest.raises(LutError, match="unknown LUT format 'exr'"):
        format_of(Path("a.exr"))


def test_suffixes_name_the_first_format_that_has_them() -> None:
    assert of_suffix(".ICM") is FORMATS["icc"]
    assert of_suffix(".exr") is None
