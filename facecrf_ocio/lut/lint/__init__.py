"""What is wrong with a LUT file that OpenColorIO may accept without a word."""

from __future__ import annotations

from pathlib import Path

from facecrf_ocio.errors import LutError
from facecrf_ocio.lut.lint.curve_checks import check
from facecrf_ocio.lut.lint.finding import ERROR, WARNING, Finding
from facecrf_ocio.lut.lint.process_list_tables import process_list_tables
from facecrf_ocio.lut.lint.profile_tables import icc_tables
from facecrf_ocio.lut.lint.text_tables import text_table

__all__ = ["ERROR", "WARNING", "Finding", "lint"]


def lint(path: Path) -> tuple[Finding, ...]:
    """Check a LUT file: .spi1d, .cube (either style), .csp, .clf, .ctf or .icc.

    Raises
    ------
    LutError
        If the file cannot be read or its suffix is none of these.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in (".spi1d", ".cube", ".csp", ".clf", ".ctf", ".icc"):
        raise LutError(f"{path}: lint knows .spi1d, .cube, .csp, .clf, .ctf and .icc only")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise LutError(f"{path}: cannot be read: {(error.strerror or '').lower()}") from error
    if suffix == ".icc":
        tables = icc_tables(path, content)
    elif suffix in (".clf", ".ctf"):
        tables = process_list_tables(path, content)
    else:
        tables = [text_table(path, content.decode("utf-8", "replace"), suffix)]
    return tuple(finding for table in tables for finding in check(path, table))
