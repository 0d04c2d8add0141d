"""Whether a table holds the curve of a camera, or of its inverse."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from facecrf_ocio.lut.lint.finding import CODE_WHITES, ERROR, WARNING, Finding, Table
from facecrf_ocio.values import Bool, Float

# Of the 201 measured inverse responses of DoRF the steepest has a slope of 153, and no camera
# spends half of its range between two of 16 or more code values. An encoding table of 65536
# entries may begin as steeply as a power of 1/5 does.
_STEEPEST, _STEEPEST_SLOPE, _STEEPEST_OF_MANY = 0.5, 400.0, 0.1
# What jumps stands out from its neighbors; at an end, from the one: where a logarithm or the
# perceptual quantizer begins, the first step is four times the second, a power of 1/5's seven.
_STANDS_OUT, _STANDS_OUT_AT_AN_END = 4.0, 20.0
_FEWEST = 16  # entries within the ends, for a bend to stand out
_ROUNDING = 1e-6  # of a value, by which decimals of a rising table may fall
_DARKEST_WHITE = 1e-3  # ten stops below white; the fraction of an integer white is 1e-3 or less
_NO_NUMBER = "an entry is NaN or infinite"
_HALF_FLOATS, _NEGATIVE_ZERO = 65536, 32768  # half floats there are, and the bits of -0.0
_POSITIVE = np.arange(_NEGATIVE_ZERO)
# A table for false color has a few colors, each for many codes in a row; no curve repeats as many.
_FALSE_COLOR, _FEWEST_FALSE = 0.9, 256
Lines = Sequence[int | None]


def check(path: Path, table: Table) -> list[Finding]:
    """What was found while reading a table, and what its entries show."""
    found = list(table.findings)
    rows = table.rows
    if any(finding.severity == ERROR for finding in found) and not rows:
        return found
    if table.promised is not None and table.promised != len(rows):
        problem = f"{len(rows)} entries where {table.promised} are promised"
        found.append(_error(path, table.line, problem))
    wrong = _misshapen(path, table)
    if wrong:
        return found + wrong
    lines, values, codes = _by_light(table)
    lost = np.isnan(values).any(axis=1) | (np.isinf(values).any(axis=1) & codes)
    if lost.any():
        found.append(_error(path, lines[int(np.argmax(lost))], _NO_NUMBER))
        return found
    if _is_false_color(values):
        return found
    for channel in range(values.shape[1]):
        name = "RGB"[channel] if values.shape[1] == 3 else table.name
        found += _check_curve(path, name, lines, values[:, channel], codes, table)
    return found


def _error(path: Path, line: int | None, problem: str) -> Finding:
    return Finding(path, line, ERROR, problem, "export it again")


def _misshapen(path: Path, table: Table) -> list[Finding]:
    """Errors of a table whose entries are not alike one or three numbers."""
    rows = table.rows
    if not rows:
        return [_error(path, None, "it has no entries")]
    width = len(rows[0][1])
    odd = next((r for r in rows if len(r[1]) != width), rows[0] if width not in (1, 3) else None)
    if odd is None:
        return []
    bad = next((r for r in rows if not np.isfinite(r[1]).all()), None)
    found = [] if bad is None else [_error(path, bad[0], _NO_NUMBER)]
    return [*found, _error(path, odd[0], "entries are not of 1 or 3 numbers")]


def _by_light(table: Table) -> tuple[Lines, Float, Bool]:
    """Lines and (N, C) values by increasing input that is finite, and where it is a code."""
    lines = [line for line, _ in table.rows]
    values = np.array([numbers for _, numbers in table.rows], np.float64)
    if not table.half_domain or len(lines) != _HALF_FLOATS:
        return lines, values, np.ones(len(lines), bool)
    light = np.arange(_HALF_FLOATS, dtype=np.uint16).view(np.float16).astype(np.float64)
    order = np.concatenate([np.arange(_HALF_FLOATS - 1, _NEGATIVE_ZERO - 1, -1), _POSITIVE])
    order = order[np.isfinite(light[order])]
    codes = (light[order] >= 0.0) & (light[order] <= 1.0)
    return [lines[int(index)] for index in order], values[order], codes


def _is_false_color(values: Float) -> bool:
    """Whether a table has steps and nothing between them, and so is no curve, (N, C)."""
    changes = np.any(values[1:] != values[:-1], axis=1)
    alone = changes[1:-1] & ~changes[:-2] & ~changes[2:]
    few = len(values) >= _FEWEST_FALSE and changes.any() and changes.mean() < 1.0 - _FALSE_COLOR
    return bool(few and alone.sum() > _FALSE_COLOR * changes.sum())


def _check_curve(
    path: Path, name: str, lines: Lines, values: Float, codes: Bool, table: Table
) -> list[Finding]:
    found = _falls(path, name, lines, values)
    inside = np.flatnonzero(codes)
    column, places = values[inside], [lines[int(index)] for index in inside]
    if column.size > 1 and column[0] == column[-1] and not found:
        problem, remedy = f"{name} is constant", "export it again"
        return [Finding(path, places[0], WARNING, problem, remedy)]
    if inside.size < _FEWEST or found:
        return found + _white(path, name, lines, values, table)
    found += _white(path, name, lines, values, table)
    if not table.half_domain:  # whose steps are as fine as its numbers
        found += _jumps(path, name, places, column)
    return found + (_clipped(path, name, places, column, table.step) if table.of_codes else [])


def _falls(path: Path, name: str, lines: Lines, values: Float) -> list[Finding]:
    with np.errstate(invalid="ignore", over="ignore"):
        steps = np.diff(values)
        size = np.maximum(np.abs(values[1:]), np.abs(values[:-1]))
        falls = np.flatnonzero(steps < -_ROUNDING * np.minimum(size, np.finfo(np.float32).max))
    if not falls.size:
        return []
    remedy = "a response is monotone; calibrate again"
    return [Finding(path, lines[int(falls[0]) + 1], ERROR, f"{name} decreases", remedy)]


def _white(path: Path, name: str, lines: Lines, values: Float, table: Table) -> list[Finding]:
    """Whether a table's largest value looks like one of another range."""
    white = float(values[np.isfinite(values)].max(initial=0.0))
    at = lines[int(np.argmax(values))]
    if not table.step and any(abs(white - code) < 0.5 for code in CODE_WHITES):
        problem = f"{name} goes up to {white:g}, a code value where 1 is white"
        return [Finding(path, at, ERROR, problem, f"divide the table by {white:g}")]
    if 0.0 < white < _DARKEST_WHITE:
        problem = f"{name} goes up to {white:.2g} of white only"
        return [Finding(path, at, ERROR, problem, "check its bit depth")]
    return []


def _jumps(path: Path, name: str, lines: Lines, column: Float) -> list[Finding]:
    steps = np.diff(column)
    limit = max(_STEEPEST_OF_MANY, min(_STEEPEST, _STEEPEST_SLOPE / steps.size))
    before = np.concatenate([[0.0], steps[:-1]])
    after = np.concatenate([steps[1:], [0.0]])
    factor = np.full(steps.size, _STANDS_OUT)
    factor[[0, -1]] = _STANDS_OUT_AT_AN_END
    large = steps > limit * (column.max() - column.min())
    jumps = np.flatnonzero(large & (steps > factor * np.maximum(before, after)))
    if not jumps.size:
        return []
    index = int(jumps[0])
    problem = f"{name} jumps by {steps[index]:.3g}"
    return [Finding(path, lines[index + 1], WARNING, problem, "check the table there")]


def _clipped(path: Path, name: str, lines: Lines, column: Float, step: float) -> list[Finding]:
    bottom, top = _flat(column), _flat(column[::-1])
    most = max(column.size // 50, 2)
    found = []
    # Integers hold the foot of a smooth curve as zeros, then rise by one at a time.
    if bottom > most and column[bottom] - column[0] > 1.5 * step:
        problem, remedy = f"the bottom {bottom} entries of {name} are clipped", "lower end"
        found.append(Finding(path, lines[bottom], WARNING, problem, f"check the {remedy}"))
    if top > most:
        problem, remedy = f"the top {top} entries of {name} are clipped", "upper end"
        found.append(Finding(path, lines[-top], WARNING, problem, f"check the {remedy}"))
    return found


def _flat(column: Float) -> int:
    """How many entries of a column (K,) are equal, from the first on."""
    other = np.flatnonzero(column != column[0])
    return int(other[0]) if other.size else column.size
