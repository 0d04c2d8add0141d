"""Damage to files of any kind, drawn from what damages files in the world and in attacks."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

HOSTILE_WORDS = (
    *(b"nan", b"inf", b"-inf", b"1e999", b"-1", b"0", b"1e-50", b"0,5", b"1_0", b"\xc2\xb2"),
    *(b"2147483648", b"4294967295", b"9" * 400, b"1" * 5000, b"#", b"{", b"}", b"<", b"&x;", b'"'),
    *(b"3D", b"1D", b"BEGIN METADATA", b"END METADATA", b"LUT_3D_SIZE 99", b"\r", b"\n\n", b"\0"),
)
_WORD = re.compile(rb"[^\s<>=\"]+")
_LONGEST = 1 << 20  # [byte] of what comes out


def mutated(content: bytes, rng: random.Random) -> bytes:
    """Return content with one to four kinds of damage, mostly near its head, where meaning is."""
    for _ in range(rng.randint(1, 4)):
        content = rng.choice(_DAMAGES)(content, rng)[:_LONGEST]
    return content


def _place(content: bytes, rng: random.Random) -> int:
    return rng.randint(0, min(len(content), rng.choice((64, 256, 1024, len(content)))))


def _bytes(content: bytes, rng: random.Random) -> bytes:
    start = _place(content, rng)
    return content[:start] + rng.randbytes(rng.randint(1, 8)) + content[start + rng.randint(0, 8) :]


def _bit(content: bytes, rng: random.Random) -> bytes:
    if not content:
        return content
    start = min(_place(content, rng), len(content) - 1)
    return (
        content[:start] + bytes([content[start] ^ (1 << rng.randint(0, 7))]) + content[start + 1 :]
    )


def _cut(content: bytes, rng: random.Random) -> bytes:
    start = _place(content, rng)
    end = len(content) if rng.random() < 0.3 else start + rng.randint(1, 200)
    return content[:start] + content[end:]


def _word(content: bytes, rng: random.Random) -> bytes:
    """Another word in the place of one; the same everywhere, at times."""
    words = _WORD.findall(content[: rng.choice((256, 2048, len(content)))])
    if not words:
        return content + rng.choice(HOSTILE_WORDS)
    return content.replace(rng.choice(words), rng.choice(HOSTILE_WORDS), rng.choice((1, 1, 1, -1)))


def _repeat(content: bytes, rng: random.Random) -> bytes:
    start = _place(content, rng)
    piece = content[start : start + rng.randint(1, 400)]
    return content[:start] + piece * rng.choice((2, 3, 50, 500)) + content[start:]


def _line(content: bytes, rng: random.Random) -> bytes:
    """Lines dropped, doubled or moved."""
    lines = content.split(b"\n")
    index = rng.randrange(min(len(lines), rng.choice((12, len(lines)))))
    line = lines.pop(index)
    if rng.random() < 0.7:
        lines.insert(rng.randint(0, len(lines)), line)
    return b"\n".join([*lines, line] if rng.random() < 0.2 else lines)


_DAMAGES: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    _bytes,
    _bit,
    _cut,
    _word,
    _word,
    _repeat,
    _line,
)
