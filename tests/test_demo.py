"""`facecrf demo`: the whole job on a real portrait."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import PyOpenColorIO as ocio  # noqa: N813
import pytest
from command_line import CommandLine, names_in
from matplotlib import cbook
from photo_files import oiiotool, pixels_of

from facecrf_ocio.record.calibration_record import read_record

LUTS = ("grace_hopper.jpg.spi1d", "grace_hopper.jpg.cube", "grace_hopper.jpg.clf")
FILES = {*LUTS, *(f"grace_hopper.jpg.{end}" for end in ("crf.json", "crf.png", "exr"))}
PORTRAIT = Path(str(cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)))


@pytest.mark.slow
def test_demo(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    facecrf, folder = CommandLine(capfd), tmp_path / "demo"
    ended = facecrf("demo", "-o", folder)
    assert (ended.code, ended.err) == (0, "")
    expect_what_is_printed(ended.out, folder)
    for name in LUTS:
        expect_lut(folder / name, folder / "grace_hopper.jpg.crf.json")
        expected = oiiotool(PORTRAIT, folder / name, tmp_path / "expected.exr")
        pixels = pixels_of(folder / "grace_hopper.jpg.exr")
        assert np.allclose(pixels, expected, rtol=2**-10, atol=2**-24)
    header = oiio.ImageBuf(str(folder / "grace_hopper.jpg.exr")).spec()
    assert header.get_string_attribute("colorInteropID") == "unknown"

    again = facecrf("demo", "-o", folder)
    assert (again.code, again.out) == (0, ended.out)
    assert names_in(folder) == FILES


def expect_what_is_printed(printed: str, folder: Path) -> None:
    first, *files = printed.splitlines()
    assert first.startswith(f"{PORTRAIT}: calibrated (")
    assert {Path(line.strip()) for line in files} == {folder / name for name in FILES}
    assert names_in(folder) == FILES


def expect_lut(lut: Path, record: Path) -> None:
    """Expect OCIO to load a LUT and to make of gray what the record's curve does."""
    processor = ocio.Config.CreateRaw().getProcessor(ocio.FileTransform(src=str(lut)))
    curve = read_record(record).estimate.found
    assert curve is not None
    for gray in (0.0, 0.25, 0.5, 0.75, 1.0):
        result = processor.getDefaultCPUProcessor().applyRGB([gray] * 3)
        assert np.allclose(result, curve.linearize([gray] * 3), atol=2e-6)


def test_a_folder_that_cannot_be(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "demo").write_text("mine")
    ended = CommandLine(capfd)("demo", "-o", tmp_path / "demo")
    assert (ended.code, ended.out) == (1, "")
    assert ended.err.count("\n") == 1
    assert "is not a folder" in ended.err
