"""Curves in ICC profiles: of integers, of a formula, of floats (ICC.1:2022, 10.6, 10.16, 10.18)."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

from facecrf_ocio.lut.lint.finding import Table, broken

_PARAMETERS = (1, 3, 4, 5, 7)  # of the kinds of parametric curves
_SAMPLES = 256  # of a parametric curve: one for each 8-bit code
_MOST_CURVES = 32
"""Of one profile: three for red, green, blue, and twelve in the float tags of four intents."""
_MOST_PARTS = 64
"""Elements of a tag, channels of an element or segments of a curve that are looked at."""


def icc_tables(path: Path, content: bytes) -> list[Table]:
    """One table per curve of red, green, blue; formulas sampled."""
    try:
        found = (table for tag in _tags(content) for table in _tag_tables(path, *tag))
        tables = list(islice(found, _MOST_CURVES + 1))
    except (struct.error, OverflowError, ZeroDivisionError):
        return [broken(path, None, "a curve is cut short or no function", "export it again")]
    if len(tables) > _MOST_CURVES:
        problem = f"it holds more than {_MOST_CURVES} curves"
        return [broken(path, None, problem, "export it again")]
    if content[36:40] != b"acsp" or not tables:
        return [broken(path, None, "it is no ICC profile with curves", "export it again")]
    return tables


def _tags(content: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Signature and content of each tag, shared contents once."""
    entries = content[132 : 132 + 12 * int.from_bytes(content[128:132], "big")]
    seen = set()
    for start in range(0, len(entries) - 11, 12):
        signature, offset, size = struct.unpack_from(">4sII", entries, start)
        if signature in (b"rTRC", b"gTRC", b"bTRC") or (
            signature.startswith(b"D2B") and offset not in seen
        ):
            seen.add(offset)
            yield signature, content[offset : offset + size]


def _tag_tables(path: Path, signature: bytes, data: bytes) -> Iterator[Table]:
    name = f"the curve {signature.decode('ascii', 'replace')}"
    if data[:4] == b"curv":
        (count,) = struct.unpack_from(">I", data, 8)
        if count > 1:  # none is the identity, one a power
            codes = struct.unpack_from(f">{min(count, (len(data) - 12) // 2)}H", data, 12)
            yield Table(
                [(None, [code / 65535]) for code in codes], count, step=1 / 65535, name=name
            )
        elif count == 1 and data[12:14] == bytes(2):
            yield broken(path, None, f"{name} is a power of 0", "export it again")
        else:
            yield Table([(None, [0.0]), (None, [1.0])])
    elif data[:4] == b"para":
        kind = int.from_bytes(data[8:10], "big")
        if kind >= len(_PARAMETERS):
            yield broken(path, None, f"{name} is of an unknown kind", "export it again")
            return
        fixed = struct.unpack_from(f">{_PARAMETERS[kind]}i", data, 12)
        parameters = [number / 65536 for number in fixed]
        places = [index / (_SAMPLES - 1) for index in range(_SAMPLES)]
        yield Table([(None, [_parametric(kind, parameters, place)]) for place in places], name=name)
    elif data[:4] == b"mpet":
        yield from _elements(data)


def _parametric(kind: int, parameters: Sequence[float], x: float) -> float:
    g, a, b, c, d, e, f = (*parameters, *(0.0,) * 7)[:7]
    if kind == 0:
        return float(x**g)
    if kind in (1, 2):  # kind 1 has no c
        return float((a * x + b) ** g + c) if a * x >= -b else c
    if x < d:
        return c * x + f
    power = (a * x + b) ** g
    return math.nan if isinstance(power, complex) else float(power + e)


def _elements(data: bytes) -> Iterator[Table]:
    """Sampled segments of the curve sets among the elements."""
    (count,) = struct.unpack_from(">I", data, 12)
    for index in range(min(count, _MOST_PARTS)):
        start, size = struct.unpack_from(">II", data, 16 + 8 * index)
        element = data[start : start + size]
        if element[:4] != b"cvst":
            continue
        (channels,) = struct.unpack_from(">H", element, 8)
        for channel in range(min(channels, _MOST_PARTS)):
            start, size = struct.unpack_from(">II", element, 12 + 8 * channel)
            yield from _segments(element[start : start + size])


def _segments(curve: bytes) -> Iterator[Table]:
    (count,) = struct.unpack_from(">H", curve, 8)
    place = 12 + 4 * (count - 1)
    for _ in range(min(count, _MOST_PARTS)):
        kind = curve[place : place + 4]
        if kind == b"samf":
            (size,) = struct.unpack_from(">I", curve, place + 8)
            samples = struct.unpack_from(f">{size}f", curve, place + 12)
            yield Table([(None, [sample]) for sample in samples], size)
            place += 12 + 4 * size
        else:
            (formula,) = struct.unpack_from(">H", curve, place + 8)
            place += 12 + 4 * (4 if formula == 0 else 5)
