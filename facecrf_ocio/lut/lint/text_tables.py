"""Tables in text files: .spi1d, .cube of either style, .csp."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path

from facecrf_ocio.lut.lint.finding import DECIMAL_COMMA, ERROR, WARNING, Finding, Row, Table, broken

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*([eE][+-]?\d+)?|\.\d+([eE][+-]?\d+)?|nan|inf(inity)?)", re.I)
# Scene-linear light may go far beyond 1, codes do not.
_HIGHEST_CODE = 16.0
_Lines = Sequence[tuple[int, list[str]]]


def keyed_tables(path: Path, content: bytes) -> list[Table]:
    """The table of a .spi1d or a .cube of either style, with what is odd in it."""
    return [_table(path, content, _keyed)]


def csp_tables(path: Path, content: bytes) -> list[Table]:
    """The table of a .csp, with what is odd in it."""
    return [_table(path, content, _csp)]


def _table(path: Path, content: bytes, read: Callable[[Path, _Lines], Table]) -> Table:
    lines = list(_lines(content.decode("utf-8", "replace")))
    comma = next((n for n, words in lines if DECIMAL_COMMA.search(" ".join(words))), None)
    if comma is not None:
        return broken(path, comma, "a number has a decimal comma", "write decimal points")
    solid = next((n for n, words in lines if words[0].lower() in ("3d", "lut_3d_size")), None)
    if solid is not None:
        return broken(path, solid, "it is a 3-D LUT", "use a 1-D LUT for a curve")
    return read(path, lines)


def _lines(text: str) -> Iterator[tuple[int, list[str]]]:
    """Number and words of the lines that are neither empty nor remarks."""
    in_notes = False
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.split("#")[0].strip()
        if line in ("BEGIN METADATA", "END METADATA"):
            in_notes = line.startswith("BEGIN")
        elif line and not in_notes and not line.upper().startswith("TITLE"):
            yield number, line.split()


def _keyed(path: Path, lines: _Lines) -> Table:
    """.spi1d and .cube: keywords, then rows."""
    rows: list[Row] = []
    findings: list[Finding] = []
    size: tuple[int, str] | None = None
    ends: dict[str, tuple[int, list[float]]] = {}
    for number, words in lines:
        key, values = words[0].lower(), words[1:]
        if key in ("length", "lut_1d_size") and values:
            size = number, values[-1]
        elif key in ("from", "lut_1d_input_range") and len(values) == 2:
            findings += _domain(path, number, "the domain", [[value] for value in values])
        elif key in ("domain_min", "domain_max"):
            ends[key] = number, [float(v) for v in values if _NUMBER.fullmatch(v)]
        elif _NUMBER.fullmatch(key):
            row = [float(word) for word in words if _NUMBER.fullmatch(word)]
            if len(row) < len(words):
                problem = "a row is not numbers"
                findings.append(Finding(path, number, ERROR, problem, "export it again"))
            rows.append((number, row))
    if ends:
        line = min(line for line, _ in ends.values())
        low, high = (ends.get(k, (0, d))[1] for k, d in _DEFAULT_ENDS)
        domain = [[str(v) for v in low], [str(v) for v in high]]
        findings += _domain(path, line, "the domain", domain)
    return _sized(path, rows, size, findings)


_DEFAULT_ENDS = (("domain_min", [0.0, 0.0, 0.0]), ("domain_max", [1.0, 1.0, 1.0]))


def _csp(path: Path, lines: _Lines) -> Table:
    """cineSpace: three shapers (size, input, output), the size, then rows."""
    body = [line for line in lines if line[1][0].upper() not in ("CSPLUTV100", "1D")]
    findings: list[Finding] = []
    for name, start in zip("RGB", range(0, 9, 3), strict=True):
        for what, (number, words) in zip(("domain", "shaper"), body[start + 1 :], strict=False):
            findings += _domain(path, number, f"the {what} of {name}", [[word] for word in words])
    size = next(((n, words[0]) for n, words in body[9:10] if len(words) == 1), None)
    rows: list[Row] = [
        (number, [float(word) for word in words if _NUMBER.fullmatch(word)])
        for number, words in body[9 if size is None else 10 :]
    ]
    return _sized(path, rows, size, findings)


def _sized(
    path: Path, rows: list[Row], size: tuple[int, str] | None, findings: list[Finding]
) -> Table:
    if size is None:
        missing = Finding(path, None, ERROR, "no size is given", "write how many entries follow")
        return Table(rows, None, (*findings, missing))
    line, text = size
    if not text.isdecimal():
        wrong = Finding(path, line, ERROR, f"the size is {text!r}", "write how many entries follow")
        return Table(rows, None, (*findings, wrong))
    return Table(rows, int(text), tuple(findings), line)


def _domain(path: Path, line: int, name: str, nodes: Sequence[Sequence[str]]) -> list[Finding]:
    """Check nodes that shall increase, each given for one channel or for R, G, B."""

    def error(problem: str, remedy: str, severity: str = ERROR) -> list[Finding]:
        return [Finding(path, line, severity, problem, remedy)]

    width = len(nodes[0]) if nodes else 0
    words = [word for node in nodes for word in node]
    if not all(map(_NUMBER.fullmatch, words)) or any(len(n) != width for n in nodes) or not width:
        return error(f"{name} is not numbers", "write 0 to 1")
    for channel, column in enumerate(zip(*nodes, strict=True)):
        values = [float(word) for word in column]
        of = f"{name} of {'RGB'[channel]}" if width == 3 else name
        if any(a > b for a, b in pairwise(values)):
            return error(f"{of} is reversed", "write the lower end first")
        if not values[0] < values[-1]:
            return error(f"{of} is empty", "write 0 to 1")
        if values[-1] > _HIGHEST_CODE:
            problem = f"{of} goes up to {values[-1]:g}, where OpenColorIO's codes go to 1"
            return error(problem, "write 0 to 1", WARNING)
    return []
