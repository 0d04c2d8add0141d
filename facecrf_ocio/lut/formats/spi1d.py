"""Sony Pictures Imageworks 1-D LUT (.spi1d), which every OCIO host reads."""

from __future__ import annotations

from collections.abc import Sequence

from facecrf_ocio.lut.comments import hash_comments
from facecrf_ocio.lut.transform import LutTransform, uniform_rows


def spi1d_text(transform: LutTransform, comments: Sequence[str] = ()) -> str:
    """Return the file's text; comments stand behind the table, where no reader looks."""
    length, rows = uniform_rows(transform)
    header = f"Version 1\nFrom 0 1\nLength {length}\nComponents 3\n"
    return f"{header}{{\n{rows}}}\n{hash_comments(comments)}"
