"""What is wrong with a LUT file that OpenColorIO may accept without a word."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.errors import LutError, reason_of
from facecrf_ocio.lut.format_table import FORMATS, of_suffix
from facecrf_ocio.lut.lint.curve_checks import check
from facecrf_ocio.lut.lint.finding import ERROR, WARNING, Finding, count
from facecrf_ocio.lut.lint.mesh_depth import mesh_depth
from facecrf_ocio.lut.numbers import is_of_numbers
from facecrf_ocio.lut.ocio_processor import exact_cpu, ocio_processor
from facecrf_ocio.lut.usable import ask

__all__ = ["ERROR", "WARNING", "Finding", "error_notes", "errors_in", "lint", "luts_below"]

_MOST_WARNINGS = 3  # of OpenColorIO for one file; the others mostly repeat them
_LARGEST = 1 << 26
"""[byte] Of a file that is looked into; a 3-D LUT of 129 entries a side as text has 60e6."""


def lint(path: Path) -> tuple[Finding, ...]:
    """Check a LUT file of any format that this package or OpenColorIO knows.

    Tables are read from the file itself; formulas and 3-D LUTs are sampled through OpenColorIO,
    which is asked first whether it can use the file at all.

    Returns
    -------
    tuple of Finding
        None if the file is clean. The last tells if OpenColorIO refuses it.

    Raises
    ------
    LutError
        If the file cannot be read or is of no known format.
    """
    path = Path(path)
    row = of_suffix(path.suffix)
    content = _content(path)
    tables = None if row is None else row.tables(path, content)
    found = [finding for table in tables or () for finding in check(path, table)]
    refused, warned = ask(path)
    found += [_warning(path, text) for text in warned[:_MOST_WARNINGS]]
    if refused:
        problem = f"it cannot be used: {refused}"
        remedy = "export it again, in another format if need be"
        found.append(Finding(path, None, ERROR, problem, remedy, unusable=True))
        return tuple(found)
    if not tables:
        found += _sampled(path) + mesh_depth(path, content)
    if not any(one.severity == ERROR for one in found) and not is_of_numbers(ocio_processor(path)):
        problem = "it holds NaN or infinity as OpenColorIO reads it"
        found.append(Finding(path, None, ERROR, problem, "export it again"))
    return tuple(found)


def errors_in(path: Path) -> tuple[Finding, ...]:
    """Errors of a LUT without its warnings; none where the linter does not know its kind."""
    try:
        return tuple(finding for finding in lint(path) if finding.severity == ERROR)
    except LutError:
        return ()


def error_notes(path: Path) -> tuple[str, ...]:
    """What is wrong with a LUT that OpenColorIO runs all the same, the first of it, in a clause."""
    errors = errors_in(path)
    more = f" (and {len(errors) - 1} more by facecrf lint)" if len(errors) > 1 else ""
    return tuple(f"{path.name}: {one.problem}{more}; {one.remedy}" for one in errors[:1])


def luts_below(folder: Path) -> tuple[Path, ...]:
    """Return the files in and below a folder that are LUTs by their suffix, in order of name."""
    suffixes = _suffixes()
    found = (path for path in Path(folder).rglob("*") if path.suffix.lower() in suffixes)
    return tuple(sorted(path for path in found if path.is_file()))


def _suffixes() -> tuple[str, ...]:
    """Those that this package writes, and the others that OpenColorIO reads."""
    known = dict.fromkeys(s for row in FORMATS.values() for s in row.suffixes)
    known |= dict.fromkeys(f".{suffix}" for _, suffix in ocio.FileTransform.getFormats())
    return tuple(known)


def _warning(path: Path, text: str) -> Finding:
    """What OpenColorIO warns of, `(LINE): TEXT`, such as an element it does not know."""
    line, _, problem = text.lstrip("(").partition("): ")
    number = count(line)
    problem = (problem if number else text).rstrip(". ")
    return Finding(path, number, WARNING, f"OpenColorIO warns: {problem}", "check that line")


def _content(path: Path) -> bytes:
    known = _suffixes()
    if path.suffix.lower() not in known:
        raise LutError(f"{path}: lint knows {', '.join(known)} only")
    try:
        if path.exists() and not path.is_file():
            raise LutError(f"{path}: is no file; name a LUT")
        if path.stat().st_size > _LARGEST:
            raise LutError(f"{path}: has more than 64 MB, which no LUT needs; export it again")
        return path.read_bytes()
    except OSError as error:
        raise LutError(f"{path}: cannot be read: {reason_of(error)}") from error


def _sampled(path: Path) -> list[Finding]:
    """What a transform without a table makes of grays, which must be numbers."""
    gray = np.repeat(np.linspace(0.0, 1.0, 257, dtype=np.float32)[:, None], 3, axis=1)
    light = gray.copy()
    exact_cpu(ocio_processor(path)).applyRGB(light)
    bad = np.flatnonzero(~np.isfinite(light).all(axis=1))
    if not bad.size:
        return []
    problem = f"it makes NaN or infinity of {gray[bad[0], 0]:.3g}"
    return [Finding(path, None, ERROR, problem, "check its formulas")]
