"""The benchmark of speed: what it compares does the same work."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from photo_files import write_spi1d

from facecrf_ocio.benchmark.speed import PAIRS, measure_speed
from facecrf_ocio.cli.facecrf import main


@pytest.fixture(scope="module")
def lut(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_spi1d(tmp_path_factory.mktemp("speed") / "a.spi1d")


def test_every_pair_of_types_is_timed_beside_the_other_libraries(lut: Path) -> None:
    speed = measure_speed(lut, 0.02, 1)
    by = {(item.work, item.by) for item in speed.timed}
    for given, made in PAIRS:
        work = f"{np.dtype(given)} to {np.dtype(made)}"
        for name in ("this package", "OpenColorIO, packed", "OpenImageIO, ociofiletransform"):
            assert (work, name) in by
    assert {
        ("JPEG to half EXR, zip", name) for name in ("read_photo + apply + write", "decode + write")
    } <= by
    for item in speed.timed:
        assert item.rate == pytest.approx(speed.megapixels / item.seconds)


def test_the_lookup_equals_opencolorio(lut: Path) -> None:
    assert measure_speed(lut, 0.02, 1).error < 1e-6


def test_the_command_prints_it_in_one_run() -> None:
    result = CliRunner().invoke(main, ["bench", "speed", "--megapixels", "0.02", "--repeat", "1"])
    assert result.exit_code == 0, result.output
    assert "OpenImageIO, ociofiletransform" in result.output
    assert "decode + write" in result.output
