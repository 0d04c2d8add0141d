"""Small changes of bytes, of the kinds that parsers trip over."""

from __future__ import annotations

import random
import re
import struct
from collections.abc import Callable, Sequence

_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_NUMBERS = (
    *(b"0", b"-1", b"nan", b"-inf", b"1e999", b"1e-999", b"9" * 30, b"9" * 5000, b"2147483648"),
    *(b"4294967296", b"18446744073709551616", b"0x10", b"1,5", b"", b"1e308", b"65537"),
)
_WHOLE = (0, 1, 2, 127, 128, 255, 256, 32767, 32768, 65535, 65536, (1 << 31) - 1, 1 << 31)
_TEXTS = (b"\0", b"\xff\xfe", b"\xe9", b"../" * 8, b"[" * 5000, b"{" * 500, b'"', b"\r", b"\n" * 99)


def mutated(content: bytes, others: Sequence[bytes], chance: random.Random) -> bytes:
    """Content with one to six changes; parts of `others` may come in."""
    changed = bytearray(content)
    for _ in range(chance.choice((1, 1, 2, 3, 6))):
        chance.choice(_CHANGES)(changed, others, chance)
    return bytes(changed)


def _place(content: bytearray, chance: random.Random) -> int:
    """More often near the beginning, where headers are."""
    size = max(len(content), 1)
    return int(size * chance.random() ** chance.choice((1, 3)))


def _flip(content: bytearray, _: Sequence[bytes], chance: random.Random) -> None:
    if content:
        content[_place(content, chance)] ^= 1 << chance.randrange(8)


def _whole(content: bytearray, _: Sequence[bytes], chance: random.Random) -> None:
    at = _place(content, chance)
    kind = chance.choice(("<H", ">H", "<I", ">I", "B"))
    limit = (1 << 8 * struct.calcsize(kind)) - 1
    content[at : at + struct.calcsize(kind)] = struct.pack(kind, chance.choice(_WHOLE) & limit)


def _number(content: bytearray, _: Sequence[bytes], chance: random.Random) -> None:
    found = list(_NUMBER.finditer(bytes(content[: 1 << 16])))
    if found:
        one = chance.choice(found)
        content[one.start() : one.end()] = chance.choice(_NUMBERS)


def _cut(content: bytearray, _: Sequence[bytes], chance: random.Random) -> None:
    at = _place(content, chance)
    del content[at : at + chance.choice((1, 4, 40, 4000, len(content)))]


def _repeat(content: bytearray, _: Sequence[bytes], chance: random.Random) -> None:
    at = _place(content, chance)
    content[at:at] = content[at : at + chance.choice((1, 4, 40, 4000))] * chance.choice((1, 2, 9))


def _insert(content: bytearray, _: Sequence[bytes], chance: random.Random) -> None:
    at = _place(content, chance)
    content[at:at] = chance.choice(_TEXTS)


def _splice(content: bytearray, others: Sequence[bytes], chance: random.Random) -> None:
    other = chance.choice(others)
    start, at = chance.randrange(len(other) or 1), _place(content, chance)
    content[at : at + chance.choice((0, 64))] = other[start : start + chance.choice((8, 64, 1024))]


_Change = Callable[[bytearray, Sequence[bytes], random.Random], None]
_CHANGES: tuple[_Change, ...] = (_flip, _whole, _number, _cut, _repeat, _insert, _splice)
