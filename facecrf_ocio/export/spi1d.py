"""Sony Pictures Imageworks 1-D LUT (.spi1d), which every OCIO host reads."""

from __future__ import annotations

from collections.abc import Sequence

from facecrf_ocio.export.comments import hash_comments
from facecrf_ocio.export.table import LUT_LENGTH, table_rows
from facecrf_ocio.values import InverseCRF


def spi1d_text(curve: InverseCRF, comments: Sequence[str] = ()) -> str:
    """Return the file's text; comments stand behind the table, where no reader looks."""
    header = f"Version 1\nFrom 0 1\nLength {LUT_LENGTH}\nComponents 3\n"
    return f"{header}{{\n{table_rows(curve)}}}\n{hash_comments(comments)}"
