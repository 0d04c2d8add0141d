"""Whether a table holds the curve of a camera, or of its inverse."""

from __future__ import annotations

import math
from itertools import pairwise, takewhile
from pathlib import Path

from facecrf_ocio.lut.lint.finding import ERROR, WARNING, Finding, Table

# Of the 201 measured inverse responses of DoRF the steepest has a slope of 153, and no camera
# spends half of its range between two of 16 or more code values. An encoding table of 65536
# entries may begin as steeply as a power of 1/5 does.
_STEEPEST, _STEEPEST_SLOPE, _STEEPEST_OF_MANY = 0.5, 400.0, 0.1
_FEWEST = 16
Column = list[tuple[int | None, float]]


def check(path: Path, table: Table) -> list[Finding]:
    """What was found while reading a table, and what its entries show."""
    found = list(table.findings)
    if any(finding.severity == ERROR for finding in found) and not table.rows:
        return found

    def add(line: int | None, problem: str, remedy: str = "export it again") -> None:
        found.append(Finding(path, line, ERROR, problem, remedy))

    rows = table.rows
    if table.promised is not None and table.promised != len(rows):
        add(table.line, f"{len(rows)} entries where {table.promised} are promised")
    if not rows:
        add(None, "it has no entries")
        return found
    bad = next((r for r in rows if not all(map(math.isfinite, r[1]))), None)
    if bad is not None:
        add(bad[0], "an entry is NaN or infinite")
        return found
    width = len(rows[0][1])
    odd = next((r for r in rows if len(r[1]) != width), rows[0] if width not in (1, 3) else None)
    if odd is not None:
        add(odd[0], "entries are not of 1 or 3 numbers")
        return found
    for channel in range(width):
        name = "RGB"[channel] if width == 3 else table.name
        column = [(line, numbers[channel]) for line, numbers in rows]
        found += _check_curve(path, name, column, table.step)
    return found


def _check_curve(path: Path, name: str, column: Column, step: float) -> list[Finding]:
    found = []
    steps = [(b[1] - a[1], b[0]) for a, b in pairwise(column)]
    fall = next((one for one in steps if one[0] < 0), None)
    if fall is not None:
        remedy = "a response is monotone; calibrate again"
        found.append(Finding(path, fall[1], ERROR, f"{name} decreases", remedy))
    size = len(column)
    if size < _FEWEST:
        return found
    limit = max(_STEEPEST_OF_MANY, min(_STEEPEST, _STEEPEST_SLOPE / (size - 1)))
    jump = next((one for one in steps if one[0] > limit), None)
    if jump is not None:
        problem = f"{name} jumps by {jump[0]:.3g}"
        found.append(Finding(path, jump[1], WARNING, problem, "check the table there"))
    bottom, top = _flat(column), _flat(column[::-1])
    most = max(size // 50, 2)
    if bottom == size:
        found.append(Finding(path, column[0][0], WARNING, f"{name} is constant", "export it again"))
        return found
    # Integers hold the foot of a smooth curve as zeros, then rise by one at a time.
    if bottom > most and column[bottom][1] - column[0][1] > 1.5 * step:
        problem, remedy = f"the bottom {bottom} entries of {name} are clipped", "lower end"
        found.append(Finding(path, column[bottom][0], WARNING, problem, f"check the {remedy}"))
    if top > most:
        problem, remedy = f"the top {top} entries of {name} are clipped", "upper end"
        found.append(Finding(path, column[-top][0], WARNING, problem, f"check the {remedy}"))
    return found


def _flat(column: Column) -> int:
    """How many entries from the first on are equal."""
    return sum(1 for _ in takewhile(lambda entry: entry[1] == column[0][1], column))
