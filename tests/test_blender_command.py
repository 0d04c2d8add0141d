"""What the Blender extension does outside of Blender: its zip, and finding the command."""

from __future__ import annotations

import importlib.util
import sys
import types
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


class Screen:
    """What an operator asks a Blender with a window for, and what it shows."""

    def __init__(self):
        self.window = self.window_manager = self.workspace = self
        self.shown, self.timers, self.parts = [], 0, []
        self.progress_begin = lambda low, high: None
        self.progress_end = lambda: None
        self.progress_update = self.parts.append
        self.modal_handler_add = lambda operator: None
        self.status_text_set = self.shown.append

    def event_timer_add(self, seconds, window):
        self.timers += 1
        return "timer"

    def event_timer_remove(self, timer):
        self.timers -= 1


@pytest.fixture
def working(monkeypatch):
    package = types.ModuleType("linearize_photo")
    package.__path__ = [str(NODES / "blender")]
    bpy = types.SimpleNamespace(app=types.SimpleNamespace(background=False))
    monkeypatch.setitem(sys.modules, "linearize_photo", package)
    monkeypatch.setitem(sys.modules, "bpy", bpy)
    yield importlib.import_module("linearize_photo.working")
    for name in [name for name in sys.modules if name.startswith("linearize_photo.")]:
        del sys.modules[name]


def operator(working, tmp_path, seconds, photos=2):
    """An operator that runs a command for each photo, with what it said to the user."""
    command = tmp_path / "command"
    command.write_text(f"#!{sys.executable}\nimport time; time.sleep({seconds})\n")
    command.chmod(0o755)

    class Operator(working.Working):
        def work(self, _):
            for number in range(photos):
                self.say(f"photo {number + 1}", number / photos)
                yield sys.modules["linearize_photo.command"].Running(str(command), [])

        def report(self, _, text):
            self.reported = text

    made = Operator()
    made._modal = True
    return made


TIMER = types.SimpleNamespace(type="TIMER", value="NOTHING")
ESC = types.SimpleNamespace(type="ESC", value="PRESS")
OTHER = types.SimpleNamespace(type="MOUSEMOVE", value="NOTHING")


def test_blender_goes_on_while_an_operator_works_and_sees_how_far_it_is(working, tmp_path):
    screen, one = Screen(), operator(working, tmp_path, 0)
    assert one.begin(screen) == {"RUNNING_MODAL"}
    assert one.modal(screen, OTHER) == {"PASS_THROUGH"}
    result = {"PASS_THROUGH"}
    while result == {"PASS_THROUGH"}:
        one._running.wait()
        result = one.modal(screen, TIMER)
    assert result == {"FINISHED"}
    said = [text for text in screen.shown if text]
    assert said[0].startswith("photo 1")
    assert said[-1].startswith("photo 2")
    assert all(text.endswith("Esc: cancel") for text in said)
    assert screen.parts[-1] == 50
    assert (screen.shown[-1], screen.timers) == (None, 0)


def test_esc_stops_the_command_and_the_rest(working, tmp_path):
    screen, one = Screen(), operator(working, tmp_path, 600)
    assert one.begin(screen) == {"RUNNING_MODAL"}
    process = one._running._process
    assert one.modal(screen, TIMER) == {"PASS_THROUGH"}
    assert process.poll() is None
    assert one.modal(screen, ESC) == {"CANCELLED"}
    assert process.poll() is not None
    assert (screen.shown[-1], screen.timers) == (None, 0)
    assert "cancelled" in one.reported
