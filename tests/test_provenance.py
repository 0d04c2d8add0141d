"""What an EXR tells of itself, by readers that did not write it."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from photo_files import GRID, random_codes, write

from facecrf_ocio import __version__, read_photo
from facecrf_ocio.image.linearize import write_linear, write_through_lut
from facecrf_ocio.record.outputs import write_outputs
from facecrf_ocio.record.provenance import curve_sha256, expected_error
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import (
    Confidence,
    Estimate,
    InStops,
    InverseCRF,
    Outcome,
    Photo,
    Verdict,
)

GAMMA = InverseCRF(GRID, np.stack([GRID**2.2, GRID**2.0, GRID**1.8]))
SIGMA = np.full((3, GRID.size), 0.03)
CONFIDENCE = Confidence(
    SIGMA, SIGMA, Verdict.WEAK, ("few faces",), InStops(np.full((3, 256), 0.3), 0.21, 0.48)
)
ESTIMATE = Estimate(Outcome.CALIBRATED, "joint", "found", found=GAMMA, confidence=CONFIDENCE)


@pytest.fixture
def photo(tmp_path: Path) -> Photo:
    return read_photo(write(tmp_path / "é.png", random_codes(), oiio.UINT8))


def by_openimageio(exr: Path) -> dict[str, str]:
    attributes = oiio.ImageBuf(str(exr)).spec().extra_attribs
    return {a.name: str(a.value) for a in attributes if a.name.startswith("facecrf:")}


def by_openexr(exr: Path) -> dict[str, str]:
    reader = pytest.importorskip("OpenEXR", reason="OpenEXR's own reader is not installed")
    header = reader.File(str(exr)).header()
    return {name: str(value) for name, value in header.items() if name.startswith("facecrf:")}


READERS = pytest.mark.parametrize("told_by", [by_openimageio, by_openexr])


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@READERS
def test_of_an_estimate(told_by, photo: Photo, tmp_path: Path) -> None:
    told = told_by(write_linear(tmp_path / "a.exr", photo, ESTIMATE).path)
    assert photo.path is not None
    summary = told.pop("facecrf:summary")
    assert summary
    assert told == {
        "facecrf:outcome": "calibrated",
        "facecrf:estimator": "joint",
        "facecrf:confidence": "weak",
        "facecrf:expected_error": "0.21 stops in the mid-tones, 0.48 in the shadows",
        "facecrf:curve_sha256": curve_sha256(GAMMA),
        "facecrf:source": "é.png",
        "facecrf:source_sha256": digest(photo.path),
        "facecrf:exposure_assumption": "relative, known up to one factor",
        "facecrf:primaries": "unknown",
        "facecrf:version": __version__,
    }


@READERS
def test_of_a_lut_with_its_record_beside_it(told_by, photo: Photo, tmp_path: Path) -> None:
    lut, *_ = write_outputs(photo, ESTIMATE, Settings(), tmp_path / "luts", ["spi1d"])
    other = read_photo(write(tmp_path / "b.png", random_codes()[::-1].copy(), oiio.UINT8))
    told = told_by(write_through_lut(tmp_path / "b.exr", other, lut).path)
    assert photo.path is not None
    assert other.path is not None
    expected = {
        "lut": "é.png.spi1d",
        "lut_sha256": digest(lut),
        "direction": "linearize",
        "outcome": "calibrated",
        "estimator": "joint",
        "confidence": "weak",
        "expected_error": "0.21 stops in the mid-tones, 0.48 in the shadows",
        "calibrated_from": "é.png",
        "calibrated_from_sha256": digest(photo.path),
        "source": "b.png",
        "source_sha256": digest(other.path),
        "exposure_assumption": "relative, known up to one factor",
        "version": __version__,
    }
    assert {name: told[f"facecrf:{name}"] for name in expected} == expected


def test_imageio_reads_the_file_and_passes_on_no_attribute_of_any_exr(
    photo: Photo, tmp_path: Path
) -> None:
    """It reads EXR by PyAV alone, which knows pixels and codec."""
    pytest.importorskip("av", reason="PyAV, by which imageio reads EXR, is not installed")
    reader = pytest.importorskip("imageio.v3", reason="imageio is not installed")
    exr = write_linear(tmp_path / "a.exr", photo, ESTIMATE).path
    assert reader.imread(exr, plugin="pyav").shape[-3:] == photo.encoded.shape
    told = reader.immeta(exr, plugin="pyav")
    assert told["codec"] == "exr"
    assert not any("facecrf" in name for name in told)


def test_of_a_lut_from_elsewhere(photo: Photo, tmp_path: Path) -> None:
    lut = lut_of_another_maker(tmp_path)
    told = by_openimageio(write_through_lut(tmp_path / "a.exr", photo, lut).path)
    assert told["facecrf:lut_sha256"] == digest(lut)
    assert "facecrf:estimator" not in told


def lut_of_another_maker(folder: Path) -> Path:
    rows = "".join(f"{value:.9g}\n" for value in GRID**2.2)
    lut = folder / "x.spi1d"
    lut.write_text(f"Version 1\nFrom 0 1\nLength {GRID.size}\nComponents 1\n{{\n{rows}}}\n")
    return lut


def test_the_digest_of_a_curve_is_that_of_a_luts_entries(photo: Photo, tmp_path: Path) -> None:
    lut, *_ = write_outputs(photo, ESTIMATE, Settings(), tmp_path / "luts", ["spi1d"])
    table = lut.read_text().partition("{\n")[2].partition("}")[0]
    entries = np.array([line.split() for line in table.splitlines()], "<f4")
    assert hashlib.sha256(entries.tobytes()).hexdigest() == curve_sha256(GAMMA)


def test_an_expected_error_without_stops_is_of_white() -> None:
    old = Confidence(SIGMA, SIGMA, Verdict.WEAK, ())
    assert expected_error(old) == "3.0 % of white"
    assert expected_error(None) == ""
