"""Photos that nothing was written for: each ends in a result or in one line that tells why."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import table
from command_line import CommandLine
from odd_files import odd_photos
from workers_here import workers_here  # noqa: F401 - a fixture

pytestmark = pytest.mark.slow
PHOTOS = odd_photos()
DONE, UNREADABLE, NOTHING = 0, 3, 4
# What must be read, and which way up: these are upright at 32 by 24 pixels.
UPRIGHT = ("exif orientation_0.jpg", "exif orientation_65535.jpg", "xmp xmp_arabic.jpg")
TURNED = ("exif orientation_long.jpg", "exif big_endian.jpg", "xmp xmp_other_prefix.jpg")
WHOLE = ("jpeg zeros_between.jpg", "jpeg stray_before_frame.jpg", "jpeg end_cut.jpg")


def told(err: str) -> list[str]:
    return [line for line in err.splitlines() if line.startswith("facecrf: ")]


@pytest.mark.parametrize("name", PHOTOS)
def test_each_is_read_or_told_in_one_line(facecrf: CommandLine, tmp_path: Path, name: str) -> None:
    path, exr = tmp_path / name, tmp_path / "a.exr"
    path.write_bytes(PHOTOS[name])
    how = ("--estimator", "mean", "--formats", "spi1d", "-o", tmp_path / "luts")
    ended = facecrf("calibrate", path, *how)
    assert ended.code in (DONE, UNREADABLE, NOTHING)
    assert "please report this" not in ended.err
    assert len(told(ended.err)) == (ended.code != DONE)
    assert facecrf("linearize", path, "--estimator", "srgb", "-o", exr).code in (
        (DONE,) if ended.code != UNREADABLE else (UNREADABLE,)
    )
    if exr.exists():
        light = oiio.ImageBuf(str(exr))
        assert np.isfinite(light.get_pixels(oiio.FLOAT)).all()
        chromaticities = light.spec().getattribute("chromaticities")
        assert chromaticities is None or np.isfinite(chromaticities).all()
        size = light.spec().width, light.spec().height
        assert name not in UPRIGHT or size == (32, 24)
        assert name not in TURNED or size == (24, 32)
    assert name not in (*UPRIGHT, *TURNED, *WHOLE) or exr.exists()


@pytest.mark.usefixtures("workers_here")
def test_a_batch_lists_them_all(facecrf: CommandLine, tmp_path: Path) -> None:
    source, luts, listed = tmp_path / "photos", tmp_path / "luts", tmp_path / "list.csv"
    source.mkdir()
    for name, content in PHOTOS.items():
        (source / name).write_bytes(content)
    how = ("--estimator", "mean", "--formats", "spi1d", "--exr", "--csv", listed)
    ended = facecrf("batch", source, "-o", luts, *how)
    assert ended.code == UNREADABLE
    assert "please report this" not in ended.err
    with listed.open(encoding="utf-8", newline="") as rows:
        outcomes = {row["name"]: row for row in csv.DictReader(rows)}
    passed_over = {name for name in PHOTOS if name.endswith(".svg")}
    assert set(outcomes) == set(PHOTOS) - passed_over
    for name, row in outcomes.items():
        assert (row["outcome"] == "failed") == bool(row["remedy"]) or row["outcome"], name
    assert facecrf("verify", luts).code == 0
    assert facecrf("report", luts).code == 0
    assert table(luts, "SELECT COUNT(*) FROM photos WHERE state != 'done'") == [(0,)]
