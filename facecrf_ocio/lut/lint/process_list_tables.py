"""Tables in XML process lists: .clf, .ctf."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from facecrf_ocio.lut.lint.finding import (
    DECIMAL_COMMA,
    MOST_ENTRIES,
    Table,
    broken,
    count,
    number,
)

# What 1 is in arrays for each bit depth (Academy S-2014-006).
_WHITE = {"8i": 255.0, "10i": 1023.0, "12i": 4095.0, "16i": 65535.0}


@dataclass(slots=True)
class _Array:
    """Numbers of one node: its kind, attributes and line, the array's own, first line, text."""

    kind: str
    node: Mapping[str, str]
    node_line: int
    dim: str
    line: int
    text: list[str] = field(default_factory=list)


class _Reader:
    """Collects a file's arrays with their lines, which ElementTree does not tell."""

    def __init__(self) -> None:
        self.arrays: list[_Array] = []
        self.count = 0
        self._nodes: list[tuple[str, Mapping[str, str], int]] = []
        self._open: _Array | None = None
        self._parser = expat.ParserCreate()
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._text

    def read(self, content: bytes) -> None:
        self._parser.Parse(content, True)

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        kind = tag.rpartition(":")[2]
        self.count += 1
        if kind == "Array" and self._nodes:
            dim = attributes.get("dim", "")
            self._open = _Array(*self._nodes[-1], dim, self._parser.CurrentLineNumber)
            self.arrays.append(self._open)
        self._nodes.append((kind, attributes, self._parser.CurrentLineNumber))

    def _end(self, _: str) -> None:
        self._nodes.pop()
        self._open = None

    def _text(self, text: str) -> None:
        if self._open is not None:
            self._open.text.append(text)


def process_list_tables(path: Path, content: bytes) -> list[Table]:
    """Every one-dimensional table of a file; matrices and 3-D LUTs only if they are wrong.

    None, where it is made of formulas.
    """
    reader = _Reader()
    try:
        reader.read(content)
    except expat.ExpatError as error:
        return [broken(path, error.lineno, "it is no XML", "export it again")]
    except (LookupError, ValueError):
        return [broken(path, 1, "it has an encoding nobody knows", "export it as UTF-8")]
    if reader.count <= 1:
        problem = "it holds no 1-D LUT and nothing else"
        return [broken(path, None, problem, "export it again")]
    return [table for array in reader.arrays for table in _tables(path, array)]


def _tables(path: Path, array: _Array) -> Iterator[Table]:
    if array.kind == "LUT3D":
        sizes = [count(word) for word in array.dim.split()]
        if len(sizes) != 4 or None in sizes:
            yield broken(path, array.node_line, _BAD_SOLID, "export it again")
        return
    if array.kind not in ("LUT1D", "InverseLUT1D", "Matrix"):
        return
    try:
        numbers = list(_numbers(array))
        promised, width = _size(array)
    except _NotANumberError as error:
        line, word = error.args
        if DECIMAL_COMMA.search(word):
            yield broken(path, line, "a number has a decimal comma", "write decimal points")
        else:
            yield broken(path, line, "an array is not numbers", "export it again")
        return
    except ValueError:
        yield broken(path, array.line, "an array's dim is not numbers", "export it again")
        return
    if array.kind == "Matrix":
        bad = next((line for line, value in numbers if not math.isfinite(value)), None)
        if bad is not None:
            yield broken(path, bad, "a matrix holds NaN or infinities", "export it again")
        return
    white = _white(array)
    rows = [
        (numbers[i][0], [value / white for _, value in numbers[i : i + width]])
        for i in range(0, len(numbers), width)
    ]
    step = 0.0 if white == 1.0 else 1.0 / white
    half_domain = array.node.get("halfDomain") == "true"
    yield Table(rows, promised, (), array.line, step, half_domain=half_domain)


_BAD_SOLID = "the dim of a 3-D LUT is not 4 numbers"


class _NotANumberError(Exception):
    """Line and word."""


def _size(array: _Array) -> tuple[int, int]:
    """Entries that an array promises, and numbers of each."""
    sizes = [count(word) for word in array.dim.split()]
    promised, width = (sizes[0], sizes[-1]) if sizes else (None, None)
    if promised is None or width is None:
        raise ValueError(array.dim)
    return promised, max(width, 1)


def _numbers(array: _Array) -> Iterator[tuple[int, float]]:
    """Line and value of each number, of as many as a table may have."""
    raw_halfs = array.node.get("rawHalfs") == "true"
    left = 3 * MOST_ENTRIES
    for line, text in enumerate("".join(array.text).split("\n"), start=array.line):
        for word in text.split():
            left -= 1
            if left < 0:
                return
            value = _raw_half(word) if raw_halfs else number(word)
            if value is None:
                raise _NotANumberError(line, word)
            yield line, value


def _raw_half(word: str) -> float | None:
    bits = count(word)
    if bits is None or bits > 0xFFFF:
        return None
    return float(struct.unpack("e", struct.pack("H", bits))[0])


def _white(array: _Array) -> float:
    depth = "inBitDepth" if array.kind == "InverseLUT1D" else "outBitDepth"
    return _WHITE.get(array.node.get(depth, ""), 1.0)
