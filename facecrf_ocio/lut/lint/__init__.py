"""What is wrong with a LUT file that OpenColorIO may accept without a word."""

from __future__ import annotations

from pathlib import Path

from facecrf_ocio.errors import LutError
from facecrf_ocio.lut.format_table import FORMATS, of_suffix
from facecrf_ocio.lut.lint.curve_checks import check
from facecrf_ocio.lut.lint.finding import ERROR, WARNING, Finding

__all__ = ["ERROR", "WARNING", "Finding", "lint"]


def lint(path: Path) -> tuple[Finding, ...]:
    """Check a LUT file of any format in `format_table`.

    Raises
    ------
    LutError
        If the file cannot be read or its suffix is none of these.
    """
    path = Path(path)
    row = of_suffix(path.suffix)
    if row is None:
        suffixes = dict.fromkeys(s for row in FORMATS.values() for s in row.suffixes)
        raise LutError(f"{path}: lint knows {', '.join(suffixes)} only")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise LutError(f"{path}: cannot be read: {(error.strerror or '').lower()}") from error
    return tuple(finding for table in row.tables(path, content) for finding in check(path, table))
