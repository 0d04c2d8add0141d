"""What a second run, a second path or another time of change does not make us do again."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from archive_photos import files, table
from command_line import write_noise

from facecrf_ocio.files import folders


def batch(facecrf, source, output, *more):
    options = ("--estimator", "mean", "--formats", "spi1d", "--jobs", "2")
    ended = facecrf("batch", source, "-o", output, *options, *more)
    assert ended.code == 0, ended.err
    return ended


def test_photos_of_the_same_bytes_are_calibrated_once(facecrf, tmp_path):
    source, output, alone = (tmp_path / name for name in ("photos", "luts", "alone"))
    (source / "sub").mkdir(parents=True)
    write_noise(source / "a.png", seed=1)
    for name in ("b.png", "sub/c.png"):
        shutil.copy(source / "a.png", source / name)
    write_noise(source / "d.png", seed=2)
    batch(facecrf, source, output)
    rows = table(output, "SELECT name, duplicate_of, estimate_s > 0 FROM photos")
    assert {name: first for name, first, _ in rows} == {
        "a.png": "",
        "b.png": "a.png",
        "d.png": "",
        "sub/c.png": "a.png",
    }
    assert sum(estimated for *_, estimated in rows) == 2
    # Each on its own gets the same files, to the byte.
    single = {}
    for name in ("a.png", "b.png", "sub/c.png", "d.png"):
        batch(facecrf, source, alone / name, "--include", name)
        single.update(files(alone / name))
    assert files(output) == single


def test_a_duplicate_of_an_altered_result_is_calibrated_itself(facecrf, tmp_path):
    source, output = tmp_path / "photos", tmp_path / "luts"
    source.mkdir()
    write_noise(source / "a.png", seed=1)
    batch(facecrf, source, output)
    record = output / "a.png.crf.json"
    record.write_bytes(record.read_bytes().replace(b'"fallback"', b'"calibrated"'))
    shutil.copy(source / "a.png", source / "b.png")
    batch(facecrf, source, output)
    outcomes = dict(table(output, "SELECT name, outcome FROM photos"))
    assert outcomes["b.png"] == "fallback"
    assert b'"calibrated"' not in files(output)["b.png.crf.json"]


def test_a_photo_of_which_only_the_time_changed_is_not_done_again(facecrf, tmp_path):
    source, output = tmp_path / "photos", tmp_path / "luts"
    source.mkdir()
    write_noise(source / "same.png", seed=1)
    write_noise(source / "other.bmp", seed=2)
    batch(facecrf, source, output)
    marks = {path.name: path.stat().st_mtime_ns for path in output.glob("*.spi1d")}
    write_noise(source / "other.bmp", seed=3)  # a BMP of the same size, to the byte
    for path in source.iterdir():
        os.utime(path, ns=(5, 5))
    ended = batch(facecrf, source, output)
    assert "1 done before" in ended.err
    again = {p.name for p in output.glob("*.spi1d") if p.stat().st_mtime_ns != marks[p.name]}
    assert again == {"other.bmp.spi1d"}
    assert table(output, "SELECT DISTINCT mtime_ns FROM photos") == [(5,)]
    assert "2 done before" in batch(facecrf, source, output).err


def test_every_new_folder_is_flushed_into_the_one_that_holds_it(tmp_path, monkeypatch):
    flushed = []
    real = os.fsync

    def fsync(descriptor):
        flushed.append(str(Path(f"/proc/self/fd/{descriptor}").readlink()))
        real(descriptor)

    monkeypatch.setattr(os, "fsync", fsync)
    folders.make_folder(tmp_path / "a" / "b" / "c")
    assert (tmp_path / "a" / "b" / "c").is_dir()
    assert flushed == [str(tmp_path), str(tmp_path / "a"), str(tmp_path / "a" / "b")]
    folders.make_folder(tmp_path / "a" / "b")
    assert len(flushed) == 3


def test_photos_that_failed_before_are_told_with_what_tries_them_again(facecrf, tmp_path):
    source, output = tmp_path / "photos", tmp_path / "luts"
    source.mkdir()
    (source / "a.png").write_bytes(b"no picture")
    told = "1 photo failed in an earlier run; --retry tries again"
    how = ("batch", source, "-o", output, "--estimator", "mean", "--jobs", "1")
    assert told not in facecrf(*how).err
    assert told in facecrf(*how).err
    assert told not in facecrf(*how, "--retry").err


def test_a_folder_without_photos_is_told(facecrf, tmp_path):
    (tmp_path / "photos").mkdir()
    ended = batch(facecrf, tmp_path / "photos", tmp_path / "luts")
    assert (ended.code, ended.err) == (0, "no photos found\n")
    again = facecrf("batch", tmp_path / "photos", "-o", tmp_path / "photos")
    assert "is the folder of the photos; write to one of its own" in again.err
