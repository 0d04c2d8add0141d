"""The benchmark of archives: its commands do the same work, and its figures are what it timed."""

from __future__ import annotations

import os
import re
from io import BytesIO, TextIOWrapper
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from command_line import write_noise
from face_photos import grace_hopper
from PIL import Image

from facecrf_ocio.benchmark import archive_cost
from facecrf_ocio.benchmark.archive_cost import ArchiveCost, Cost, calibrate_loop, measure_archive
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.errors import SettingsError


def test_overhead_gain_and_its_bound_are_ratios_of_what_was_timed() -> None:
    loop, loops = Cost(0.2, 0.2, 4.0), Cost(0.125, 0.25, 7.0)
    one, two = Cost(0.21, 0.22, 4.0), Cost(0.14, 0.23, 6.0)
    text = ArchiveCost(64, 2, loop, loops, one, two).text
    assert "batch over calibrate: +5.0 % of time, +10.0 % of CPU" in text
    assert "2 jobs over one: 1.50 times the rate, 1.50 times with starting" in text
    assert "2 loops over one: 1.60 times the rate, 1.75 times with starting" in text


def test_a_batch_is_told_by_the_least_that_few_photos_took_and_the_least_that_all_did(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    photos = [Path(f"{k}.jpg") for k in range(18)]
    took = iter([(9.0, 2.0), (8.0, 5.0), (4.0, 3.0), (12.0, 4.0)])  # two, all; two, all
    monkeypatch.setattr(archive_cost, "_timed", lambda *_: next(took))
    assert archive_cost.batch_cost(photos, 1, 2) == Cost(0.25, 0.125, 2.25)


def test_too_few_photos_are_refused() -> None:
    with pytest.raises(SettingsError, match="0 photos are too few"):
        measure_archive((), 2, 1)


def test_the_loop_does_the_work_that_the_batch_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    photos, alone, together = (tmp_path / name for name in ("photos", "alone", "together"))
    photos.mkdir()
    portrait = Image.fromarray(np.rint(255 * grace_hopper()).astype(np.uint8))
    portrait.save(photos / "face.png")
    write_noise(photos / "no face.png")
    names = b"\0".join(os.fsencode(path) for path in sorted(photos.iterdir()))
    monkeypatch.setattr("sys.stdin", TextIOWrapper(BytesIO(names)))
    monkeypatch.setattr("sys.argv", ["-c", str(alone)])
    calibrate_loop()
    run = ["batch", str(photos), "-o", str(together), "--jobs", "1"]
    assert CliRunner().invoke(main, run).exit_code == 0
    made = {path.name: path.read_bytes() for path in alone.iterdir()}
    assert set(made) == {f"face.png.{end}" for end in ("spi1d", "cube", "clf", "crf.json")}
    assert made == {name: (together / name).read_bytes() for name in made}


@pytest.mark.slow
def test_the_command_times_all_four_and_leaves_nothing(tmp_path: Path) -> None:
    for seed in range(8):
        write_noise(tmp_path / f"{seed}.png", seed=seed)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    result = CliRunner().invoke(main, ["bench", "archive", str(tmp_path), "--repeat", "1"])
    assert result.exit_code == 0, result.output
    rates = re.findall(r"([\d.]+) photos/s with starting", result.output)
    assert len(rates) == 4
    assert all(float(rate) > 0 for rate in rates)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.slow
def test_a_photo_that_cannot_be_read_ends_it_in_one_line(tmp_path: Path) -> None:
    for seed in range(8):
        (tmp_path / f"{seed}.png").write_bytes(b"no photo")
    result = CliRunner().invoke(main, ["bench", "archive", str(tmp_path), "--repeat", "1"])
    assert result.exit_code != 0
    assert "a command of the benchmark failed" in result.output
    assert "is not an image that can be read" in result.output
