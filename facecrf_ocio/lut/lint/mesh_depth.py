"""Bits of a .3dl (Autodesk), which OpenColorIO guesses though the file says them."""

from __future__ import annotations

import re
from pathlib import Path

from facecrf_ocio.lut.lint.finding import ERROR, Finding

_SAID = re.compile(rb"^[ \t]*mesh[ \t]+\d+[ \t]+(\d{1,9})[ \t\r]*$", re.IGNORECASE | re.MULTILINE)
_ENTRY = re.compile(rb"^[ \t]*(\d{1,9})[ \t]+(\d{1,9})[ \t]+(\d{1,9})[ \t\r]*$", re.MULTILINE)
# [bit] It takes the first of them whose largest code, twice over, holds the largest entry.
_DEPTHS = (8, 10, 12, 16)


def mesh_depth(path: Path, content: bytes) -> list[Finding]:
    """Whether OpenColorIO takes entries for more of white than the file means by them."""
    said = _SAID.search(content)
    if said is None:
        return []
    largest = max((int(code) for entry in _ENTRY.findall(content) for code in entry), default=0)
    taken = next((bits for bits in _DEPTHS if largest < 2 << bits), _DEPTHS[-1])
    if int(said[1]) == taken:
        return []
    line = content.count(b"\n", 0, said.start(1)) + 1
    problem = f"OpenColorIO takes its codes for {taken} bits, and they are {int(said[1])}"
    return [Finding(path, line, ERROR, problem, "export it as .cube")]
