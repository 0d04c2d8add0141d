"""Archives: every photo accounted for, whatever happens to the photo, the disk or the run."""

from __future__ import annotations

import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest
from archive_photos import files
from command_line import CODE, names_in, write_noise

from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.archive.manifest.database import Manifest, Stamp
from facecrf_ocio.archive.place import Place
from facecrf_ocio.archive.task import Recipe, Result, Task
from facecrf_ocio.archive.work.processes import Limits, Workers

COLUMNS = "name, size, sha256, recipe, state, outcome, verdict, estimator, reason, remedy, make"


@pytest.fixture
def archive(tmp_path):
    """Good, of one stem, in a folder, oddly named, duplicate, cut short, empty, no photo."""
    source = tmp_path / "photos"
    (source / "sub").mkdir(parents=True)
    write_noise(source / "a.jpg", seed=1)
    write_noise(source / "a.png", seed=2)
    write_noise(source / "sub" / "two words ü.tif", seed=3)
    shutil.copy(source / "a.png", source / "sub" / "copy.png")
    (source / "cut.png").write_bytes((source / "a.png").read_bytes()[:200])
    (source / "empty.jpg").touch()
    (source / "notes.txt").write_text("no photo", encoding="utf-8")
    return source


def batch(facecrf, source, output, *more):
    options = ("--estimator", "mean", "--formats", "spi1d", "--jobs", "2")
    return facecrf("batch", source, "-o", output, *options, *more)


def rows(folder: Path, columns: str = COLUMNS):
    base = sqlite3.connect(folder / FILE)
    try:
        return base.execute(f"SELECT {columns} FROM photos ORDER BY name").fetchall()  # noqa: S608
    finally:
        base.close()


def test_every_photo_is_accounted_for_and_the_originals_stay(facecrf, archive, tmp_path):
    before = files(archive)
    output = tmp_path / "luts"
    ended = batch(facecrf, archive, output)
    assert ended.code == 3  # two photos failed
    outcomes = dict(rows(output, "name, outcome"))
    good = {"a.jpg", "a.png", "sub/two words ü.tif", "sub/copy.png"}
    assert {name for name, outcome in outcomes.items() if outcome == "fallback"} == good
    assert {n for n, o in outcomes.items() if o == "failed"} == {"cut.png", "empty.jpg"}
    assert set(files(output)) == {f"{n}.{s}" for n in good for s in ("spi1d", "crf.json")}
    assert files(archive) == before
    assert "empty.jpg: failed" in ended.err
    assert "zero bytes" in ended.err


def test_verify_finds_what_is_missing_altered_and_extra(facecrf, archive, tmp_path):
    output = tmp_path / "luts"
    batch(facecrf, archive, output)
    assert facecrf("verify", output).code == 0
    (output / "a.jpg.spi1d").unlink()
    with (output / "a.png.spi1d").open("a") as lut:
        lut.write("\n")
    (output / "sub" / "mine.txt").touch()
    ended = facecrf("verify", output)
    assert ended.code == 1
    told = set(ended.out.splitlines())
    assert told == {"missing: a.jpg.spi1d", "altered: a.png.spi1d", "extra: sub/mine.txt"}
    assert "2 files are not as they were written, 1 file is extra" in ended.err


def test_a_second_run_redoes_only_what_changed(facecrf, archive, tmp_path):
    output = tmp_path / "luts"
    batch(facecrf, archive, output)
    marks = {path: path.stat().st_mtime_ns for path in output.rglob("*.spi1d")}
    write_noise(archive / "a.jpg", seed=9)
    os.utime(archive / "a.jpg", ns=(1, 1))
    ended = batch(facecrf, archive, output)
    assert "5 done before" in ended.err
    changed = {path.name for path, mark in marks.items() if path.stat().st_mtime_ns != mark}
    assert changed == {"a.jpg.spi1d"}
    assert facecrf("verify", output).code == 0


def test_other_settings_redo_all_and_take_away_what_is_no_longer_written(
    facecrf, archive, tmp_path
):
    output = tmp_path / "luts"
    batch(facecrf, archive, output)
    batch(facecrf, archive, output, "--formats", "cube")
    assert {Path(n).suffix for n in files(output)} == {".cube", ".json"}
    assert facecrf("verify", output).code == 0


def test_a_file_in_the_way_is_not_replaced_unless_asked(facecrf, archive, tmp_path):
    output = tmp_path / "luts"
    output.mkdir()
    (output / "a.jpg.spi1d").write_text("mine", encoding="utf-8")
    assert "exists already" in batch(facecrf, archive, output).err
    assert (output / "a.jpg.spi1d").read_text(encoding="utf-8") == "mine"
    batch(facecrf, archive, output, "--overwrite")
    assert (output / "a.jpg.spi1d").read_text(encoding="utf-8") != "mine"
    assert facecrf("verify", output).code == 0


@pytest.mark.parametrize(("source", "output"), [("p", "p"), ("p", "p/luts"), ("p/sub", "p")])
def test_outputs_among_the_photos_are_refused(facecrf, tmp_path, source, output):
    (tmp_path / "p" / "sub").mkdir(parents=True)
    before = names_in(tmp_path / "p")
    ended = batch(facecrf, tmp_path / source, tmp_path / output)
    assert ended.code == 1
    assert ("is the folder of the photos" if source == output else "lies inside") in ended.err
    assert names_in(tmp_path / "p") == before


@pytest.mark.parametrize("gone", ["emptied", "removed"])
def test_a_vanished_source_stops_the_run_and_nothing_is_called_deleted(
    facecrf, archive, tmp_path, gone
):
    output = tmp_path / "luts"
    batch(facecrf, archive, output)
    before = rows(output)
    shutil.rmtree(archive)
    if gone == "emptied":
        archive.mkdir()
    ended = batch(facecrf, archive, output)
    assert ended.code == 3
    assert "mount it" in ended.err
    assert rows(output) == before
    assert facecrf("verify", output).code == 0


def test_globs_and_lists_choose_photos(facecrf, archive, tmp_path):
    batch(facecrf, archive, tmp_path / "one", "--include", "*.PNG", "--exclude", "sub")
    assert [name for (name,) in rows(tmp_path / "one", "name")] == ["a.png", "cut.png"]
    names = tmp_path / "list"
    names.write_bytes(b"a.jpg\0sub/copy.png\0")
    batch(facecrf, archive, tmp_path / "two", "--files-from", names, "-0")
    assert [name for (name,) in rows(tmp_path / "two", "name")] == ["a.jpg", "sub/copy.png"]


def answers(workers: Workers, task: Task):
    workers.submit(task)
    while workers.busy:
        yield from workers.results()


@pytest.fixture
def task(archive, tmp_path):
    recipe = Recipe("mean", formats=("spi1d",))
    (tmp_path / "o").mkdir()
    return Task(archive / "a.jpg", "a.jpg", Place.of(tmp_path / "o"), recipe, overwrite=True)


def test_a_photo_whose_process_crashes_is_tried_once_more(task):
    with Workers(1, Limits()) as workers:
        workers.submit(task)
        workers._workers[0].process.kill()
        ((_, result),) = workers.results()
        assert result.outcome == "fallback"


def test_a_worker_that_is_starting_is_deaf_to_ctrl_c(task):
    with Workers(1, Limits()) as workers:
        workers.submit(task)
        process = workers._workers[0].process
        os.kill(process.pid, signal.SIGINT)
        ((_, result),) = workers.results()
        assert result.outcome == "fallback"
        assert workers._workers[0].process is process


def test_a_photo_that_crashes_twice_is_listed_and_the_next_one_is_done(task, monkeypatch):
    with Workers(1, Limits()) as workers:
        hire = workers._hire

        def hire_to_die():
            worker = hire()
            worker.process.kill()
            return worker

        with monkeypatch.context() as crashing:
            crashing.setattr(workers, "_hire", hire_to_die)
            ((_, result),) = answers(workers, task)
        assert "crashed the process that read it, twice (SIGKILL)" in result.reason
        ((_, result),) = answers(workers, task)
        assert result.outcome == "fallback"


def test_a_photo_that_hangs_is_stopped_and_the_next_one_is_done(task):
    with Workers(1, Limits(seconds=2)) as workers:
        list(answers(workers, task))
        os.kill(workers._workers[0].process.pid, signal.SIGSTOP)
        ((_, result),) = answers(workers, task)
        assert "took longer than 2 s" in result.reason
        ((_, result),) = answers(workers, task)
        assert result.outcome == "fallback"


def test_a_photo_that_needs_too_much_memory_is_stopped(task):
    with Workers(1, Limits(megabytes=1)) as workers:
        ((_, result),) = answers(workers, task)
        assert "more than 1 MB" in result.reason


def test_resume_decides_on_a_hundred_thousand_rows_in_seconds(tmp_path):
    manifest = Manifest(tmp_path)
    stamp = Stamp(1, 2, "recipe")
    with manifest.transaction():
        for number in range(100_000):
            manifest.finish(f"{number:06d}.jpg", stamp, Result("calibrated", "weak"))
    begin = time.process_time()
    assert all(manifest.known(f"{n:06d}.jpg").stamp == stamp for n in range(100_000))
    assert time.process_time() - begin < 10
    manifest.close()


def done_in(folder: Path) -> int:
    """Photos that the manifest calls done; 0 before it is there."""
    if not (folder / FILE).exists():
        return 0
    try:
        return sum(state == "done" for (state,) in rows(folder, "state"))
    except sqlite3.OperationalError:  # its tables are not there yet
        return 0


def wait_for_more(folder: Path, count: int, process: subprocess.Popen[bytes]) -> None:
    """Until so many are done; by progress, since a busy machine takes longer for it."""
    end = time.monotonic() + 120
    while done_in(folder) < count and process.poll() is None and time.monotonic() < end:
        time.sleep(0.02)


@pytest.mark.slow
def test_killed_twenty_times_and_resumed_it_is_the_same_as_unbroken(facecrf, tmp_path):
    source, whole, broken = (tmp_path / name for name in ("photos", "whole", "broken"))
    for number in range(300):
        folder = source / f"{number % 7}"
        folder.mkdir(parents=True, exist_ok=True)
        photo = write_noise(folder / f"n {number}.png", seed=number % 180)
        if number % 20 == 0:
            photo.write_bytes(photo.read_bytes()[:number])
    assert batch(facecrf, source, whole).code == 3
    assert len(rows(whole)) == 300
    command = [sys.executable, "-c", CODE, "batch", str(source), "-o", str(broken)]
    command += ["--estimator", "mean", "--formats", "spi1d", "--jobs", "2"]
    chance, done = random.Random(6), 0  # noqa: S311
    for number in range(20):
        process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        wait_for_more(broken, done + chance.randrange(14), process)
        time.sleep(chance.uniform(0.0, 0.1))  # anywhere between two photos
        process.send_signal(signal.SIGKILL)
        process.wait()
        before, done = done, done_in(broken)
        assert done >= before, number
    assert done > 0
    assert batch(facecrf, source, broken).code == 3
    assert rows(broken) == rows(whole)
    assert files(broken) == files(whole)
    assert facecrf("verify", broken).code == 0


def test_the_formats_are_those_of_calibrate_unless_others_are_asked_for(facecrf, archive, tmp_path):
    output = tmp_path / "luts"
    assert facecrf("batch", archive, "-o", output, "--estimator", "mean", "--jobs", "2").code == 3
    made = {name for name in files(output) if name.startswith("a.jpg")}
    assert made == {f"a.jpg.{ending}" for ending in ("spi1d", "cube", "clf", "crf.json")}


def test_directions_and_working_spaces_are_those_of_calibrate(facecrf, archive, tmp_path):
    output, alone = tmp_path / "luts", tmp_path / "alone"
    options = ("--estimator", "mean", "--formats", "clf,ctf", "--direction", "both")
    run = ("batch", archive, "-o", output, "--jobs", "2", *options)
    assert facecrf(*run, "--to", "acescg").code == 3
    ends = [f"acescg.{way}{name}" for way in ("", "encode.") for name in ("clf", "ctf")]
    made = {name for name in files(output) if name.startswith("a.jpg")}
    assert made == {f"a.jpg.{end}" for end in (*ends, "crf.json")}
    assert facecrf("verify", output).code == 0
    # The command for single photos names its files alike, and holds the same in them.
    calibrate = ("calibrate", archive / "a.jpg", "-o", alone, *options, "--to", "acescg")
    assert facecrf(*calibrate).code == 0
    for end in ends:
        assert (output / f"a.jpg.{end}").read_bytes() == (alone / f"a.jpg.{end}").read_bytes()
    # Another direction or space is another recipe: all is redone, and nothing former is left.
    ended = facecrf(*run)
    assert "done before" not in ended.err
    made = {name for name in files(output) if name.startswith("a.jpg")}
    plain = {f"a.jpg.{way}{name}" for way in ("", "encode.") for name in ("clf", "ctf")}
    assert made == {*plain, "a.jpg.crf.json"}
    assert facecrf("verify", output).code == 0
    (output / "a.jpg.encode.ctf").unlink()
    ended = facecrf("verify", output)
    assert (ended.code, ended.out) == (1, "missing: a.jpg.encode.ctf\n")


@pytest.mark.parametrize(
    "options",
    [("--formats", "cube", "--to", "acescg"), ("--formats", "icc", "--direction", "encode")],
)
def test_what_a_format_cannot_hold_is_wrong_usage(facecrf, archive, tmp_path, options):
    ended = facecrf("batch", archive, "-o", tmp_path / "luts", *options)
    assert ended.code == 2
    assert not (tmp_path / "luts").exists()


def test_a_file_in_the_way_of_an_encoding_lut_is_not_replaced(facecrf, archive, tmp_path):
    output = tmp_path / "luts"
    output.mkdir()
    (output / "a.jpg.encode.spi1d").write_text("mine", encoding="utf-8")
    ended = batch(facecrf, archive, output, "--direction", "both")
    assert "a.jpg.encode.spi1d: exists already" in ended.err
    assert (output / "a.jpg.encode.spi1d").read_text(encoding="utf-8") == "mine"
    assert not (output / "a.jpg.spi1d").exists()
