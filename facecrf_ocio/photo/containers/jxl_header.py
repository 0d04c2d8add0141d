"""The header of a JPEG XL, as far as what tells whether its picture moves (ISO/IEC 18181-1)."""

from __future__ import annotations

_CODESTREAM, _CONTAINER = b"\xff\x0a", b"\0\0\0\x0cJXL \r\n\x87\n"
_HEAD = 64  # [byte] of a codestream; what is asked for lies in the first 40 at most
_SIZE = (9, 13, 18, 30)  # [bit] of a side that is no multiple of 8, by its selector
_PREVIEW, _PREVIEW_BY_8 = (6, 8, 10, 12), (0, 0, 5, 9)  # [bit] of a preview's, likewise


def moves(content: bytes) -> bool:
    """Whether a file is a JPEG XL of several pictures, one after the other in time."""
    bits = _Bits(_codestream(content))
    if bits.take(16) != int.from_bytes(_CODESTREAM, "little"):
        return False
    _pass_size(bits)
    plain, more = bits.take(1), bits.take(1)
    if plain or not more:
        return False
    bits.take(3)  # orientation
    if bits.take(1):
        _pass_size(bits)
    if bits.take(1):
        by_8 = bits.take(1)
        _pass_sides(bits, _PREVIEW_BY_8 if by_8 else _PREVIEW)
    return bool(bits.take(1))


class _Bits:
    """Bits of a codestream, the lowest of each byte first; 0 after its end."""

    def __init__(self, head: bytes) -> None:
        self.left = int.from_bytes(head, "little")

    def take(self, count: int) -> int:
        taken = self.left & ((1 << count) - 1)
        self.left >>= count
        return taken


def _pass_size(bits: _Bits) -> None:
    _pass_sides(bits, None if bits.take(1) else _SIZE)


def _pass_sides(bits: _Bits, kinds: tuple[int, ...] | None) -> None:
    """Pass over a height, and a width where no number stands for the ratio; None is by 8."""
    _pass_side(bits, kinds)
    if bits.take(3) == 0:
        _pass_side(bits, kinds)


def _pass_side(bits: _Bits, kinds: tuple[int, ...] | None) -> None:
    bits.take(5 if kinds is None else kinds[bits.take(2)])


def _codestream(content: bytes) -> bytes:
    """How it begins; in a container (ISO/IEC 18181-2) in the first box that has some of it."""
    if not content.startswith(_CONTAINER):
        return content[:_HEAD]
    at = 0
    while at + 16 <= len(content):
        size, kind, body = int.from_bytes(content[at : at + 4], "big"), content[at + 4 : at + 8], 8
        if size == 1:
            size, body = int.from_bytes(content[at + 8 : at + 16], "big"), 16
        if kind in (b"jxlc", b"jxlp"):
            begin = at + body + 4 * (kind == b"jxlp")  # after a part's number
            return content[begin : begin + _HEAD]
        if size < body:
            break
        at += size
    return b""
