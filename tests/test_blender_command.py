"""What the Blender extension does outside of Blender: its zip, and finding the command."""

from __future__ import annotations

import importlib.util
import sys
import zipfile
from pathlib import Path

import pytest

NODES = Path(__file__).parents[1] / "nodes"


def load(path):
    spec = importlib.util.spec_from_file_location(f"blender_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def command():
    return load(NODES / "blender" / "command.py")


def executable(path):
    path.parent.mkdir(parents=True)
    path.write_text("#!/bin/sh\n")
    path.chmod(0o755)
    return str(path)


@pytest.mark.parametrize("inside", ["bin", ".venv/bin", "venv/bin"])
def test_the_command_is_found_in_the_folder_of_an_environment(command, tmp_path, inside):
    found = executable(tmp_path / inside / "facecrf")
    assert command.find_command(str(tmp_path)) == found


def test_the_command_is_found_in_the_path_at_home_and_where_installers_put_it(
    command, tmp_path, monkeypatch
):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path / "somewhere"))
    usual = executable(tmp_path / ".local" / "bin" / "facecrf")
    at_home = executable(tmp_path / "env" / "bin" / "facecrf")
    assert command.find_command("facecrf") == usual
    assert command.find_command("") == usual
    assert command.find_command("~/env") == command.find_command("~/env/bin/facecrf") == at_home
    in_path = executable(tmp_path / "somewhere" / "facecrf")
    assert command.find_command("facecrf") == in_path


def test_a_missing_command_says_where_to_name_it(command, tmp_path):
    with pytest.raises(command.CommandError, match=r"in this folder.*Preferences > Add-ons"):
        command.find_command(str(tmp_path))


def test_words_do_not_fill_a_pipe_and_the_command_can_be_stopped(command, tmp_path):
    loud = tmp_path / "loud"
    loud.write_text(f"#!{sys.executable}\nprint('x' * 300_000); raise SystemExit(4)\n")
    loud.chmod(0o755)
    running = command.Running(str(loud), [])
    running.wait()
    answer = running.answer()
    assert (answer.code, len(answer.out.strip())) == (4, 300_000)
    slow = tmp_path / "slow"
    slow.write_text(f"#!{sys.executable}\nimport time; time.sleep(600)\n")
    slow.chmod(0o755)
    running = command.Running(str(slow), [])
    assert not running.ended()
    running.stop()
    assert running.ended()


def test_the_zip_is_the_same_each_time_and_holds_the_license(tmp_path):
    build = load(NODES / "blender_zip.py").build
    first, second = build(tmp_path / "a"), build(tmp_path / "b")
    assert first.read_bytes() == second.read_bytes()
    names = zipfile.ZipFile(first).namelist()
    assert {"__init__.py", "blender_manifest.toml", "LICENSE"} <= set(names)
    assert not any("/" in name for name in names)


def test_an_exr_in_the_way_is_told_in_words_that_fit_blender(command, tmp_path):
    (tmp_path / "a.exr").write_bytes(b"mine")
    work = command.linearize("facecrf", tmp_path / "a.jpg", tmp_path / "a.exr", "auto")
    with pytest.raises(command.CommandError, match=r"a\.exr: exists already; choose another"):
        next(work)
