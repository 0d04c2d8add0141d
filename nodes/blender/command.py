"""Runs the `facecrf` command, which lives in an environment of its own."""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path


class CommandError(Exception):
    """The command is missing, or it did not answer with a curve; the text is for the user."""


@dataclass(frozen=True)
class Calibration:
    """A curve, (length, 3) over codes 0 to 1 evenly, and the verdict on it."""

    rows: tuple[tuple[float, float, float], ...]
    verdict: str
    reason: str


def find_command(command: str) -> str:
    """Return the path of the executable, or raise CommandError."""
    found = shutil.which(command)
    if found is None:
        raise CommandError(
            f"{command!r} is not a command here; install facecrf-ocio in an environment of its "
            "own and set the path of its facecrf command in the preferences of this extension"
        )
    return found


def calibrate(command: str, photo: Path, estimator: str) -> Calibration:
    """Return the curve of one photo; raises CommandError with the reason when there is none."""
    with tempfile.TemporaryDirectory(prefix="facecrf-") as folder:
        options = ["-o", folder, "--formats", "spi1d", "--estimator", estimator, "--json"]
        answer = _run(command, ["calibrate", *options, "--", str(photo)])
        try:
            record = json.loads(answer.stdout.strip().splitlines()[-1])
        except (IndexError, ValueError):
            raise CommandError(_last_line(answer, photo)) from None
        luts = [file for file in record.get("files", ()) if file.endswith(".spi1d")]
        if answer.returncode or not luts:
            said = (record.get("reason"), record.get("remedy"))
            raise CommandError(f"{photo.name}: {'; '.join(filter(None, said)) or 'no curve'}")
        return Calibration(read_spi1d(Path(luts[0])), record["verdict"], record["reason"])


def linearize(command: str, photo: Path, exr: Path, estimator: str) -> None:
    """Write one photo as a scene-linear EXR, or raise CommandError."""
    options = ["-o", str(exr), "--estimator", estimator]
    answer = _run(command, ["linearize", *options, "--", str(photo)])
    if answer.returncode or not exr.is_file():
        raise CommandError(_last_line(answer, photo))


def read_spi1d(path: Path) -> tuple[tuple[float, float, float], ...]:
    """Return the (length, 3) table of a three-component file over codes 0 to 1."""
    table = path.read_text(encoding="utf-8").split("{", 1)[1].split("}", 1)[0]
    rows = [tuple(map(float, line.split())) for line in table.strip().splitlines()]
    if len(rows) < 2 or any(len(row) != 3 for row in rows):
        raise CommandError(f"{path.name}: does not hold three curves")
    return tuple((r, g, b) for r, g, b in rows)


def _run(command: str, arguments: list[str]) -> subprocess.CompletedProcess[str]:
    found = find_command(command)
    try:
        return subprocess.run(
            [found, *arguments], capture_output=True, text=True, encoding="utf-8", check=False
        )
    except OSError as error:
        raise CommandError(f"{found}: cannot be started: {error}") from None


def _last_line(answer: subprocess.CompletedProcess[str], photo: Path) -> str:
    lines = (answer.stderr.strip() or answer.stdout.strip()).splitlines()
    return lines[-1] if lines else f"{photo.name}: facecrf ended with code {answer.returncode}"
