"""One-dimensional .cube LUT in the style of DaVinci Resolve."""

from __future__ import annotations

from collections.abc import Sequence

from facecrf_ocio.lut.comments import hash_comments
from facecrf_ocio.lut.transform import LutTransform, uniform_rows


def cube_text(transform: LutTransform, comments: Sequence[str] = ()) -> str:
    """Return the file's text; the style allows comments only before the header, and no TITLE."""
    length, rows = uniform_rows(transform)
    header = f"LUT_1D_SIZE {length}\nLUT_1D_INPUT_RANGE 0 1\n"
    return f"{hash_comments(comments)}{header}{rows}"
