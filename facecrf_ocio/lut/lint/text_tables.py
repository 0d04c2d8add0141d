"""Tables in text files: .spi1d, .cube of either style, .csp."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from facecrf_ocio.lut.lint.finding import (
    CODE_WHITES,
    DECIMAL_COMMA,
    ERROR,
    MOST_ENTRIES,
    WARNING,
    Finding,
    Row,
    Table,
    broken,
    count,
    number,
)

_KEYWORDS = {
    *("version", "from", "length", "components", "{"),
    *("lut_1d_size", "lut_1d_input_range", "lut_3d_size", "lut_3d_input_range"),
    *("domain_min", "domain_max"),
    "bmd_title",  # Blackmagic Design's own LUTs; OpenColorIO passes over it
}
_TITLE = re.compile(rb"^TITLE\b", re.IGNORECASE | re.MULTILINE)
_DOMAIN = re.compile(rb"^LUT_[13]D_INPUT_RANGE\b", re.IGNORECASE | re.MULTILINE)
_MOST_UNKNOWN = 3  # unknown keywords told of; the others are like them
_Lines = Iterator[tuple[int, list[str]]]


def keyed_tables(path: Path, content: bytes) -> list[Table]:
    """The table of a .spi1d or a .cube of either style, with what is odd in it."""
    tables = _tables(path, content, _keyed)
    title, domain = _TITLE.search(content), _DOMAIN.search(content)
    if title and domain:  # of Iridas' style, and of Resolve's
        line = content.count(b"\n", 0, title.start()) + 1
        problem = "it has a TITLE and an INPUT_RANGE, of which OpenColorIO reads either"
        tables.append(broken(path, line, problem, "take the line with TITLE out"))
    return tables


def csp_tables(path: Path, content: bytes) -> list[Table]:
    """The table of a .csp, with what is odd in it."""
    return _tables(path, content, _csp)


def _tables(path: Path, content: bytes, read: Callable[[Path, _Lines], list[Table]]) -> list[Table]:
    if content.startswith(b"\xef\xbb\xbf"):
        problem = "it begins with a byte-order mark, which belongs to no LUT"
        return [broken(path, 1, problem, "save it as plain ASCII")]
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return [broken(path, 1, "it is UTF-16, two bytes a letter", "save it as plain ASCII")]
    if b"\r" in content and b"\n" not in content:
        return [broken(path, 1, "its lines end in CR alone", "save it with LF, or CR and LF")]
    line = decimal_comma(content)
    if line:
        return [broken(path, line, "a number has a decimal comma", "write decimal points")]
    return read(path, _lines(content.decode("utf-8", "replace")))


def decimal_comma(content: bytes) -> int:
    """The first line of a text's numbers that has a decimal comma, 0 if none has.

    OpenColorIO reads such numbers up to the comma, without a word.
    """
    if b"," not in content:
        return 0
    lines = _lines(content.decode("utf-8", "replace"))
    return next((n for n, words in lines if any(map(DECIMAL_COMMA.search, words))), 0)


def _lines(text: str) -> _Lines:
    """Number and words of the lines that are neither empty nor remarks, up to a table's end."""
    in_notes = False
    for line, raw in enumerate(text.split("\n"), start=1):
        words = (raw.partition("#")[0] if "#" in raw else raw).split()
        if not words:
            continue
        first = words[0]
        if first in ("BEGIN", "END") and words[1:2] == ["METADATA"]:
            in_notes = first == "BEGIN"
        elif first == "}":
            return
        elif not in_notes and not (first[0] in "tT" and first.upper().startswith("TITLE")):
            yield line, words


@dataclass
class _Read:
    """What was read of a file: rows of the 1-D table and of the 3-D one behind it, sizes."""

    path: Path
    rows: list[Row] = field(default_factory=list)
    more: int = 0
    size: tuple[int, str] | None = None
    solid: tuple[int, str] | None = None
    findings: list[Finding] = field(default_factory=list)
    of_codes: bool = True

    def add(self, line: int | None, problem: str, remedy: str, severity: str = ERROR) -> None:
        self.findings.append(Finding(self.path, line, severity, problem, remedy))

    @property
    def is_over(self) -> bool:
        """Whether there are more rows than promised, which is wrong whatever stands in them."""
        return self.more > 0 and self.solid is None

    def row(self, line: int, words: Sequence[str]) -> None:
        if self.is_over:
            self.more += 1
            return
        numbers = self._numbers(line, words)
        promised = count(self.size[1]) if self.size else None
        if self.solid is not None and self.size is None:
            promised = 0
        if len(self.rows) < (MOST_ENTRIES if promised is None else min(promised, MOST_ENTRIES)):
            self.rows.append((line, numbers))
            return
        self.more += 1
        if self.solid and not all(abs(one) < float("inf") for one in numbers):  # NaN fails too
            self.add(line, "an entry is NaN or infinite", "export it again")

    def _numbers(self, line: int, words: Sequence[str]) -> list[float]:
        try:
            if "_" not in "".join(words):  # so are most, and there may be a million
                return list(map(float, words))
        except ValueError:
            pass
        numbers = [found for found in map(number, words) if found is not None]
        if len(numbers) < len(words):
            self.add(line, "a row is not numbers", "export it again")
        return numbers

    def domain(self, line: int, name: str, nodes: Sequence[Sequence[str]]) -> None:
        """Check nodes that shall increase, each given for one channel or for R, G, B."""
        width = len(nodes[0]) if nodes else 0
        words = [word for node in nodes for word in node]
        unlike = not width or any(len(node) != width for node in nodes)
        if unlike or any(number(word) is None for word in words):
            self.add(line, f"{name} is not numbers", "write 0 to 1")
            return
        for channel, column in enumerate(zip(*nodes, strict=True)):
            values = [float(word) for word in column]
            of = f"{name} of {'RGB'[channel]}" if width == 3 else name
            self.of_codes &= values[0] >= 0.0 and values[-1] <= 1.0
            if any(a > b for a, b in pairwise(values)):
                self.add(line, f"{of} is reversed", "write the lower end first")
            elif not values[0] < values[-1]:
                self.add(line, f"{of} is empty", "write 0 to 1")
            elif values[-1] in CODE_WHITES:  # scene-linear light may go anywhere else
                problem = f"{of} goes up to {values[-1]:g}, where OpenColorIO's codes go to 1"
                self.add(line, problem, "write 0 to 1", WARNING)

    def tables(self) -> list[Table]:
        """What there is to check of all this."""
        solid = self._solid()
        if self.size is None and self.solid is not None:
            return solid
        line = promised = None
        if self.size is None:
            self.add(None, "no size is given", "write how many entries follow")
        else:
            line, text = self.size
            promised = count(text)
            if promised is None:
                shown = text if len(text) < 40 else f"{text[:40]}..."
                self.add(line, f"the size is {shown!r}", "write how many entries follow")
        if self.more and self.solid is None and promised is not None:
            total = len(self.rows) + self.more
            self.add(line, f"{total} entries where {promised} are promised", "export it again")
        findings = tuple(self.findings)
        return [Table(self.rows, promised, findings, line, of_codes=self.of_codes), *solid]

    def _solid(self) -> list[Table]:
        """A 3-D LUT is no curve to check, but has as many entries as it promises."""
        if self.solid is None:
            return []
        line, text = self.solid
        edge = count(text)
        entries = self.more if self.size else len(self.rows) + self.more
        if edge is None or entries != edge**3:
            problem = f"it is a 3-D LUT with {entries} entries where {text[:40]}^3 are promised"
            return [broken(self.path, line, problem, "export it again")]
        found = tuple(self.findings) if self.size is None else ()
        return [Table([(None, [0.0]), (None, [1.0])], findings=found)]


def _keyed(path: Path, lines: _Lines) -> list[Table]:
    """.spi1d and .cube: keywords, then rows."""
    read = _Read(path)
    ends: dict[str, tuple[int, list[str]]] = {}
    unknown = 0
    for line, words in lines:
        if read.is_over and words[0][0].isdigit():
            read.more += 1  # without another look, as there may be millions
            continue
        key, values = words[0].lower(), words[1:]
        if number(key) is not None:
            read.row(line, words)
        elif key in ("length", "lut_1d_size") and values:
            read.size = line, values[-1]
        elif key == "lut_3d_size" and values:
            read.solid = line, values[-1]
        elif key in ("from", "lut_1d_input_range") and len(values) == 2:
            read.domain(line, "the domain", [[value] for value in values])
        elif key in ("domain_min", "domain_max"):
            ends[key] = line, values
        elif key not in _KEYWORDS and unknown < _MOST_UNKNOWN:
            unknown += 1
            read.add(line, f"no keyword {words[0][:40]!r} is known", "check the line", WARNING)
    if ends:
        line = min(line for line, _ in ends.values())
        low, high = (ends.get(k, (0, [default] * 3))[1] for k, default in _DEFAULT_ENDS)
        read.domain(line, "the domain", [low, high])
    return read.tables()


_DEFAULT_ENDS = (("domain_min", "0"), ("domain_max", "1"))


def _csp(path: Path, lines: _Lines) -> list[Table]:
    """cineSpace: a shaper for each channel (size, input, output), the size, then rows."""
    read = _Read(path)
    _, words = next(lines, (0, [""]))
    if words[0].upper() != "CSPLUTV100":
        return [broken(path, 1, "it does not begin with CSPLUTV100", "export it again")]
    _, kind = next(lines, (0, [""]))
    line = 0
    for name in "RGB":
        line, words = next(lines, (line, []))
        if words in (["0"], ["1"]):
            continue  # an identity
        for what in ("domain", "shaper"):
            line, words = next(lines, (line, []))
            if not words:
                return [broken(path, None, "it ends before its table", "copy it again")]
            read.domain(line, f"the {what} of {name}", [[word] for word in words])
    line, words = next(lines, (line, []))
    if kind[0].upper() == "3D" and len(words) == 3:
        return []  # no curve; OpenColorIO counts its entries
    if len(words) == 1:
        read.size = line, words[0]
    elif words:
        read.row(line, words)
    for line, words in lines:
        read.row(line, words)
    return read.tables()
