"""Rising Sun Research cineSpace LUT (.csp), one-dimensional."""

from __future__ import annotations

from collections.abc import Sequence

from facecrf_ocio.lut.comments import hash_comments
from facecrf_ocio.lut.transform import LutTransform, uniform_rows


def csp_text(transform: LutTransform, comments: Sequence[str] = ()) -> str:
    """Return the file's text, with an identity for the format's shaper."""
    length, rows = uniform_rows(transform)
    shaper = "2\n0 1\n0 1\n" * 3
    return (
        f"CSPLUTV100\n1D\n\nBEGIN METADATA\n{hash_comments(comments)}END METADATA\n\n"
        f"{shaper}\n{length}\n{rows}"
    )
