"""What cannot be looked at is listed with the reason, and the rest of the archive is done."""

from __future__ import annotations

import os
import sqlite3
from pathlib import Path

import pytest
from command_line import write_noise

from facecrf_ocio.archive.manifest.connection import FILE

OPTIONS = ("--estimator", "mean", "--formats", "spi1d", "--jobs", "1")
LINKS = ("gone.jpg", "loop.jpg")


@pytest.fixture
def source(tmp_path: Path) -> Path:
    source = tmp_path / "photos"
    (source / "locked").mkdir(parents=True)
    write_noise(source / "a.png", seed=1)
    write_noise(source / "locked" / "b.png", seed=2)
    return source


@pytest.fixture
def lock(monkeypatch: pytest.MonkeyPatch):
    """Take away the permission to list a folder, which the superuser of a test would not miss."""
    scandir = os.scandir

    def locked(folder: Path):
        def refuse(path):
            if Path(path) == folder:
                raise PermissionError(13, "Permission denied", str(path))
            return scandir(path)

        monkeypatch.setattr(os, "scandir", refuse)

    return locked


def reasons(output: Path) -> dict[str, str]:
    base = sqlite3.connect(output / FILE)
    found = dict(base.execute("SELECT name, reason FROM photos WHERE outcome = 'failed'"))
    base.close()
    return found


def remedies(output: Path) -> set[str]:
    base = sqlite3.connect(output / FILE)
    found = {row[0] for row in base.execute("SELECT remedy FROM photos WHERE outcome = 'failed'")}
    base.close()
    return found


def told(err: str) -> list[str]:
    return [line for line in err.splitlines() if line.startswith("facecrf: ")]


def test_a_folder_that_cannot_be_read_costs_its_own_photos(
    facecrf, source, tmp_path, lock, monkeypatch
):
    run = ("batch", source, "-o", tmp_path / "luts", *OPTIONS)
    line = (
        "facecrf: locked: failed: is a folder that cannot be read: permission denied; "
        "allow reading it, or leave it out with --exclude"
    )
    lock(source / "locked")
    ended = facecrf(*run)
    assert (ended.code, told(ended.err)) == (3, [line])
    assert (tmp_path / "luts" / "a.png.spi1d").exists()
    assert set(reasons(tmp_path / "luts")) == {"locked"}
    assert remedies(tmp_path / "luts") == {"allow reading it, or leave it out with exclude=..."}
    assert facecrf("report", tmp_path / "luts").code == 0
    page = (tmp_path / "luts" / "facecrf-report.html").read_text(encoding="utf-8")
    assert "allow reading it, or leave it out with --exclude (of `facecrf batch`)" in page
    assert told(facecrf(*run).err) == [line]
    assert told(facecrf(*run, "--exclude", "locked").err) == []
    # With the permission given it is gone from the list, and its photo is done.
    monkeypatch.undo()
    ended = facecrf(*run)
    assert told(ended.err) == []
    assert "2 of 2 photos (1 done before)" in ended.err
    assert reasons(tmp_path / "luts") == {}
    assert (tmp_path / "luts" / "locked" / "b.png.spi1d").exists()


def test_photos_done_before_their_folder_was_locked_stay_done(facecrf, source, tmp_path, lock):
    run = ("batch", source, "-o", tmp_path / "luts", *OPTIONS)
    assert facecrf(*run).code == 0
    lock(source / "locked")
    assert set(reasons(tmp_path / "luts")) == set()
    assert len(told(facecrf(*run).err)) == 1
    assert facecrf("verify", tmp_path / "luts").code == 0
    assert (tmp_path / "luts" / "locked" / "b.png.spi1d").exists()


def test_a_source_that_cannot_be_read_is_told_in_one_line(facecrf, source, tmp_path, lock):
    lock(source)
    ended = facecrf("batch", source, "-o", tmp_path / "luts", *OPTIONS)
    assert (ended.code, ended.err) == (
        3,
        f"facecrf: {source}: cannot be read: permission denied; "
        "mount it, or allow reading it, and start again\n",
    )


def test_outputs_that_cannot_be_written_are_told_in_one_line(
    facecrf, source, tmp_path, monkeypatch
):
    (tmp_path / "luts").mkdir()
    real = os.open

    def refuse(path, *args, **kwargs):
        if Path(path).parent == tmp_path / "luts":
            raise PermissionError(13, "Permission denied", str(path))
        return real(path, *args, **kwargs)

    monkeypatch.setattr(os, "open", refuse)
    ended = facecrf("batch", source, "-o", tmp_path / "luts", *OPTIONS)
    assert (ended.code, ended.err) == (
        1,
        f"facecrf: {tmp_path / 'luts'}: cannot be written: permission denied; "
        "choose a folder you may write to\n",
    )


@pytest.mark.parametrize("limit", [("--timeout", "0"), ("--memory", "0"), ("--timeout", "-1")])
def test_limits_that_no_photo_can_keep_are_wrong_usage(facecrf, source, tmp_path, limit):
    assert facecrf("batch", source, "-o", tmp_path / "luts", *OPTIONS, *limit).code == 2


def test_links_that_lead_nowhere_are_listed_and_other_things_passed_over(facecrf, source, tmp_path):
    (source / "gone.jpg").symlink_to("nowhere.jpg")
    (source / "loop.jpg").symlink_to("loop.jpg")
    (source / "up").symlink_to("..")
    (source / "folder.jpg").mkdir()
    os.mkfifo(source / "pipe.jpg")
    ended = facecrf("batch", source, "-o", tmp_path / "luts", *OPTIONS)
    problem = "is a link that leads nowhere; restore what it leads to, or remove it"
    assert told(ended.err) == [f"facecrf: {name}: failed: {problem}" for name in LINKS]
    assert set(reasons(tmp_path / "luts")) == set(LINKS)
    assert "4 of 4 photos" in ended.err
    assert "not followed, 1 link to folders: up; run batch on what they lead to" in ended.err
    # What it leads to is back: the photo is done as any other.
    write_noise(source / "nowhere.png", seed=3).rename(source / "nowhere.jpg")
    facecrf("batch", source, "-o", tmp_path / "luts", *OPTIONS)
    assert (tmp_path / "luts" / "gone.jpg.spi1d").exists()
    assert set(reasons(tmp_path / "luts")) == {"loop.jpg"}


def test_a_link_whose_photo_was_done_keeps_its_outputs(facecrf, source, tmp_path):
    (source / "a.png").rename(tmp_path / "elsewhere.png")
    (source / "a.png").symlink_to(tmp_path / "elsewhere.png")
    run = ("batch", source, "-o", tmp_path / "luts", *OPTIONS)
    assert facecrf(*run).code == 0
    (tmp_path / "elsewhere.png").unlink()
    assert facecrf(*run).code == 0
    assert (tmp_path / "luts" / "a.png.spi1d").exists()
    assert reasons(tmp_path / "luts") == {}


def test_a_listed_name_without_a_photo_is_told(facecrf, source, tmp_path):
    names = tmp_path / "names"
    names.write_text("a.png\nb.png\nlocked\n", encoding="utf-8")
    run = ("batch", source, "-o", tmp_path / "luts", *OPTIONS, "--files-from", names)
    assert told(facecrf(*run).err) == [
        "facecrf: b.png: failed: is not there; correct its name, or start again",
        "facecrf: locked: failed: is a folder; name the photos in it",
    ]


def test_names_that_are_not_utf8_end_neither_a_run_nor_a_check(facecrf, source, tmp_path):
    odd = source / os.fsdecode(b"caf\xe9.jpg")
    try:
        odd.write_bytes((source / "a.png").read_bytes()[:-1] + b"x")
    except OSError:
        pytest.skip("this file system takes no such names")
    ended = facecrf("batch", source, "-o", tmp_path / "luts", *OPTIONS)
    assert ended.code == 3
    assert told(ended.err) == [
        r"facecrf: caf\xe9.jpg: failed: has a name that is not UTF-8 text; rename it"
    ]
    assert "3 of 3 photos" in ended.err
    (tmp_path / "luts" / os.fsdecode(b"caf\xe9.txt")).touch()
    ended = facecrf("verify", tmp_path / "luts")
    assert (ended.code, ended.out) == (1, "extra: caf\\xe9.txt\n")
    assert facecrf("report", tmp_path / "luts").code == 0


def test_a_failure_without_a_path_of_its_own_tells_what_to_do(facecrf, source, tmp_path):
    ended = facecrf("batch", source, "-o", tmp_path / "luts", *OPTIONS, "--memory", "1")
    assert told(ended.err) == [
        f"facecrf: {name}: failed: needed more than 1 MB of memory and was stopped; "
        "use a smaller version of it, or raise --memory and pass --retry"
        for name in ("a.png", "locked/b.png")
    ]
    advice = "use a smaller version of it, or raise megabytes=... and pass retry=True"
    assert remedies(tmp_path / "luts") == {advice}


def test_a_check_changes_nothing_and_goes_on_where_a_file_cannot_be_read(
    facecrf, source, tmp_path, monkeypatch
):
    output = tmp_path / "luts"
    assert facecrf("batch", source, "-o", output, *OPTIONS).code == 0
    (output / "locked" / "b.png.crf.json").unlink()
    before = {path: path.read_bytes() for path in files_in(output)}
    real = Path.open

    def refuse(path, *args, **kwargs):
        if path.name == "a.png.spi1d":
            raise OSError(5, "Input/output error", str(path))
        return real(path, *args, **kwargs)

    monkeypatch.setattr(Path, "open", refuse)
    ended = facecrf("verify", output)
    assert ended.code == 1
    assert ended.out == "unreadable: a.png.spi1d\nmissing: locked/b.png.crf.json\n"
    monkeypatch.undo()
    assert {path: path.read_bytes() for path in files_in(output)} == before


def files_in(output: Path) -> list[Path]:
    """All files but those of SQLite's journal."""
    return [path for path in output.rglob("*") if path.is_file() and "-" not in path.suffix]
