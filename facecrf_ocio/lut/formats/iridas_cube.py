"""One-dimensional .cube LUT in the style of IRIDAS and Adobe (Cube LUT Specification 1.0).

It differs from Resolve's in its header: TITLE and a domain for each channel, where Resolve has
LUT_1D_INPUT_RANGE. A reader that knows one refuses the other.
"""

from __future__ import annotations

from collections.abc import Sequence

from facecrf_ocio.lut.comments import hash_comments
from facecrf_ocio.lut.transform import LutTransform, uniform_rows

_LONGEST_LINE = 250  # the specification's, in bytes, with the line's end


def iridas_cube_text(transform: LutTransform, comments: Sequence[str] = ()) -> str:
    """Return the file's text; the specification cuts comments short."""
    length, rows = uniform_rows(transform)
    notes = "".join(
        f"{line[: _LONGEST_LINE - 1]}\n" for line in hash_comments(comments).splitlines()
    )
    title = "Camera response" if transform.encodes else "Inverse camera response"
    header = f'TITLE "{title}"\nDOMAIN_MIN 0 0 0\nDOMAIN_MAX 1 1 1\nLUT_1D_SIZE {length}\n'
    return f"{notes}{header}{rows}"
