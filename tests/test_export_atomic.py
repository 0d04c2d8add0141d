"""Files appear whole or not at all, whatever the system does."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
from pathlib import Path
from typing import NoReturn

import pytest
from privileges import without_privileges

from facecrf_ocio.errors import OutputError
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.lut.format_table import FORMATS


def accept(path: Path) -> None:
    assert path.is_file()


def drafts(folder: Path, *names: str) -> list[Draft]:
    return [Draft(folder / name, name.encode(), accept) for name in names]


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_all_files_appear_with_their_content(tmp_path: Path) -> None:
    written = write_files(drafts(tmp_path, "a.x", "b.y"))
    assert written == (tmp_path / "a.x", tmp_path / "b.y")
    assert contents(tmp_path) == {"a.x": b"a.x", "b.y": b"b.y"}


def test_the_check_sees_the_whole_file_under_another_name_before_it_appears(tmp_path: Path) -> None:
    seen = []

    def check(path: Path) -> None:
        seen.append((path.read_bytes(), path.suffix, path.parent, contents(tmp_path).keys()))

    write_files([Draft(tmp_path / "a.x", b"all", check)])
    ((content, suffix, folder, names),) = seen
    assert (content, suffix, folder) == (b"all", ".x", tmp_path)
    assert "a.x" not in names


def test_permissions_follow_the_umask(tmp_path: Path) -> None:
    former = os.umask(0o027)
    try:
        (path,) = write_files(drafts(tmp_path, "a.x"))
    finally:
        os.umask(former)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640


@pytest.mark.parametrize("overwrite", [False, True])
def test_a_failed_check_leaves_everything_as_it_was(tmp_path: Path, overwrite: bool) -> None:
    (tmp_path / "a.x").write_bytes(b"former")

    def refuse(path: Path) -> NoReturn:
        raise KeyboardInterrupt

    names = ("a.x", "b.x") if overwrite else ("b.x", "c.x")
    listed = [*drafts(tmp_path, *names), Draft(tmp_path / "z.x", b"", refuse)]
    with pytest.raises(KeyboardInterrupt):
        write_files(listed, overwrite=overwrite)
    assert contents(tmp_path) == {"a.x": b"former"}


def test_one_existing_file_keeps_all_from_being_written(tmp_path: Path) -> None:
    (tmp_path / "b.x").write_bytes(b"former")
    with pytest.raises(OutputError, match=r"b\.x: exists already; pass overwrite=True"):
        write_files(drafts(tmp_path, "a.x", "b.x"))
    assert contents(tmp_path) == {"b.x": b"former"}


@pytest.mark.parametrize("hard_links", [True, False])
def test_a_file_that_appears_meanwhile_is_not_clobbered(
    tmp_path: Path, hard_links: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not hard_links:
        forbid_hard_links(monkeypatch)

    def be_overtaken(_: Path) -> None:
        (tmp_path / "b.x").write_bytes(b"another process")

    listed = [*drafts(tmp_path, "a.x"), Draft(tmp_path / "b.x", b"ours", be_overtaken)]
    with pytest.raises(
        OutputError, match=r"b\.x: cannot be written: file exists; pass overwrite=True"
    ):
        write_files(listed)
    assert contents(tmp_path) == {"b.x": b"another process"}


def forbid_hard_links(monkeypatch: pytest.MonkeyPatch) -> None:
    def link(*_: object, **__: object) -> NoReturn:
        raise OSError(errno.EPERM, os.strerror(errno.EPERM))

    monkeypatch.setattr(os, "link", link)


def test_file_systems_without_hard_links_will_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    forbid_hard_links(monkeypatch)
    write_files(drafts(tmp_path, "a.x"))
    assert contents(tmp_path) == {"a.x": b"a.x"}
    write_files([Draft(tmp_path / "a.x", b"new", accept)], overwrite=True)
    assert contents(tmp_path) == {"a.x": b"new"}


def test_what_was_replaced_comes_back_when_a_later_file_fails(tmp_path: Path) -> None:
    (tmp_path / "a.x").write_bytes(b"former")

    def put_a_folder_there(_: Path) -> None:
        (tmp_path / "c.x").mkdir()

    listed = [*drafts(tmp_path, "a.x", "b.x"), Draft(tmp_path / "c.x", b"", put_a_folder_there)]
    with pytest.raises(OutputError, match=r"c\.x: cannot be written: is a directory"):
        write_files(listed, overwrite=True)
    (tmp_path / "c.x").rmdir()
    assert contents(tmp_path) == {"a.x": b"former"}


def test_links_are_replaced_and_not_followed(tmp_path: Path) -> None:
    (tmp_path / "other").write_bytes(b"other")
    (tmp_path / "a.x").symlink_to(tmp_path / "other")
    write_files(drafts(tmp_path, "a.x"), overwrite=True)
    assert contents(tmp_path) == {"a.x": b"a.x", "other": b"other"}


def test_a_dangling_link_counts_as_an_existing_file(tmp_path: Path) -> None:
    (tmp_path / "a.x").symlink_to(tmp_path / "nowhere")
    with pytest.raises(OutputError, match="exists already"):
        write_files(drafts(tmp_path, "a.x"))


@pytest.mark.parametrize("overwrite", [False, True])
def test_folders_and_devices_are_never_replaced(tmp_path: Path, overwrite: bool) -> None:
    (tmp_path / "a.x").mkdir()
    os.mkfifo(tmp_path / "b.x")
    for name in ("a.x", "b.x"):
        with pytest.raises(OutputError, match="is not a regular file; choose another name"):
            write_files(drafts(tmp_path, name), overwrite=overwrite)
    assert (tmp_path / "b.x").is_fifo()


def test_a_full_disk_is_told_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fsync(_: int) -> NoReturn:  # where a file system that allocates late reports it
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(
        OutputError, match=r"a\.x: cannot be written: no space left on device; free some space"
    ):
        write_files(drafts(tmp_path, "a.x"))
    assert not contents(tmp_path)


def test_an_error_of_the_disk_on_the_folder_takes_the_files_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = os.fsync

    def fsync(descriptor: int) -> None:
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        real(descriptor)

    monkeypatch.setattr(os, "fsync", fsync)
    with pytest.raises(OutputError, match="input/output error"):
        write_files(drafts(tmp_path, "a.x", "b.x"))
    assert not contents(tmp_path)


def test_folders_that_cannot_be_flushed_will_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = os.fsync

    def fsync(descriptor: int) -> None:
        if stat.S_ISDIR(os.fstat(descriptor).st_mode):
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))
        real(descriptor)

    monkeypatch.setattr(os, "fsync", fsync)
    write_files(drafts(tmp_path, "a.x"))
    assert contents(tmp_path) == {"a.x": b"a.x"}


def test_a_function_may_write_the_file(tmp_path: Path) -> None:
    """Also one that puts another in the temporary file's place."""

    def write(path: Path) -> None:
        assert path.parent == tmp_path
        path.unlink()
        path.write_bytes(b"by name")

    write_files([Draft(tmp_path / "a.x", write, accept)])
    assert contents(tmp_path) == {"a.x": b"by name"}


def test_what_a_function_raises_leaves_nothing(tmp_path: Path) -> None:
    def write(path: Path) -> NoReturn:
        path.write_bytes(b"half of it")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(OutputError, match="no space left on device; free some space"):
        write_files([Draft(tmp_path / "a.x", write, accept)])
    assert not contents(tmp_path)


LIMITED = """
import resource, sys
from pathlib import Path
import numpy as np
from facecrf_ocio.errors import OutputError
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.values import InverseCRF
codes = np.linspace(0, 1, 4096)
resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))
try:
    write_lut(InverseCRF(codes, np.stack([codes**2] * 3)), Path(sys.argv[1]))
except OutputError as error:
    print(error)
"""


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_write_that_the_system_cuts_short_leaves_nothing(tmp_path: Path, suffix: str) -> None:
    pytest.importorskip("resource")
    command = [sys.executable, "-c", LIMITED, str(tmp_path / f"a.{suffix}")]
    result = subprocess.run(command, check=True, capture_output=True, text=True)
    assert result.stdout.count("\n") == 1
    assert f"a.{suffix}: cannot be written: file too large; raise the limit" in result.stdout
    assert not list(tmp_path.iterdir())


def test_a_folder_one_may_not_write_to_is_told(tmp_path: Path) -> None:
    folder = tmp_path / "locked"
    folder.mkdir(mode=0o555)
    with without_privileges(), pytest.raises(OutputError, match="permission denied; choose a fol"):
        write_files(drafts(folder, "a.x"))
    assert not contents(folder)


@pytest.mark.parametrize(
    ("place", "told"),
    [
        ("missing/a.x", "no such file or directory; create the folder first"),
        ("file/a.x", "not a directory; choose a folder, not a file"),
        ("n" * 300 + ".x", "file name too long; choose a shorter name"),
    ],
)
def test_impossible_places_are_told_in_one_line(tmp_path: Path, place: str, told: str) -> None:
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(OutputError, match=told) as caught:
        write_files(drafts(tmp_path, place))
    assert str(tmp_path / place) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert contents(tmp_path) == {"file": b""}
