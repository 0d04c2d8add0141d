"""Exposures that are not what was told of them: which photo's, by which curve, and what merges."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from archive_photos import exposed, write_picture
from command_line import CommandLine
from photo_files import pixels_of
from test_archive_merge import scene

from facecrf_ocio.archive.place import Place
from facecrf_ocio.archive.task import MERGE, MERGED, NOT_MERGED, Recipe, Series, Task
from facecrf_ocio.archive.work.one_bracket import merged
from facecrf_ocio.pair.calibrate_bracket import calibrate_bracket
from facecrf_ocio.pair.merge_exposures import merge_exposures
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.record.calibration_record import write_record
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import gamma_curve
from facecrf_ocio.values import Estimate, Outcome

CURVE = gamma_curve(2.2)
KNOWN = Estimate(Outcome.CALIBRATED, "chart", "", found=CURVE)


def shots(folder, stops):
    """A photo for each exposure, as EXIF tells it."""
    return [
        write_picture(folder / f"{n}.jpg", scene() * np.float32(2.0**s), CURVE, **exposed(n, s))
        for n, s in enumerate(stops)
    ]


def record(photo):
    return write_record(photo.parent / "known.crf.json", read_photo(photo), KNOWN, Settings())


def false_of(photos, told, curve):
    solved = calibrate_bracket(photos, told)
    return merge_exposures(solved, curve).false


def test_the_photo_of_a_false_time_is_named_and_what_is_told_to_do_helps(capfd, tmp_path):
    photos, run = shots(tmp_path, (-3, -2, -1, 0, 1)), CommandLine(capfd)
    target = tmp_path / "hdr.exr"
    how = ("-o", target, "--overwrite")
    ended = run("merge", *photos, *how, "--stops", "-3,-1,-1,0,1")
    assert ended.code == 0
    assert "1.jpg was exposed 1.0 stops less than is told of it" in ended.err
    assert "another scene" not in ended.err
    told = re.search(r"run again without it, or with --stops (\S+)", ended.err)[1]
    again = run("merge", *photos, *how, "--stops", told)
    assert (again.code, again.err) == (0, "")
    off = np.log2(np.maximum(pixels_of(target), 1e-6) / scene()).mean(axis=2)[8::16, 8::16]
    assert np.std(off) < 0.05
    without = run("merge", *(p for p in photos if p.name != "1.jpg"), *how)
    assert (without.code, without.err) == (0, "")


@pytest.mark.parametrize("photo", [0, 1, 2])
@pytest.mark.parametrize("off", [-2.0, -1.0, 1.0])
def test_of_three_photos_a_curve_that_is_known_names_one(tmp_path, photo, off):
    real = np.array([-2.0, 0.0, 2.0])
    photos, told = shots(tmp_path, real), real - off * (np.arange(3) == photo)
    how = "more" if off > 0 else "less"
    expected = f"{photo}.jpg was exposed {abs(off):.1f} stops {how} than is told of it"
    assert false_of(photos, told, CURVE).startswith(expected)


@pytest.mark.parametrize("gamma", [1.8, 2.2, 2.6])
@pytest.mark.parametrize("stops", [(-2, 0), (-2, 0, 2), (-2, -1, 0, 1)])
def test_none_is_named_where_times_are_true_whatever_the_curve(tmp_path, stops, gamma):
    assert false_of(shots(tmp_path, stops), np.array(stops, float), gamma_curve(gamma)) == ""


@pytest.mark.parametrize("curve", ["auto", "bracket", "known"])
@pytest.mark.parametrize("told", ["2,0,-2", "0,-2,2"])
def test_an_order_that_the_photos_deny_is_not_merged_by_any_curve(capfd, tmp_path, curve, told):
    photos, target = shots(tmp_path, (-2, 0, 2)), tmp_path / "hdr.exr"
    curve = record(photos[0]) if curve == "known" else curve
    ended = CommandLine(capfd)("merge", *photos, "-o", target, "--stops", told, "--curve", curve)
    assert ended.code == 4
    assert "not merged: photos that are told as exposed more are darker" in ended.err
    assert ended.err.rstrip().endswith("check the order and the signs of the exposures (--stops)")
    assert not target.exists()


def test_a_record_merges_what_is_as_told(capfd, tmp_path):
    photos, target = shots(tmp_path, (-2, 0, 2)), tmp_path / "hdr.exr"
    ended = CommandLine(capfd)("merge", *photos, "-o", target, "--curve", record(photos[0]))
    assert (ended.code, ended.err) == (0, "")
    assert target.is_file()


def test_a_batch_merges_no_bracket_with_a_false_time_and_says_whose(tmp_path):
    stops = (-2.0, -1.0, 0.0, 1.0)
    paths = tuple(shots(tmp_path / "photos", stops))
    (tmp_path / "luts").mkdir()
    place, hashes = Place.of(tmp_path / "luts"), tuple(read_photo(p).sha256 for p in paths)
    task = Task(Path(paths[0]), paths[0].name, place, Recipe(), step=MERGE, estimate=KNOWN)

    def outcome(told):
        return merged(replace(task, series=Series(paths, hashes, told, False)))

    result, written = outcome((-2.0, -1.0, 1.0, 1.0))
    assert (result.outcome, written) == (NOT_MERGED, None)
    assert result.reason.startswith("2.jpg was exposed 1.0 stops less than is told of it")
    assert "by `facecrf merge`" in result.remedy
    assert list((tmp_path / "luts").iterdir()) == []
    result, written = outcome(stops[::-1])
    assert result.outcome == NOT_MERGED
    assert "check the order" in result.reason
    assert outcome(stops)[0].outcome == MERGED
