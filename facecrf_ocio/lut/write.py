"""One curve to one LUT file, in the format its ending names."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from facecrf_ocio.color.working_space import WORKING_SPACES
from facecrf_ocio.errors import LutError
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.lut.formats.clf import clf_text, ctf_text
from facecrf_ocio.lut.formats.csp import csp_text
from facecrf_ocio.lut.formats.cube import cube_text
from facecrf_ocio.lut.formats.icc import icc_bytes
from facecrf_ocio.lut.formats.icc_v4 import icc_v4_bytes
from facecrf_ocio.lut.formats.iridas_cube import iridas_cube_text
from facecrf_ocio.lut.formats.spi1d import spi1d_text
from facecrf_ocio.lut.read_back import verify_recipe
from facecrf_ocio.lut.transform import Recipe
from facecrf_ocio.values import InverseCRF, Primaries

Writer = Callable[[Recipe, Sequence[str]], str | bytes]
# By the ending of their files' names; the last part is the suffix that readers go by.
FORMATS: Mapping[str, Writer] = {
    "spi1d": spi1d_text,
    "cube": cube_text,
    "clf": clf_text,
    "ctf": ctf_text,
    "csp": csp_text,
    "icc": icc_bytes,
    "iridas.cube": iridas_cube_text,
    "v4.icc": icc_v4_bytes,
}
_WITH_MATRIX = ("clf", "ctf")
_ONE_WAY = ("icc", "v4.icc")


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
        The file; its ending, the longest of `FORMATS` that fits, chooses the format.
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
    recipe = Recipe(curve, direction, space, primaries)
    path = Path(path)
    draft = lut_draft(recipe, path, provenance or {}, _format_of(path))
    return write_files([draft], overwrite=overwrite)[0]


def lut_draft(recipe: Recipe, path: Path, provenance: Mapping[str, str], name: str) -> Draft:
    """Return the LUT file of a format to be written, which checks itself through OpenColorIO."""
    write = require_format(name, path)
    _require_able(name, recipe.direction, recipe.space, f"{path}: ")
    content = write(recipe, [f"{key}: {value}" for key, value in provenance.items()])
    content = content.encode("utf-8") if isinstance(content, str) else content
    return Draft(path, content, lambda written: verify_recipe(written, recipe, name=path))


def require_format(name: str, path: Path | None = None) -> Writer:
    """Return the writer of a format, or raise LutError with the formats there are."""
    if name not in FORMATS:
        where = "" if path is None else f"{path}: "
        raise LutError(f"{where}unknown LUT format {name!r}; use one of {', '.join(FORMATS)}")
    return FORMATS[name]


def _format_of(path: Path) -> str:
    parts = [suffix.removeprefix(".") for suffix in Path(path.name.lower()).suffixes[-2:]]
    longest = ".".join(parts)
    return longest if longest in FORMATS else longest.rpartition(".")[2]


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
    require_format(name)
    space = steps.pop(0) if steps and steps[0] in WORKING_SPACES else ""
    direction = steps.pop(0) if steps and steps[0] == "encode" else "linearize"
    if steps:
        raise LutError(
            f"unknown LUT {ending!r}; write [SPACE.][encode.]FORMAT, SPACE being one of "
            f"{', '.join(WORKING_SPACES)}"
        )
    _require_able(name, direction, space, "")
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
        if direction == "encode" or (both and name not in _ONE_WAY):
            wanted.append(f"{start}encode.{name}")
    for ending in wanted:
        split_ending(ending)
    return tuple(wanted)


def _require_able(name: str, direction: str, space: str, where: str) -> None:
    if space and name not in _WITH_MATRIX:
        raise LutError(
            f"{where}.{name} cannot hold the matrix to {space}; use {' or '.join(_WITH_MATRIX)}"
        )
    if name in _ONE_WAY and direction == "encode":
        raise LutError(
            f"{where}an ICC input profile goes from code values to color only; use another format "
            "to encode"
        )
