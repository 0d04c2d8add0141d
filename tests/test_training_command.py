"""What is wrong with the files of training, told in one line, before hours of work."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner
from photo_files import write

from facecrf_ocio.training.__main__ import main


def told(*arguments):
    """The last line of a command that fails as it should, without a traceback."""
    result = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert isinstance(result.exception, SystemExit), result.exception
    assert result.exit_code in (1, 2)
    return result.output.splitlines()[-1]


@pytest.fixture
def empty(tmp_path):
    folder = tmp_path / "empty"
    folder.mkdir()
    return folder


def test_portraits_without_photos_faces_or_a_folder_leave_no_file(tmp_path, empty):
    output = tmp_path / "versions.npz"
    assert "holds no JPEG or PNG" in told("portraits", empty, "-o", output)
    assert "does not exist" in told("portraits", tmp_path / "gone", "-o", output)
    write(empty / "gray.png", np.full((64, 64, 3), 0.5, np.float32), "uint8")
    problem = told("portraits", empty, "--processes", 1, "-o", output)
    assert "none of 1 photo shows a face" in problem
    assert not output.exists()


@pytest.mark.parametrize(
    "command", ["portraits {0} -o", "charts {0} -o", "reproduce --data {0} -o"]
)
def test_a_missing_folder_is_told_before_the_work(tmp_path, empty, command):
    words = command.format(empty).split()
    assert "no' does not exist; make it first" in told(*words, tmp_path / "no" / "file.npz")


def test_folders_that_hold_other_things_are_told_by_name(tmp_path, empty):
    output = tmp_path / "out.npz"
    assert "no photo in a MAKER/MODEL" in told("charts", empty, "-o", output)
    assert "dorf_201_curves.mat: no such file" in told("band", __file__, "--data", empty)
    assert not output.exists()


def test_a_file_that_is_no_versions_is_told(tmp_path, empty):
    stored = tmp_path / "versions.npz"
    for content in (b"", b"text", b"PK\x03\x04"):
        stored.write_bytes(content)
        assert f"{stored}: holds no versions" in told("portraits", empty, "-o", stored)


def test_no_processes_are_wrong_usage(tmp_path, empty):
    assert "--processes" in told("portraits", empty, "--processes", 0, "-o", tmp_path / "out.npz")
