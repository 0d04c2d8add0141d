"""Nothing stops a batch, nothing lost stays lost, nothing is written where it does not belong."""

from __future__ import annotations

import csv
import errno
import json
import os
import shutil
import sqlite3
import subprocess
from pathlib import Path

import pytest
from archive_photos import files, table
from command_line import CommandLine, write_noise
from workers_here import WorkersHere, workers_here  # noqa: F401 - a fixture

from facecrf_ocio.archive import place
from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.archive.work import one_photo
from facecrf_ocio.errors import OutputError, PhotoError
from facecrf_ocio.photo.read import read_photo

pytestmark = pytest.mark.usefixtures("workers_here")
OPTIONS = ("--estimator", "mean", "--formats", "spi1d")


@pytest.fixture
def source(tmp_path: Path) -> Path:
    source = tmp_path / "photos"
    (source / "sub").mkdir(parents=True)
    write_noise(source / "a.png", seed=1)
    write_noise(source / "sub" / "b.png", seed=2)
    return source


@pytest.fixture
def batch(facecrf: CommandLine, source: Path, tmp_path: Path):
    def run(*more: str | Path, output: Path | None = None):
        return facecrf("batch", source, "-o", output or tmp_path / "luts", *OPTIONS, *more)

    return run


def told(err: str) -> list[str]:
    return [line for line in err.splitlines() if line.startswith("facecrf: ")]


def outcomes(folder: Path) -> dict[str, str]:
    return dict(table(folder, "SELECT name, outcome FROM photos"))


def change(folder: Path, *statements: str) -> None:
    base = sqlite3.connect(folder / FILE)
    with base:
        for statement in statements:
            base.execute(statement)
    base.close()


# --- The last net.


@pytest.mark.parametrize(
    "error",
    [
        RuntimeError("decoder \udce9 \x00 broke"),
        UnicodeDecodeError("utf-8", b"x\xe9", 1, 2, "odd"),
        AssertionError(),
        RecursionError("deep"),
        ZeroDivisionError("0/0"),
        KeyError("Make"),
    ],
)
def test_whatever_a_library_raises_is_that_photos_reason(batch, tmp_path, monkeypatch, error):
    def read(path):
        if path.name == "a.png":
            raise error
        return read_photo(path)

    monkeypatch.setattr(one_photo, "read_photo", read)
    ended = batch()
    assert ended.code == 3
    assert outcomes(tmp_path / "luts") == {"a.png": "failed", "sub/b.png": "fallback"}
    (line,) = told(ended.err)
    assert line.startswith(f"facecrf: a.png: failed: unexpected {type(error).__name__}")


def test_whatever_a_library_raises_costs_calibrate_that_photo_alone(
    facecrf, source, tmp_path, monkeypatch
):
    def read(path):
        if path.name == "a.png":
            raise RuntimeError("decoder \udce9 broke")
        return read_photo(path)

    monkeypatch.setattr("facecrf_ocio.read_photo", read, raising=False)
    photos = (source / "a.png", source / "sub" / "b.png")
    out = tmp_path / "out"
    ended = facecrf("calibrate", *photos, "-o", out, "--estimator", "mean", "--formats", "spi1d")
    assert ended.code == 3
    assert ended.err == (
        f"facecrf: {photos[0]}: unexpected RuntimeError: decoder é broke; please report this\n"
    )
    assert (out / "b.png.spi1d").is_file()


# --- Outputs that are lost come back.


def spoil(path: Path, how: str) -> None:
    if how == "gone":
        path.unlink()
    elif how == "cut":
        path.write_bytes(path.read_bytes()[:40])
    elif how == "edited":
        path.write_bytes(path.read_bytes().replace(b"From", b"Frim"))
    else:
        path.rename(path.with_name("kept"))
        path.symlink_to("kept")


@pytest.mark.parametrize("how", ["gone", "cut", "edited", "link"])
@pytest.mark.parametrize("name", ["a.png.spi1d", "a.png.crf.json"])
def test_an_output_that_is_not_as_it_was_is_made_again(batch, facecrf, tmp_path, how, name):
    luts = tmp_path / "luts"
    batch()
    before = files(luts)
    spoil(luts / name, how)
    if how == "edited" and name.endswith("json"):
        (luts / name).write_bytes(before[name].replace(b'"face', b'"fane', 1))
    ended = batch()
    assert "1 done before" in ended.err
    (luts / "kept").unlink(missing_ok=True)
    assert files(luts) == before
    assert facecrf("verify", luts).code == 0


def test_outputs_that_were_copied_are_known_by_their_bytes(batch, tmp_path):
    batch()
    shutil.copytree(tmp_path / "luts", tmp_path / "copy", copy_function=shutil.copyfile)
    times = {path: path.stat().st_mtime_ns for path in (tmp_path / "copy").rglob("*.spi1d")}
    assert "2 done before" in batch(output=tmp_path / "copy").err
    assert {path: path.stat().st_mtime_ns for path in times} == times


def test_repair_makes_again_what_only_its_hash_tells(batch, facecrf, tmp_path):
    luts = tmp_path / "luts"
    batch()
    before, lut = files(luts), luts / "a.png.spi1d"
    status = lut.stat()
    spoil(lut, "edited")
    os.utime(lut, ns=(status.st_atime_ns, status.st_mtime_ns))
    (luts / "sub" / "b.png.crf.json").unlink()
    ended = facecrf("verify", luts, "--json")
    assert ended.code == 1
    assert [json.loads(line) for line in ended.out.splitlines()] == [
        {"fault": "altered", "file": "a.png.spi1d", "photo": "a.png"},
        {"fault": "missing", "file": "sub/b.png.crf.json", "photo": "sub/b.png"},
        {"folder": str(luts), "exit_code": 1, "faults": 2},
    ]
    assert facecrf("verify", luts, "--repair").code == 0
    assert files(luts) == before


def test_repair_tells_what_it_cannot_make(batch, facecrf, source, tmp_path):
    luts = tmp_path / "luts"
    batch()
    (luts / "a.png.spi1d").unlink()
    (luts / "mine.txt").touch()
    change(luts, "UPDATE photos SET recipe = 'of another version' WHERE name = 'a.png'")
    ended = facecrf("verify", luts, "--repair")
    assert ended.code == 1
    assert "a.png: another version made its outputs; run the batch again" in ended.err
    assert ended.out.splitlines() == ["missing: a.png.spi1d", "extra: mine.txt"]


# --- What a batch tells.


def test_json_and_csv_tell_of_every_photo(batch, source, tmp_path):
    (source / "cut.png").write_bytes((source / "a.png").read_bytes()[:100])
    ended = batch("--json", "--csv", tmp_path / "all.csv")
    assert ended.code == 3
    records = {record["photo"]: record for record in map(json.loads, ended.out.splitlines())}
    assert {Path(name).name: record["exit_code"] for name, record in records.items()} == {
        "a.png": 0,
        "b.png": 0,
        "cut.png": 3,
    }
    assert records[str(source / "a.png")]["files"] == ["a.png.spi1d", "a.png.crf.json"]
    with (tmp_path / "all.csv").open(encoding="utf-8", newline="") as listed:
        rows = {row["name"]: row for row in csv.DictReader(listed)}
    assert {name: row["outcome"] for name, row in rows.items()} == outcomes(tmp_path / "luts")
    assert rows["a.png"]["outputs"] == "2"
    assert rows["cut.png"]["remedy"]
    # Going on replaces the list, and no file that is none.
    assert batch("--csv", tmp_path / "all.csv").code == 3
    (tmp_path / "mine.csv").write_text("mine", encoding="utf-8")
    assert batch("--csv", tmp_path / "mine.csv").code == 1
    assert (tmp_path / "mine.csv").read_text(encoding="utf-8") == "mine"


def test_folders_of_other_software_are_passed_over_and_what_is_not_looked_at_counted(
    batch, source, tmp_path
):
    for name in ("@eaDir", "#recycle", ".Trash-1000", "sub/@eaDir"):
        (source / name).mkdir()
        write_noise(source / name / "thumb.png", seed=3)
    (source / "film.mov").touch()
    (source / "notes.TXT").touch()
    ended = batch()
    assert set(outcomes(tmp_path / "luts")) == {"a.png", "sub/b.png"}
    assert "other software: #recycle (1), .Trash-1000 (1), @eaDir (2)" in ended.err
    assert "not looked at, by their names: 1 .mov, 1 .txt" in ended.err
    batch("--all-folders", output=tmp_path / "all")
    assert len(outcomes(tmp_path / "all")) == 6


@pytest.mark.parametrize("text", [b"a.png\r\nsub/b.png\r\n", b"\xef\xbb\xbfa.png\nsub/b.png"])
def test_lists_that_windows_wrote_are_read(batch, tmp_path, text):
    (tmp_path / "list").write_bytes(text)
    assert batch("--files-from", tmp_path / "list").code == 0
    assert set(outcomes(tmp_path / "luts")) == {"a.png", "sub/b.png"}


def test_a_list_that_holds_nul_is_wrong_usage(batch, tmp_path):
    (tmp_path / "list").write_bytes(b"a.png\0sub/b.png\0")
    ended = batch("--files-from", tmp_path / "list")
    assert (ended.code, "pass -0" in ended.err) == (2, True)


# --- Names.


def test_names_that_differ_in_bytes_have_different_keys(batch, source, tmp_path):
    photo = (source / "a.png").read_bytes()
    try:
        (source / os.fsdecode(b"caf\xe9.png")).write_bytes(photo[:-1] + b"x")
    except OSError:
        pytest.skip("this file system takes no such names")
    (source / r"caf\xe9.png").write_bytes(photo)
    batch()
    found = outcomes(tmp_path / "luts")
    assert len(found) == 4
    assert found[r"caf\x5cxe9.png"] == "fallback"
    assert (tmp_path / "luts" / r"caf\xe9.png.spi1d").is_file()
    assert batch().code == 3


def test_two_photos_never_write_one_file(batch, facecrf, source, tmp_path):
    shutil.copy(source / "a.png", source / "c")
    shutil.copy(source / "sub" / "b.png", source / "c.encode")
    ended = batch("--include", "c*", "--direction", "both")
    assert ended.code == 3
    (line,) = told(ended.err)
    assert line == (
        "facecrf: c.encode: failed: its output c.encode.spi1d would be the file c.encode.spi1d "
        "of c; rename one of them, or write them to two folders"
    )
    assert facecrf("verify", tmp_path / "luts").code == 0
    assert batch("--include", "c*", "--direction", "both").code == 3


def test_names_that_a_disk_takes_for_one_do_not_share_a_file(
    batch, facecrf, source, tmp_path, monkeypatch
):
    write_noise(source / "A.png", seed=5)
    monkeypatch.setattr(place, "_seen", lambda name, *_: name.casefold())
    ended = batch()
    assert ended.code == 3
    assert "a.png: failed: its output a.png.spi1d would be the file A.png.spi1d" in ended.err
    assert outcomes(tmp_path / "luts")["A.png"] == "fallback"


def test_the_longest_names_are_told_before_the_work_and_those_that_fit_are_done(
    batch, source, tmp_path
):
    fits, long = "f" * 242 + ".png", "l" * 251 + ".png"  # .crf.json has nine bytes
    shutil.copy(source / "a.png", source / fits)
    shutil.copy(source / "sub" / "b.png", source / long)
    ended = batch()
    found = outcomes(tmp_path / "luts")
    assert (found[fits], found[long]) == ("fallback", "failed")
    assert "9 more than the disk takes; shorten its name" in ended.err


# --- Files that are not the archive's own.


def test_a_foreign_file_is_kept_also_where_the_photo_that_may_replace_it_fails(
    batch, source, tmp_path
):
    luts = tmp_path / "luts"
    luts.mkdir()
    (luts / "cut.png.spi1d").write_text("mine", encoding="utf-8")
    (source / "cut.png").write_bytes((source / "a.png").read_bytes()[:100])
    assert batch("--overwrite").code == 3
    assert (luts / "cut.png.spi1d").read_text(encoding="utf-8") == "mine"


def test_the_advice_to_overwrite_is_enough(batch, facecrf, tmp_path):
    luts = tmp_path / "luts"
    luts.mkdir()
    (luts / "a.png.spi1d").write_text("mine", encoding="utf-8")
    assert "a.png.spi1d: exists already; pass --overwrite" in batch().err
    assert batch("--overwrite").code == 0
    assert facecrf("verify", luts).code == 0
    # So is taking it away.
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "a.png.spi1d").touch()
    assert batch(output=tmp_path / "other").code == 3
    (tmp_path / "other" / "a.png.spi1d").unlink()
    assert batch(output=tmp_path / "other").code == 0


@pytest.mark.skipif(os.name == "nt", reason="there are no pipes")
@pytest.mark.parametrize("put", [Path.mkdir, os.mkfifo], ids=["folder", "pipe"])
def test_what_is_no_file_in_an_outputs_place_is_told_until_it_is_gone(
    batch, facecrf, tmp_path, put
):
    assert batch().code == 0
    lut = tmp_path / "luts" / "a.png.spi1d"
    lut.unlink()
    put(lut)
    for _ in range(2):
        ended = batch()
        assert ended.code == 3
        assert "a.png.spi1d: is not a regular file; move it away" in ended.err
    lut.rmdir() if lut.is_dir() else lut.unlink()
    assert batch().code == 0
    assert lut.is_file()
    assert facecrf("verify", tmp_path / "luts").code == 0


# --- Nothing leads outside.


def test_a_link_among_the_outputs_does_not_lead_outside(batch, source, tmp_path):
    luts = tmp_path / "luts"
    luts.mkdir()
    (luts / "sub").symlink_to(source / "sub")
    before = files(source)
    ended = batch()
    assert ended.code == 3
    assert "sub/b.png: failed:" in ended.err
    assert "leads out of" in ended.err
    assert files(source) == before
    assert (luts / "a.png.spi1d").is_file()


def test_outputs_linked_away_later_are_neither_followed_nor_removed(batch, tmp_path):
    luts, away = tmp_path / "luts", tmp_path / "away"
    batch()
    (luts / "sub").rename(away)
    (luts / "sub").symlink_to(away)
    before = files(away)
    ended = batch("--formats", "cube")
    assert (ended.code, "leads out of" in ended.err) == (3, True)
    assert files(away) == before


def test_a_folder_swapped_while_the_run_goes_on_is_noticed(batch, source, tmp_path, monkeypatch):
    luts = tmp_path / "luts"
    real, before = WorkersHere.results, files(source)

    def swap(self):
        if luts.is_dir() and not luts.is_symlink():
            luts.rename(tmp_path / "was")
            luts.symlink_to(source)
        yield from real(self)

    monkeypatch.setattr(WorkersHere, "results", swap)
    ended = batch()
    assert ended.code == 1
    assert "is no longer the folder it was" in ended.err
    assert files(source) == before


@pytest.mark.parametrize("name", ["../photos/a.png", "/etc/hostname", "sub/../../photos/a.png"])
def test_a_crafted_manifest_removes_nothing_outside(batch, facecrf, source, tmp_path, name):
    luts, before = tmp_path / "luts", files(source)
    batch()
    change(
        luts,
        f"UPDATE outputs SET name = '{name}', folded = '' WHERE name = 'a.png.spi1d'",  # noqa: S608
    )
    for arguments in (("--formats", "cube"), ()):
        assert batch(*arguments).code in (1, 3)
    for arguments in ((), ("--repair",)):
        ended = facecrf("verify", luts, *arguments)
        assert (ended.code, "which leads out of its folder" in ended.err) == (1, True)
    assert files(source) == before


# --- The manifest.


def garbage(luts: Path) -> None:
    (luts / FILE).write_bytes(os.urandom(8192))


def foreign(luts: Path) -> None:
    (luts / FILE).unlink()
    base = sqlite3.connect(luts / FILE)
    base.execute("CREATE TABLE songs (name)")
    base.close()


def cut(luts: Path) -> None:
    (luts / FILE).write_bytes((luts / FILE).read_bytes()[:5000])


def odd_version(luts: Path) -> None:
    change(luts, "UPDATE about SET value = '1e9' WHERE key = 'schema'")


def folder(luts: Path) -> None:
    (luts / FILE).unlink()
    (luts / FILE).mkdir()


def link(luts: Path) -> None:
    (luts / FILE).rename(luts.parent / "base")
    (luts / FILE).symlink_to(luts.parent / "base")


@pytest.mark.parametrize("damage", [garbage, foreign, cut, odd_version, folder, link])
def test_a_damaged_or_foreign_manifest_is_one_line(batch, facecrf, tmp_path, damage):
    luts = tmp_path / "luts"
    batch()
    for leftover in ("-wal", "-shm"):
        (luts / f"{FILE}{leftover}").unlink(missing_ok=True)
    damage(luts)
    for run in (batch, lambda: facecrf("verify", luts), lambda: facecrf("report", luts)):
        ended = run()
        if damage is link and ended.code == 0:
            continue  # a manifest that is a link is read, and not written
        assert ended.code == 1, ended
        (line,) = [text for text in ended.err.splitlines() if text.startswith("facecrf: ")]
        assert str(luts) in line
        assert ";" in line


def test_a_locked_manifest_is_told_as_such(batch, tmp_path, monkeypatch):
    batch()
    real = sqlite3.connect
    monkeypatch.setattr(
        sqlite3, "connect", lambda *args, **more: real(*args, **{**more, "timeout": 0.1})
    )
    base = real(tmp_path / "luts" / FILE, isolation_level=None)
    base.execute("BEGIN EXCLUSIVE")
    ended = batch()
    base.close()
    assert ended.code == 1
    assert "database is locked; close the program that has it open" in ended.err


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE photos SET size = 'x', mtime_ns = x'00', state = 7",
        "UPDATE photos SET camera = 'not json'",
        "UPDATE photos SET name = x'ff' WHERE name = 'a.png'",
        "UPDATE photos SET verdict = '9'",
        "UPDATE outputs SET size = 1e300, sha256 = 3",
        "UPDATE about SET value = '{' WHERE key = 'cpu'",
    ],
)
def test_odd_rows_are_done_again_or_told_in_one_line(batch, facecrf, tmp_path, statement):
    luts = tmp_path / "luts"
    batch()
    change(luts, statement)
    for run in (batch, lambda: facecrf("verify", luts), lambda: facecrf("report", luts)):
        ended = run()
        assert ended.code in (0, 1, 3), ended
        assert len(told(ended.err)) <= 1


def test_a_manifest_of_the_version_before_is_understood(batch, facecrf, tmp_path):
    """As 2 it knew neither when files were changed nor when outputs were written."""
    luts = tmp_path / "luts"
    batch()
    change(
        luts,
        "DROP TABLE summaries",
        "DROP TABLE thumbnails",
        "DROP TABLE merges",
        "DROP INDEX outputs_alike",
        "ALTER TABLE outputs DROP COLUMN folded",
        "ALTER TABLE outputs DROP COLUMN written_ns",
        "ALTER TABLE photos DROP COLUMN ctime_ns",
        "UPDATE about SET value = '2' WHERE key = 'schema'",
        "DELETE FROM about WHERE key LIKE 'recipe%' OR key = 'cpu'",
    )
    assert facecrf("verify", luts).code == 0
    assert facecrf("report", luts).code == 0
    times = {path: path.stat().st_mtime_ns for path in luts.rglob("*.spi1d")}
    assert "2 done before" in batch().err
    assert {path: path.stat().st_mtime_ns for path in times} == times
    # From now on it knows.
    assert table(luts, "SELECT COUNT(*) FROM photos WHERE ctime_ns = 0") == [(0,)]
    assert table(luts, "SELECT COUNT(*) FROM outputs WHERE written_ns = 0 OR folded = ''") == [(0,)]


# --- Disks.


def test_a_photo_edited_with_its_time_kept_is_done_again(batch, source, tmp_path):
    photo = source / "a.bmp"
    write_noise(photo, seed=3)
    batch()
    status = photo.stat()
    write_noise(photo, seed=4)  # a BMP of the same size, to the byte
    os.utime(photo, ns=(status.st_atime_ns, status.st_mtime_ns))
    assert "2 done before" in batch().err
    # Another change of the file alone, such as of its permissions, costs one look at its bytes.
    photo.chmod(0o600)
    assert "3 done before" in batch().err


@pytest.mark.parametrize("times", [1, 2])
def test_an_error_that_may_pass_is_tried_once_more(batch, source, tmp_path, monkeypatch, times):
    left = [times]

    def read(path):
        if path.name == "a.png" and left[0]:
            left[0] -= 1
            error = PhotoError(path, "cannot be read: input/output error", "check the file")
            raise error from OSError(errno.EIO, "Input/output error")
        return read_photo(path)

    monkeypatch.setattr(one_photo, "read_photo", read)
    monkeypatch.setattr(one_photo, "_PAUSE", 0.0)
    ended = batch()
    assert ended.code == (0 if times == 1 else 3)
    # Where it did not pass within the run, the next run tries again, without being asked to.
    assert batch().code == 0


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO])
def test_a_disk_that_takes_no_more_ends_the_run_and_the_next_goes_on(
    batch, facecrf, source, tmp_path, monkeypatch, number
):
    real = one_photo.write_outputs

    def write(photo, *args, **more):
        if photo.path.name == "b.png":
            problem = "sub/b.png.spi1d: cannot be written: " + os.strerror(number).lower()
            raise OutputError(problem) from OSError(number, os.strerror(number))
        return real(photo, *args, **more)

    monkeypatch.setattr(one_photo, "write_outputs", write)
    monkeypatch.setattr(one_photo, "_PAUSE", 0.0)
    ended = batch()
    assert (ended.code, len(told(ended.err))) == (1, 1)
    assert os.strerror(number).lower() in ended.err
    monkeypatch.setattr(one_photo, "write_outputs", real)
    assert "1 done before" in batch().err
    batch(output=tmp_path / "whole")
    assert files(tmp_path / "luts") == files(tmp_path / "whole")
    assert facecrf("verify", tmp_path / "luts").code == 0


def test_a_disk_without_room_for_more_files_is_told(batch, tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "nr_inodes=9,mode=777", "none", str(disk)]
    try:
        made = subprocess.run(mount, check=False, capture_output=True).returncode == 0
    except OSError:
        made = False
    if not made:
        pytest.skip("mounting a small file system is not permitted here")
    try:
        ended = batch(output=disk / "luts")
    finally:
        subprocess.run(["umount", str(disk)], check=True)
    assert ended.code == 1
    (line,) = told(ended.err)
    assert "no space left on device" in line


def test_a_folder_of_outputs_that_cannot_be_read_is_told(batch, facecrf, tmp_path, monkeypatch):
    batch()
    scandir = os.scandir

    def refuse(path):
        if Path(path).name == "sub":
            raise PermissionError(13, "Permission denied", str(path))
        return scandir(path)

    monkeypatch.setattr(os, "scandir", refuse)
    ended = facecrf("verify", tmp_path / "luts")
    assert (ended.code, ended.out) == (1, "unreadable: sub\n")
