"""One-dimensional .cube LUT in the style of DaVinci Resolve."""

from __future__ import annotations

from collections.abc import Sequence

from facecrf_ocio.export.comments import hash_comments
from facecrf_ocio.export.table import LUT_LENGTH, table_rows
from facecrf_ocio.values import InverseCRF


def cube_text(curve: InverseCRF, comments: Sequence[str] = ()) -> str:
    """Return the file's text; the style allows comments only before the header, and no TITLE."""
    header = f"LUT_1D_SIZE {LUT_LENGTH}\nLUT_1D_INPUT_RANGE 0 1\n"
    return f"{hash_comments(comments)}{header}{table_rows(curve)}"
