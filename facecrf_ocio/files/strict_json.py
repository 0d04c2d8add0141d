"""JSON that every reader accepts: no NaN, full precision, arrays of numbers on one line."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt

# A number beyond 1e308 has an exponent of three digits, or more digits than that. Asking Python for
# each of thousands of others takes longer than all the rest of reading. What follows a number tells
# it from the digits of a hash. Sought where all digits are alike and every E is small: `re` finds
# one letter six times as fast as one of two.
_LONG_EXPONENT = re.compile(rb'e[+]?000+(?![\w"])')
_ALIKE = bytes.maketrans(b"E123456789", b"e000000000")
_MOST_DIGITS = 300  # of a number; the largest double has 309
_ENCODER = json.JSONEncoder(ensure_ascii=False, allow_nan=False)


def dump(record: Mapping[str, object]) -> bytes:
    """Write a record as UTF-8; numbers that are not finite become null."""
    # What UTF-8 cannot hold, bytes of a file name that are no text, becomes JSON's own escape.
    return (_layout(_plain(record), "") + "\n").encode("utf-8", "backslashreplace")


def load(content: bytes) -> Any:
    """Read what `dump` wrote, or raise ValueError."""
    checked = _finite if _may_overflow(content) else float
    return json.loads(content.decode("utf-8"), parse_constant=_refuse, parse_float=checked)


def _may_overflow(content: bytes) -> bool:
    # Not one pattern: `re` finds a letter fast, and takes every digit for the first of 300.
    alike = content.translate(_ALIKE)
    return _MOST_DIGITS * b"0" in alike or _LONG_EXPONENT.search(alike) is not None


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text[:20]} is more than a number can hold")
    return number


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not JSON")


def _plain(value: object) -> object:
    """Return the value in JSON's own types."""
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, np.ndarray):
        return _plain_array(value)
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return _plain_items(value)
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _plain_array(values: npt.NDArray[Any]) -> Any:
    finite = np.isfinite(values)
    if finite.all():
        return values.tolist()
    numbers = values.astype(object)
    numbers[~finite] = None
    return numbers.tolist()


def _plain_items(values: Sequence[object]) -> list[object]:
    kinds = set(map(type, values))  # rows of thousands of numbers, most of them
    if kinds <= {int, str}:
        return list(values)
    if kinds == {float}:
        return [item if math.isfinite(item) else None for item in values]  # type: ignore[arg-type]
    return [_plain(item) for item in values]


def _layout(value: object, indent: str) -> str:
    inner = indent + "  "
    if isinstance(value, dict) and value:
        items = [f"{json.dumps(key)}: {_layout(item, inner)}" for key, item in value.items()]
        return "{\n" + ",\n".join(inner + item for item in items) + f"\n{indent}}}"
    if isinstance(value, list) and any(isinstance(item, list | dict) for item in value[:1]):
        return "[\n" + ",\n".join(inner + _layout(item, inner) for item in value) + f"\n{indent}]"
    return _ENCODER.encode(value)
