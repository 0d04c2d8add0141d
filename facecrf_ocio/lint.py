"""What is wrong with a LUT file that OpenColorIO may accept without a word."""

from __future__ import annotations

import math
import re
import struct
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

from facecrf_ocio.errors import LutError

ERROR, WARNING = "error", "warning"
# No camera spends half of its range between two of 16 or more code values.
_STEEPEST = 0.5
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*([eE][+-]?\d+)?|\.\d+([eE][+-]?\d+)?|nan|inf(inity)?)", re.I)
_COMMA = re.compile(r"\d,\d")
Row = tuple[int | None, list[float]]


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing wrong with a LUT file.

    Attributes
    ----------
    path, line
        Where; the line counts from 1 and is None where the format has none.
    severity
        `error`: pixels will be wrong. `warning`: they may be.
    problem, remedy
        What is wrong and what to do, without final periods.
    """

    path: Path
    line: int | None
    severity: str
    problem: str
    remedy: str

    def __str__(self) -> str:
        line = "" if self.line is None else f":{self.line}"
        return f"{self.path}{line}: {self.severity}: {self.problem}; {self.remedy}"


@dataclass(frozen=True, slots=True)
class _Table:
    """Rows of a one-dimensional table, and how many its header promises."""

    rows: list[Row]
    promised: int | None
    findings: list[Finding]


def lint(path: Path) -> tuple[Finding, ...]:
    """Check a LUT file: .spi1d, .cube, .csp, .clf, .ctf or .icc.

    Raises
    ------
    LutError
        If the file cannot be read or its suffix is none of these.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in (".spi1d", ".cube", ".csp", ".clf", ".ctf", ".icc"):
        raise LutError(f"{path}: lint knows .spi1d, .cube, .csp, .clf, .ctf and .icc only")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise LutError(f"{path}: cannot be read: {(error.strerror or '').lower()}") from error
    if suffix == ".icc":
        tables = _icc_tables(path, content)
    elif suffix in (".clf", ".ctf"):
        tables = _xml_tables(path, content)
    else:
        tables = [_text_table(path, content.decode("utf-8", "replace"), suffix)]
    return tuple(finding for table in tables for finding in _check(path, table))


def _text_table(path: Path, text: str, suffix: str) -> _Table:  # noqa: C901 - one case per line
    rows: list[Row] = []
    findings: list[Finding] = []
    promised: int | None = None
    shaper = 12 if suffix == ".csp" else 0
    in_notes = False
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.split("#")[0].strip()
        if line in ("BEGIN METADATA", "END METADATA"):
            in_notes = line.startswith("BEGIN")
            continue
        words = line.split()
        if not words or in_notes or line in ("{", "}", "1D"):
            continue
        if _COMMA.search(line):
            findings.append(
                Finding(path, number, ERROR, "a number has a decimal comma", "write decimal points")
            )
            break
        key = words[0].lower()
        if key in {"3d", "lut_3d_size"}:
            findings.append(
                Finding(path, number, ERROR, "it is a 3-D LUT", "use a 1-D LUT for a curve")
            )
            return _Table([], None, findings)
        if key in ("length", "lut_1d_size") or (suffix == ".csp" and len(words) == 1):
            if key.isdigit() and shaper:  # the size of a shaper
                continue
            promised = int(words[-1]) if words[-1].isdigit() else None
        elif key in ("from", "lut_1d_input_range") and len(words) == 3:
            findings += _check_domain(path, number, words[1:])
        elif all(_NUMBER.fullmatch(word) for word in words):
            if shaper and len(words) == 2:
                shaper -= 2
                continue
            shaper = 0
            rows.append((number, [float(word) for word in words]))
    return _Table(rows, promised, findings)


def _check_domain(path: Path, line: int, words: list[str]) -> list[Finding]:
    try:
        low, high = map(float, words)
    except ValueError:
        return [Finding(path, line, ERROR, "the domain is not two numbers", "write 0 1")]
    if low > high:
        return [Finding(path, line, ERROR, "the domain is reversed", "write the lower end first")]
    if not low < high:
        return [Finding(path, line, ERROR, "the domain is empty", "write 0 1")]
    return []


def _xml_tables(path: Path, content: bytes) -> list[_Table]:
    try:
        root = ElementTree.fromstring(content)  # noqa: S314 - expat bounds entities
    except ElementTree.ParseError as error:
        found = Finding(path, error.position[0], ERROR, "it is no XML", "export it again")
        return [_Table([], None, [found])]
    tables = []
    for node in root.iter():
        kind = node.tag.rpartition("}")[2]
        if kind == "LUT3D":
            found = Finding(path, None, ERROR, "it holds a 3-D LUT", "use a 1-D LUT for a curve")
            tables.append(_Table([], None, [found]))
        if kind not in ("LUT1D", "InverseLUT1D"):
            continue
        array = next((child for child in node if child.tag.endswith("Array")), None)
        text = "" if array is None else array.text or ""
        size = (array.get("dim", "") if array is not None else "").split()
        if _COMMA.search(text):
            problem = "a number has a decimal comma"
            found = Finding(path, None, ERROR, problem, "write decimal points")
            tables.append(_Table([], None, [found]))
            continue
        try:
            numbers = [float(word) for word in text.split()]
            width = int(size[-1])
            promised = int(size[0])
        except (ValueError, IndexError):
            found = Finding(path, None, ERROR, "an array is not numbers", "export it again")
            tables.append(_Table([], None, [found]))
            continue
        width = max(width, 1)
        rows: list[Row] = [(None, numbers[i : i + width]) for i in range(0, len(numbers), width)]
        if node.get("halfDomain") == "true":  # the entries of half floats from 0 to 1
            rows, promised = (rows[:15361], 15361) if len(rows) == promised else (rows, promised)
        tables.append(_Table(rows, promised, []))
    return tables


def _icc_tables(path: Path, content: bytes) -> list[_Table]:
    tables = []
    entries = content[132 : 132 + 12 * int.from_bytes(content[128:132], "big")]
    for start in range(0, len(entries) - 11, 12):
        signature, offset, size = struct.unpack_from(">4sII", entries, start)
        data = content[offset : offset + size]
        if signature in (b"rTRC", b"gTRC", b"bTRC") and data[:4] == b"curv" and len(data) > 14:
            count = int.from_bytes(data[8:12], "big")
            usable = (len(data) - 12) // 2
            codes = struct.unpack_from(f">{min(count, usable)}H", data, 12)
            tables.append(_Table([(None, [c / 65535]) for c in codes], count, []))
    if content[36:40] != b"acsp" or not tables:
        found = Finding(path, None, ERROR, "it is no ICC profile with curves", "export it again")
        return [_Table([], None, [found])]
    return tables


def _check(path: Path, table: _Table) -> list[Finding]:
    found = list(table.findings)
    if any(finding.severity == ERROR for finding in found) and not table.rows:
        return found

    def add(line: int | None, severity: str, problem: str, remedy: str) -> None:
        found.append(Finding(path, line, severity, problem, remedy))

    rows = table.rows
    if table.promised is not None and table.promised != len(rows):
        add(None, ERROR, f"{len(rows)} entries where {table.promised} are promised", "export again")
    if not rows:
        add(None, ERROR, "it has no entries", "export it again")
        return found
    bad = next((r for r in rows if not all(map(math.isfinite, r[1]))), None)
    if bad is not None:
        add(bad[0], ERROR, "an entry is NaN or infinite", "export it again")
        return found
    width = len(rows[0][1])
    odd = next((r for r in rows if len(r[1]) != width), None)
    if odd is not None or width not in (1, 3):
        add(
            odd[0] if odd else rows[0][0],
            ERROR,
            "entries are not of 1 or 3 numbers",
            "export again",
        )
        return found
    for channel in range(width):
        name = "RGB"[channel] if width == 3 else "the curve"
        column = [(line, numbers[channel]) for line, numbers in rows]
        found += _check_curve(path, name, column)
    return found


def _check_curve(path: Path, name: str, column: list[tuple[int | None, float]]) -> list[Finding]:
    found = []
    steps = [(b[1] - a[1], b[0]) for a, b in pairwise(column)]
    fall = next((step for step in steps if step[0] < 0), None)
    if fall is not None:
        remedy = "a response is monotone; calibrate again"
        found.append(Finding(path, fall[1], ERROR, f"{name} decreases", remedy))
    if len(column) < 16:
        return found
    jump = next((step for step in steps if step[0] > _STEEPEST), None)
    if jump is not None:
        problem = f"{name} jumps by {jump[0]:.3g}"
        found.append(Finding(path, jump[1], WARNING, problem, "check the table there"))
    flat = sum(value == column[-1][1] for _, value in column)
    if flat > max(len(column) // 50, 2):
        problem = f"the top {flat} entries of {name} are clipped"
        found.append(Finding(path, None, WARNING, problem, "check the table's upper end"))
    return found
