"""What was measured before, in a CSV that grows by a command, and what has become slower since."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from facecrf_ocio.benchmark.speed.speed_row import SpeedRow
from facecrf_ocio.errors import OutputError
from facecrf_ocio.files.atomic import Draft, write_files

MOST_SLOWER = 0.2
"""Share by which a ratio may rise before a warning: what a busy machine does to it is less."""

_HEAD = ("date", "commit", "machine", "scale", "row", "value", "wanted", "ratio", "cpu_ratio")


@dataclass(frozen=True, slots=True)
class Run:
    """Where and when rows were measured.

    Attributes
    ----------
    date, commit, machine
        As `speed_table` tells them.
    scale
        Factor on the pixels.
    """

    date: str
    commit: str
    machine: str
    scale: float


def append(path: Path, run: Run, rows: Sequence[SpeedRow]) -> None:
    """Add a line a row to a history, which is begun if it is missing.

    Raises
    ------
    OutputError
        If the file is another, or cannot be written.
    """
    before = _lines(path)
    text = StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(_HEAD)
    table.writerows([line[name] for name in _HEAD] for line in before)
    for row in rows:
        numbers = (f"{n:.3f}" for n in (row.value, row.wanted, row.ratio, row.cpu))
        table.writerow((run.date, run.commit, run.machine, f"{run.scale:g}", row.key, *numbers))
    write_files([Draft(path, text.getvalue().encode(), lambda _: None)], overwrite=True)


def slower(path: Path, run: Run, rows: Sequence[SpeedRow]) -> Iterator[str]:
    """A line for each row whose ratios to the floor, by time and by CPU, have both risen.

    Compared is the last line of such a row by the same kind of machine, at the same scale.
    """
    same = [
        line
        for line in _lines(path)
        if (line["machine"], line["scale"]) == (run.machine, f"{run.scale:g}")
    ]
    last = {line["row"]: line for line in same}
    if not last:
        yield f"{path}: tells nothing of such a machine ({run.machine}), so nothing is compared"
    for row in rows:
        before = last.get(row.key)
        if before is None:
            continue
        ratio, cpu = float(before["ratio"]), float(before["cpu_ratio"])
        if min(row.ratio / ratio, row.cpu / cpu) > 1.0 + MOST_SLOWER:
            yield (
                f"{row.key}: {row.ratio:.2f} times the floor, {ratio:.2f} at {before['commit']} "
                f"({before['date']}); by CPU {row.cpu:.2f}, {cpu:.2f}"
            )


def _lines(path: Path) -> list[dict[str, str]]:
    if not path.exists():
        return []
    try:
        with path.open(newline="", encoding="utf-8") as file:
            table = csv.DictReader(file)
            if tuple(table.fieldnames or ()) != _HEAD:
                raise OutputError(f"{path}: is no history of speed; name another file")
            return list(table)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise OutputError(f"{path}: cannot be read as a history of speed ({error})") from None
