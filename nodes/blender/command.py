"""Runs the `facecrf` command, which lives in an environment of its own."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Generator
from dataclasses import dataclass
from pathlib import Path

PREFERENCES = "Edit > Preferences > Add-ons > Linearize Photo"
# Where installers put commands that a program started from a desktop does not have in its PATH.
_USUAL = ("~/.local/bin", "/opt/homebrew/bin", "/usr/local/bin")
# Inside a folder: of an environment itself, or of a project with one.
_INSIDE = ("", "bin", "Scripts", ".venv/bin", ".venv/Scripts", "venv/bin", "venv/Scripts")


class CommandError(Exception):
    """The command is missing, or it did not answer with a curve; the text is for the user."""


@dataclass(frozen=True)
class Calibration:
    """A curve, (length, 3) over codes 0 to 1 evenly; what follows it; and what is said of it.

    `matrix` is 3 x 3, from the photo's primaries to the space that was asked for.
    """

    rows: tuple[tuple[float, float, float], ...]
    matrix: tuple[tuple[float, float, float], ...]
    verdict: str
    reason: str


class Running:
    """A command at work, whose words go to files so that no pipe can fill up."""

    def __init__(self, command: str, arguments: list[str]) -> None:
        found = find_command(command)
        self._out, self._err = (tempfile.TemporaryFile() for _ in range(2))  # noqa: SIM115
        try:
            self._process = subprocess.Popen(
                [found, *arguments],
                stdin=subprocess.DEVNULL,
                stdout=self._out,
                stderr=self._err,
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
        except OSError as error:
            raise CommandError(f"{found}: cannot be started: {error}") from None

    def ended(self) -> bool:
        """Whether there is an answer; returns at once."""
        return self._process.poll() is not None

    def wait(self) -> None:
        """Return when there is an answer."""
        self._process.wait()

    def stop(self) -> None:
        """End the command, which leaves no half-written file behind."""
        if not self.ended():
            self._process.terminate()
            try:
                self._process.wait(5)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._out.close()
        self._err.close()

    def answer(self) -> Answer:
        """What it said, once it has ended."""
        said = []
        for file in (self._out, self._err):
            file.seek(0)
            said.append(file.read().decode("utf-8", "replace"))
            file.close()
        return Answer(self._process.returncode, *said)


@dataclass(frozen=True)
class Answer:
    """Exit code and words of a command that ended."""

    code: int
    out: str
    err: str

    def record(self) -> dict:
        """The one JSON object of a photo, or CommandError with the last words."""
        try:
            return json.loads(self.out.strip().splitlines()[-1])
        except (IndexError, ValueError):
            raise CommandError(self.last_line()) from None

    def last_line(self) -> str:
        """What was said last, where a complaint would be."""
        lines = (self.err.strip() or self.out.strip()).splitlines()
        return lines[-1] if lines else f"facecrf ended with code {self.code}"


# A piece of work: it yields commands that it has started, and is sent the answer of each.
Work = Generator[Running, Answer, Calibration]


def find_command(wanted: str) -> str:
    """Return the path of the executable, or raise CommandError.

    `wanted` is a command's name, its path, or a folder: of an environment, or of a project that
    has one in `.venv` or `venv`. `~` is the home folder.
    """
    wanted = wanted.strip() or "facecrf"
    given = Path(wanted).expanduser()
    places = [str(given)]
    if given.is_dir():
        places = [str(given / inside / "facecrf") for inside in _INSIDE]
    elif given.parent == Path():
        places += [str(Path(usual).expanduser() / wanted) for usual in _USUAL]
    for place in places:
        found = shutil.which(place)
        if found is not None:
            return os.path.abspath(found)  # noqa: PTH100 (a link in an environment must stay one)
    where = "in this folder" if given.is_dir() else "here"
    raise CommandError(
        f"{wanted!r}: there is no facecrf command {where}; install facecrf-ocio in an environment "
        f"of its own and name its folder in {PREFERENCES}"
    )


def calibrate(command: str, photo: Path, estimator: str, space: str) -> Work:
    """Return the curve of one photo; raises CommandError with the reason when there is none."""
    with tempfile.TemporaryDirectory(prefix="facecrf-") as folder:
        options = ["-o", folder, "--formats", "clf", "--to", space, "--estimator", estimator]
        answer = yield Running(command, ["calibrate", *options, "--json", "--", str(photo)])
        record = answer.record()
        luts = [file for file in record.get("files", ()) if file.endswith(".clf")]
        if answer.code or not luts:
            said = (record.get("reason"), record.get("remedy"))
            raise CommandError(f"{photo.name}: {'; '.join(filter(None, said)) or 'no curve'}")
        rows, matrix = read_clf(Path(luts[0]))
        words = record.get("summary") or record["reason"]
        return Calibration(rows, matrix, record["verdict"], words)


def linearize(command: str, photo: Path, exr: Path, estimator: str) -> Work:
    """Write one photo as a scene-linear EXR, or raise CommandError."""
    if exr.exists():
        raise CommandError(f"{exr}: exists already; choose another folder, or remove it")
    options = ["-o", str(exr), "--estimator", estimator]
    answer = yield Running(command, ["linearize", *options, "--", str(photo)])
    if answer.code or not exr.is_file():
        raise CommandError(answer.last_line())


def read_clf(path: Path) -> tuple[tuple, tuple]:
    """Return the (length, 3) table over codes 0 to 1, and the 3 x 3 matrix behind it."""
    arrays = {}
    for node in ET.parse(path).getroot():  # noqa: S314 (facecrf wrote it)
        array = node.find("Array")
        if array is not None:
            lines = array.text.strip().splitlines()
            arrays[node.tag] = tuple(tuple(map(float, line.split())) for line in lines)
    rows = arrays.get("LUT1D", ())
    matrix = arrays.get("Matrix", ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    if len(rows) < 2 or any(len(row) != 3 for row in (*rows, *matrix)):
        raise CommandError(f"{path.name}: does not hold three curves")
    return rows, matrix
