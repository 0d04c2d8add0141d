"""The benchmark of speed: what it compares does the same work, and what it tells is kept."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from photo_files import write_spi1d

from facecrf_ocio.benchmark.speed.linearize_speed import PAIRS, measure_speed
from facecrf_ocio.benchmark.speed.race import Timed
from facecrf_ocio.benchmark.speed.speed_history import Run, append, slower
from facecrf_ocio.benchmark.speed.speed_row import SpeedRow, in_ratio, table_of
from facecrf_ocio.benchmark.speed.speed_table import KINDS, measure_rows
from facecrf_ocio.cli.bench.bench_speed import _KINDS
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.errors import OutputError

RUN = Run("2026-01-31", "abc1234", "Acme 3000, 2 cores, Python 3.11.7", 1.0)
ROW = in_ratio("some", "some work", Timed("", "", 0.5, 0.4, 1), Timed("", "", 0.2, 0.2, 1), 2.0)


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


def test_the_command_prints_every_pair_of_types() -> None:
    arguments = ["bench", "speed", "--types", "--megapixels", "0.02", "--repeat", "1"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.output
    assert "OpenImageIO, ociofiletransform" in result.output
    assert "decode + write" in result.output


def test_the_command_knows_what_can_be_measured() -> None:
    assert tuple(KINDS) == _KINDS


def test_the_command_prints_rows_keeps_them_and_compares_them(tmp_path: Path) -> None:
    history = tmp_path / "benchmarks.csv"
    arguments = ["bench", "speed", "--only", "apply", "--scale", "0.01", "--repeat", "1"]
    result = CliRunner().invoke(
        main, [*arguments, "--history", str(history), "--against", str(history)]
    )
    assert result.exit_code == 0, result.output
    assert "apply, slowest pair" in result.output
    assert "nothing is compared" in result.output  # there was no history yet
    assert history.read_text().splitlines()[1].split(",")[-5].startswith("apply_")


def test_a_ratio_is_of_ours_to_the_floor() -> None:
    assert (ROW.value, ROW.ratio, ROW.cpu) == pytest.approx((2.5, 2.5, 2.0))
    assert not ROW.reached
    assert replace(ROW, value=1.9).reached
    assert replace(ROW, more=True).reached
    words = table_of([ROW]).splitlines()[1].split()
    assert words[-7:] == ["2.50", "<=", "2", "2.50", "2.00", "not", "yet"]


def test_a_history_grows_by_a_line_a_row(tmp_path: Path) -> None:
    path = tmp_path / "benchmarks.csv"
    append(path, RUN, [ROW])
    append(path, replace(RUN, commit="def5678"), [ROW, replace(ROW, key="other")])
    lines = path.read_text().splitlines()
    assert lines[0] == "date,commit,machine,scale,row,value,wanted,ratio,cpu_ratio"
    assert lines[1].endswith(",some,2.500,2.000,2.500,2.000")
    assert [line.split(",")[1] for line in lines[1:]] == ["abc1234", "def5678", "def5678"]


def slowed(row: SpeedRow, time: float, cpu: float) -> SpeedRow:
    return replace(row, ratio=row.ratio * time, cpu=row.cpu * cpu)


def test_a_row_a_fifth_slower_by_time_and_by_cpu_is_told(tmp_path: Path) -> None:
    path = tmp_path / "benchmarks.csv"
    append(path, RUN, [slowed(ROW, 3.0, 3.0)])
    append(path, RUN, [ROW])  # the last line counts
    (line,) = slower(path, RUN, [slowed(ROW, 1.25, 1.25)])
    assert line.startswith("some: 3.12 times the floor, 2.50 at abc1234")
    assert not list(slower(path, RUN, [slowed(ROW, 1.15, 1.5), replace(ROW, key="new")]))
    assert not list(slower(path, RUN, [slowed(ROW, 1.5, 1.15)]))  # the machine was busy


def test_another_machine_is_not_compared(tmp_path: Path) -> None:
    path = tmp_path / "benchmarks.csv"
    append(path, RUN, [ROW])
    for other in (
        replace(RUN, machine="Acme 4000, 8 cores, Python 3.11.7"),
        replace(RUN, scale=0.5),
    ):
        (line,) = slower(path, other, [slowed(ROW, 9.0, 9.0)])
        assert "nothing is compared" in line


def test_another_file_is_no_history(tmp_path: Path) -> None:
    path = tmp_path / "notes.csv"
    path.write_text("a,b\n1,2\n")
    with pytest.raises(OutputError, match="no history of speed"):
        append(path, RUN, [ROW])
    assert path.read_text() == "a,b\n1,2\n"


@pytest.mark.slow
def test_all_rows_are_measured() -> None:
    rows = measure_rows(scale=0.05, repeat=1)
    keys = {row.key for row in rows}
    assert {"calibrate_12mp", "calibrate_24mp", "cold", "apply_one", "batch", "report"} <= keys
    assert {"exr_none", "exr_zip_1"} <= keys
    for row in rows:
        assert row.value > 0
        assert row.ratio > 0
