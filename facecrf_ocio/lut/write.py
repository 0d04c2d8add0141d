"""One curve to one LUT file, in the format its ending names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from facecrf_ocio.checks import typed
from facecrf_ocio.color.working_space import WORKING_SPACES
from facecrf_ocio.errors import LutError
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.lut.encoding import Encoding
from facecrf_ocio.lut.format_table import FORMATS, LutFormat, format_of, require_format
from facecrf_ocio.lut.read_back import require_transform
from facecrf_ocio.lut.transform import LutTransform
from facecrf_ocio.values import InverseCRF, Primaries


@typed
def write_lut(
    curve: InverseCRF,
    path: str | Path,
    *,
    overwrite: bool = False,
    provenance: Mapping[str, str] | None = None,
    direction: str = "linearize",
    space: str = "",
    primaries: Primaries | None = None,
) -> Path:
    """Write a curve as a LUT, read it back through OpenColorIO and compare.

    A linearizing LUT has 4096 entries. An encoding one is the exact inverse in `.ctf`, has an entry
    for each half float in `.clf`, and 65536 uniform ones, coarse in the shadows, elsewhere.

    Parameters
    ----------
    curve
        Encoded to linear, R, G, B.
    path
        The file; its ending, the longest in `format_table` that fits, chooses the format.
    overwrite
        Whether an existing file may be replaced.
    provenance
        Remarks for the file's comments, such as where the curve comes from.
    direction
        `linearize` or `encode`, its inverse.
    space
        Working space that linear light shall be in, one of `WORKING_SPACES`; .clf and .ctf only.
    primaries
        The photo's, for `space` and for ICC profiles; None stands for Rec.709.

    Returns
    -------
    pathlib.Path
        The file written.

    Raises
    ------
    OutputError
        If the file exists and `overwrite` is false, or it cannot be written.
    LutError
        If the ending is unknown, the format cannot hold what is asked for, or the file does not
        read back as written. Nothing is left behind.
    SettingsError
        If the direction or the working space is unknown.
    """
    transform = LutTransform(curve, direction, space, primaries)
    path = Path(path)
    draft = lut_draft(transform, path, provenance or {}, format_of(path).ending)
    return write_files([draft], overwrite=overwrite)[0]


def lut_draft(
    transform: LutTransform, path: Path, provenance: Mapping[str, str], name: str
) -> Draft:
    """Return the LUT file of a format to be written, which checks itself through OpenColorIO."""
    row = require_format(name, path)
    _require_able(row, transform.direction, transform.space, f"{path}: ")
    content = row.write(transform, [f"{key}: {value}" for key, value in provenance.items()])
    content = content.encode("utf-8") if isinstance(content, str) else content
    return Draft(
        path, content, lambda written: require_transform(written, transform, row, name=path)
    )


def split_ending(ending: str) -> tuple[str, str, str]:
    """Split what follows a photo's name, such as `acescg.encode.clf`.

    Returns
    -------
    tuple of str
        Working space (or empty), direction, format.

    Raises
    ------
    LutError
        If a part is unknown, or the format cannot hold what is asked for.
    """
    *steps, name = ending.split(".")
    if steps and f"{steps[-1]}.{name}" in FORMATS:
        name = f"{steps.pop()}.{name}"
    row = require_format(name)
    space = steps.pop(0) if steps and steps[0] in WORKING_SPACES else ""
    direction = steps.pop(0) if steps and steps[0] == "encode" else "linearize"
    if steps:
        raise LutError(
            f"unknown LUT {ending!r}; write [SPACE.][encode.]FORMAT, SPACE being one of "
            f"{', '.join(WORKING_SPACES)}"
        )
    _require_able(row, direction, space, "")
    return space, direction, name


def endings(formats: Sequence[str], direction: str, space: str) -> tuple[str, ...]:
    """Return the endings of all files for a `direction`, which may also be `both`.

    Of `both`, an ICC input profile has the one direction there is.
    """
    start = f"{space}." if space else ""
    both = direction == "both"
    wanted = []
    for name in formats:
        if both or direction == "linearize":
            wanted.append(f"{start}{name}")
        if direction == "encode" or (both and _encodes(require_format(name))):
            wanted.append(f"{start}encode.{name}")
    for ending in wanted:
        split_ending(ending)
    return tuple(wanted)


def _encodes(row: LutFormat) -> bool:
    return row.encoding is not Encoding.NONE


def _require_able(row: LutFormat, direction: str, space: str, where: str) -> None:
    if space and not row.matrix:
        able = " or ".join(name for name, other in FORMATS.items() if other.matrix)
        raise LutError(f"{where}.{row.ending} cannot hold the matrix to {space}; use {able}")
    if direction == "encode" and not _encodes(row):
        raise LutError(
            f"{where}an ICC input profile goes from code values to color only; use another format "
            "to encode"
        )
