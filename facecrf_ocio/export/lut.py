"""One curve to one LUT file, in the format its suffix names."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from facecrf_ocio.errors import LutError
from facecrf_ocio.export.atomic import Draft, write_files
from facecrf_ocio.export.clf import clf_text
from facecrf_ocio.export.cube import cube_text
from facecrf_ocio.export.spi1d import spi1d_text
from facecrf_ocio.export.verify import verify_lut
from facecrf_ocio.values import InverseCRF

FORMATS: Mapping[str, Callable[[InverseCRF, Sequence[str]], str]] = {
    "spi1d": spi1d_text,
    "cube": cube_text,
    "clf": clf_text,
}


def write_lut(
    curve: InverseCRF,
    path: Path,
    *,
    overwrite: bool = False,
    provenance: Mapping[str, str] | None = None,
) -> Path:
    """Write a curve as a LUT of 4096 entries, read it back through OpenColorIO and compare.

    Parameters
    ----------
    curve
        Encoded to linear, R, G, B.
    path
        The file; its suffix, .spi1d, .cube or .clf, chooses the format.
    overwrite
        Whether an existing file may be replaced.
    provenance
        Remarks for the file's comments, such as where the curve comes from.

    Returns
    -------
    pathlib.Path
        The file written.

    Raises
    ------
    OutputError
        If the file exists and `overwrite` is false, or it cannot be written.
    LutError
        If the suffix is unknown or the file does not read back as written. Nothing is left behind.
    """
    return write_files([lut_draft(curve, Path(path), provenance or {})], overwrite=overwrite)[0]


def lut_draft(curve: InverseCRF, path: Path, provenance: Mapping[str, str]) -> Draft:
    """Return the LUT file to be written, which checks itself through OpenColorIO."""
    write_text = require_format(path.suffix.lower().removeprefix("."), path)
    comments = [f"{key}: {value}" for key, value in provenance.items()]
    content = write_text(curve, comments).encode("utf-8")
    return Draft(path, content, lambda written: verify_lut(written, curve, name=path))


def require_format(
    name: str, path: Path | None = None
) -> Callable[[InverseCRF, Sequence[str]], str]:
    """Return the writer of a format, or raise LutError with the formats there are."""
    if name not in FORMATS:
        where = "" if path is None else f"{path}: "
        raise LutError(f"{where}unknown LUT format {name!r}; use one of {', '.join(FORMATS)}")
    return FORMATS[name]
