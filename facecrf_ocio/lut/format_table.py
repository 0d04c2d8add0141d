"""The LUT formats there are, one row each: a format is a file in `formats/` and a row here.

Everything that names formats goes by this table: writing, the names of outputs, what the commands
offer and explain, the linter, the finder of LUTs for configs. It imports nothing heavy.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, cast

from facecrf_ocio.errors import LutError
from facecrf_ocio.lut.encoding import Encoding

if TYPE_CHECKING:
    from facecrf_ocio.lut.lint.finding import Table
    from facecrf_ocio.lut.transform import LutTransform

    Writer = Callable[[LutTransform, Sequence[str]], str | bytes]
    Reader = Callable[[Path, bytes], list[Table]]

_ROOM = "facecrf_ocio.lut."


@dataclass(frozen=True, slots=True)
class LutFormat:
    """One format.

    Attributes
    ----------
    ending
        What follows a photo's name; the last part is the suffix that readers go by.
    writer
        `module:function`, of a `LutTransform` and comments, that returns the file's text or bytes.
    reader
        `module:function`, of a path and its bytes, that returns the tables the linter looks at.
    encoding
        How it encodes.
    matrix
        Whether a matrix may follow the curve.
    profile
        Whether OpenColorIO runs it from the connection space to the device, and so inverted.
    default
        Whether it is written unless formats are named.
    in_configs
        Whether a config may refer to it; of several for one photo, the first row's counts.
    spaced
        Whether it is numbers between spaces, which OpenColorIO reads up to a decimal comma.
    also
        Other suffixes of files of this format.
    """

    ending: str
    writer: str
    reader: str
    encoding: Encoding = Encoding.UNIFORM
    matrix: bool = False
    profile: bool = False
    default: bool = False
    in_configs: bool = True
    spaced: bool = False
    also: tuple[str, ...] = ()

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of its files, with their dots: its own, then the others."""
        return tuple(f".{name}" for name in (self.ending.rpartition(".")[2], *self.also))

    @property
    def write(self) -> Writer:
        """Returns a file's content."""
        return cast("Writer", _load(self.writer))

    @property
    def tables(self) -> Reader:
        """Returns the tables in a file."""
        return cast("Reader", _load(self.reader))


_KEYED = _ROOM + "lint.text_tables:keyed_tables"
_XML = _ROOM + "lint.process_list_tables:process_list_tables"
_ICC = _ROOM + "lint.profile_tables:icc_tables"

FORMATS: dict[str, LutFormat] = {}
"""By ending, in the order in which they are told."""


def register(row: LutFormat) -> LutFormat:
    """Add a format to the table, or put it in the place of the one with its ending."""
    FORMATS[row.ending] = row
    return row


for _row in (
    LutFormat("spi1d", _ROOM + "formats.spi1d:spi1d_text", _KEYED, default=True, spaced=True),
    LutFormat("cube", _ROOM + "formats.cube:cube_text", _KEYED, default=True, spaced=True),
    LutFormat(
        "clf",
        _ROOM + "formats.clf:clf_text",
        _XML,
        encoding=Encoding.HALF_DOMAIN,
        matrix=True,
        default=True,
    ),
    LutFormat("ctf", _ROOM + "formats.clf:ctf_text", _XML, encoding=Encoding.EXACT, matrix=True),
    LutFormat(
        "csp", _ROOM + "formats.csp:csp_text", _ROOM + "lint.text_tables:csp_tables", spaced=True
    ),
    LutFormat(
        "icc",
        _ROOM + "formats.icc:icc_bytes",
        _ICC,
        encoding=Encoding.NONE,
        profile=True,
        in_configs=False,
        also=("icm",),
    ),
    LutFormat("iridas.cube", _ROOM + "formats.iridas_cube:iridas_cube_text", _KEYED, spaced=True),
    LutFormat(
        "v4.icc",
        _ROOM + "formats.icc_v4:icc_v4_bytes",
        _ICC,
        encoding=Encoding.NONE,
        profile=True,
        in_configs=False,
    ),
):
    register(_row)


def format_names() -> tuple[str, ...]:
    """Endings of all formats."""
    return tuple(FORMATS)


def default_formats() -> tuple[str, ...]:
    """Endings of those that are written unless others are named."""
    return tuple(name for name, row in FORMATS.items() if row.default)


def config_suffixes() -> tuple[str, ...]:
    """Suffixes of LUTs that a config may refer to, the preferred ones first."""
    rows = (row for row in FORMATS.values() if row.in_configs)
    return tuple(dict.fromkeys(suffix for row in rows for suffix in row.suffixes))


def of_suffix(suffix: str) -> LutFormat | None:
    """Return the first format whose files have a suffix, such as `.icm`; None if there is none."""
    found = (row for row in FORMATS.values() if suffix.lower() in row.suffixes)
    return next(found, None)


def require_format(name: str, path: Path | None = None) -> LutFormat:
    """Return a format's row, or raise LutError with the formats there are."""
    if name not in FORMATS:
        where = "" if path is None else f"{path}: "
        raise LutError(f"{where}unknown LUT format {name!r}; use one of {', '.join(FORMATS)}")
    return FORMATS[name]


def format_of(path: Path) -> LutFormat:
    """Return the format that a file's name ends with, the longest ending first, or raise."""
    parts = [suffix.removeprefix(".") for suffix in Path(path.name.lower()).suffixes[-2:]]
    longest = ".".join(parts)
    return require_format(longest if longest in FORMATS else longest.rpartition(".")[2], path)


def _load(name: str) -> object:
    module, _, function = name.partition(":")
    return getattr(import_module(module), function)
