"""Remarks that may stand in any LUT file without breaking it."""

from __future__ import annotations

from collections.abc import Sequence

# OCIO's .spi1d reader fails on lines of 4096 bytes; escapes take up to ten bytes per character.
_LONGEST = 300


def remark(text: str) -> str:
    """A text as one printable line, with the rest escaped and what is long cut."""
    words = " ".join(text.split())
    shown = words if len(words) <= _LONGEST else words[:_LONGEST] + "..."
    if shown.isprintable():
        return shown
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in shown)


def hash_comments(comments: Sequence[str]) -> str:
    """Write comments as ASCII lines that start with "# "."""
    text = "".join(f"# {remark(comment)}\n" for comment in comments)
    return text.encode("ascii", "backslashreplace").decode("ascii")
