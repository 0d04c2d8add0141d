"""The gamma that a PNG tells, where its value is none."""

from __future__ import annotations

_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def has_void_gamma(content: bytes) -> bool:
    """Whether a PNG's gAMA is zero, which says nothing (PNG, third edition, 11.3.2.2).

    OpenImageIO takes it for linear.
    """
    at = len(_SIGNATURE)
    while content.startswith(_SIGNATURE):
        kind, length = content[at + 4 : at + 8], int.from_bytes(content[at : at + 4], "big")
        if kind in (b"", b"IDAT", b"IEND"):
            return False
        if kind == b"gAMA":
            return not any(content[at + 8 : at + 12])
        at += length + 12
    return False
