"""Tables in XML process lists: .clf, .ctf."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from facecrf_ocio.lut.lint.finding import DECIMAL_COMMA, Table, broken

# What 1 is in arrays for each bit depth (Academy S-2014-006).
_WHITE = {"8i": 255.0, "10i": 1023.0, "12i": 4095.0, "16i": 65535.0}
_HALF_ONE = 15361  # half floats from 0 to 1


@dataclass(slots=True)
class _Array:
    """Numbers of one node: its kind and attributes, the array's own, first line, text."""

    kind: str
    node: Mapping[str, str]
    dim: str
    line: int
    text: list[str] = field(default_factory=list)


class _Reader:
    """Collects a file's arrays with their lines, which ElementTree does not tell."""

    def __init__(self) -> None:
        self.arrays: list[_Array] = []
        self.solids: list[int] = []
        self._nodes: list[tuple[str, Mapping[str, str]]] = []
        self._open: _Array | None = None
        self._parser = expat.ParserCreate()
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._text

    def read(self, content: bytes) -> None:
        self._parser.Parse(content, True)

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        kind = tag.rpartition(":")[2]
        if kind == "LUT3D":
            self.solids.append(self._parser.CurrentLineNumber)
        if kind == "Array" and self._nodes:
            dim = attributes.get("dim", "")
            self._open = _Array(*self._nodes[-1], dim, self._parser.CurrentLineNumber)
            self.arrays.append(self._open)
        self._nodes.append((kind, attributes))

    def _end(self, _: str) -> None:
        self._nodes.pop()
        self._open = None

    def _text(self, text: str) -> None:
        if self._open is not None:
            self._open.text.append(text)


def process_list_tables(path: Path, content: bytes) -> list[Table]:
    """Every one-dimensional table of a file; matrices and 3-D LUTs only if they are wrong."""
    reader = _Reader()
    try:
        reader.read(content)
    except expat.ExpatError as error:
        return [broken(path, error.lineno, "it is no XML", "export it again")]
    except (LookupError, ValueError):
        return [broken(path, 1, "it has an encoding nobody knows", "export it as UTF-8")]
    tables = [
        broken(path, line, "it holds a 3-D LUT", "use a 1-D LUT for a curve")
        for line in reader.solids
    ]
    for array in reader.arrays:
        if array.kind in ("LUT1D", "InverseLUT1D", "Matrix"):
            tables += _tables(path, array)
    if not any(array.kind.endswith("LUT1D") for array in reader.arrays) and not tables:
        return [broken(path, None, "it holds no 1-D LUT", "export it again")]
    return tables


def _tables(path: Path, array: _Array) -> Iterator[Table]:
    try:
        numbers = list(_numbers(array))
        size = [int(word) for word in array.dim.split()]
        promised, width = size[0], max(size[-1], 1)
    except _NotANumberError as error:
        line, word = error.args
        if DECIMAL_COMMA.search(word):
            yield broken(path, line, "a number has a decimal comma", "write decimal points")
        else:
            yield broken(path, line, "an array is not numbers", "export it again")
        return
    except (ValueError, IndexError):
        yield broken(path, array.line, "an array's dim is not numbers", "export it again")
        return
    if array.kind == "Matrix":
        bad = next((line for line, number in numbers if not math.isfinite(number)), None)
        if bad is not None:
            yield broken(path, bad, "a matrix holds NaN or infinities", "export it again")
        return
    white = _white(array)
    rows = [
        (numbers[i][0], [number / white for _, number in numbers[i : i + width]])
        for i in range(0, len(numbers), width)
    ]
    if array.node.get("halfDomain") == "true" and len(rows) == promised:
        rows, promised = rows[:_HALF_ONE], min(promised, _HALF_ONE)  # other half floats follow
    step = 0.0 if white == 1.0 else 1.0 / white
    yield Table([*rows], promised, (), array.line, step)


class _NotANumberError(Exception):
    """Line and word."""


def _numbers(array: _Array) -> Iterator[tuple[int, float]]:
    """Line and value of each number."""
    raw_halfs = array.node.get("rawHalfs") == "true"
    for line, text in enumerate("".join(array.text).split("\n"), start=array.line):
        for word in text.split():
            try:
                number = float(word)
                if raw_halfs:
                    (number,) = struct.unpack("e", struct.pack("H", int(word)))
            except (ValueError, struct.error) as error:
                raise _NotANumberError(line, word) from error
            yield line, number


def _white(array: _Array) -> float:
    depth = "inBitDepth" if array.kind == "InverseLUT1D" else "outBitDepth"
    return _WHITE.get(array.node.get(depth, ""), 1.0)
