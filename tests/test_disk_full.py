"""EXR files on a disk that is full, in a folder that is locked, and where a file is already."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from command_line import CommandLine, names_in, write_noise
from memory_disks import memory_disk
from photo_files import write_spi1d
from privileges import without_privileges

sys.path.insert(0, str(Path(__file__).parents[1] / "nodes" / "oiio"))

from facecrf_oiio.command import run

WAYS = ("linearize", "apply", "node")


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 200 kB; the EXR of the photo takes more than a megabyte."""
    with memory_disk(tmp_path / "disk") as disk:
        disk.limit("size=200k")
        yield disk.folder


class Writing:
    """A photo of noise and a LUT, and the three commands that make an EXR of them."""

    def __init__(self, folder: Path, capture: pytest.CaptureFixture[str]) -> None:
        self.photo = write_noise(folder / "a.png", size=(512, 512))
        self.lut = write_spi1d(folder / "a.spi1d")
        self._capture = capture
        self._command = CommandLine(capture)

    def __call__(self, way: str, target: Path, *options: str) -> tuple[int, str]:
        """Exit code and what was said on stderr."""
        if way == "node":
            code = run([str(self.photo), "--lut", str(self.lut), "-o", str(target), *options])
            return code, self._capture.readouterr().err
        how = ("--lut", self.lut) if way == "apply" else ("--estimator", "srgb")
        ended = self._command(way, self.photo, *how, "-o", target, *options)
        return ended.code, ended.err


@pytest.fixture
def writing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Writing:
    return Writing(tmp_path, capsys)


@pytest.mark.parametrize("way", WAYS)
def test_a_full_disk_is_told_and_nothing_is_left(disk: Path, writing: Writing, way: str) -> None:
    code, told = writing(way, disk / "b.exr")
    assert code == 1
    assert told.count("\n") == 1
    assert "b.exr: cannot be written: no space left on device; free some space" in told
    assert names_in(disk) == set()


@pytest.mark.parametrize("way", WAYS)
def test_a_full_disk_leaves_the_file_that_was_to_be_replaced(
    disk: Path, writing: Writing, way: str
) -> None:
    (disk / "b.exr").write_text("mine")
    code, told = writing(way, disk / "b.exr", "--overwrite")
    assert (code, "no space left" in told) == (1, True)
    assert (disk / "b.exr").read_text() == "mine"
    assert names_in(disk) == {"b.exr"}


@pytest.mark.parametrize("way", WAYS)
def test_a_locked_folder_is_told(tmp_path: Path, writing: Writing, way: str) -> None:
    folder = tmp_path / "locked"
    folder.mkdir(mode=0o555)
    for parent in folder.parents:  # which pytest makes for its own user alone
        if "pytest-of-" in str(parent):
            parent.chmod(0o711)
    # Once before, since what is imported at first use may lie where only root can read it.
    assert writing(way, tmp_path / "before.exr")[0] == 0
    with without_privileges():
        code, told = writing(way, folder / "b.exr")
    assert code == 1
    assert told.count("\n") == 1
    assert "permission denied" in told
    assert names_in(folder) == set()


@pytest.mark.parametrize("way", WAYS)
def test_a_file_that_is_there_is_kept(tmp_path: Path, writing: Writing, way: str) -> None:
    (tmp_path / "b.exr").write_text("mine")
    code, told = writing(way, tmp_path / "b.exr")
    assert (code, told.count("\n")) == (1, 1)
    assert "b.exr: exists already; pass --overwrite to replace it" in told
    assert (tmp_path / "b.exr").read_text() == "mine"
    assert names_in(tmp_path) == {"a.png", "a.spi1d", "b.exr"}
    assert writing(way, tmp_path / "b.exr", "--overwrite")[0] == 0
    assert (tmp_path / "b.exr").stat().st_size > 100_000
