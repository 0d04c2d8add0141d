"""All photos of an archive as a table that spreadsheets read."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from facecrf_ocio.archive.manifest.read_only import Fields, reading
from facecrf_ocio.errors import OutputError, in_options
from facecrf_ocio.files.atomic import Draft, require_free, write_files

_TEXTS = (
    *("name", "state", "outcome", "verdict", "estimator", "reason", "remedy"),
    *("make", "model", "serial", "software", "curve", "bracket", "duplicate_of", "sha256"),
)
_NUMBERS = ("misfit", "read_s", "estimate_s", "write_s")
COLUMNS = (*_TEXTS, "size", *_NUMBERS, "outputs")
"""As the manifest names them, and the number of outputs; what is advised in words of commands."""


def require_list(path: Path, *, overwrite: bool) -> None:
    """Raise OutputError unless a list may be written: none is there, or one of ours.

    Known before the first photo is worked on. A batch that goes on replaces its own list.
    """
    if path.suffix.lower() != ".csv":
        raise OutputError(f"{path}: is not named as a table; give it the suffix .csv")
    require_free(path, overwrite=overwrite or _is_ours(path))


def _is_ours(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return file.read(len(_header())) == _header()
    except OSError:
        return False


def _header() -> bytes:
    return (",".join(COLUMNS) + "\r\n").encode()


def write_list(folder: Path, path: Path) -> None:
    """Write one row for every photo of the manifest, in the order of names.

    Raises
    ------
    OutputError
        If the manifest cannot be read, or the list cannot be written.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(COLUMNS)
    with reading(folder) as manifest:
        counts = manifest.output_counts()
        for fields in manifest.photos():
            writer.writerow(_row(fields, counts.get(fields.text("name"), 0)))
    content = text.getvalue().encode("utf-8", "backslashreplace")
    write_files([Draft(path, content, lambda _: None)], overwrite=True)


def _row(fields: Fields, outputs: int) -> list[object]:
    numbers = [round(fields.number(name), 3) for name in _NUMBERS]
    size = max(fields.whole("size"), 0)
    texts = (_text(fields, name) for name in _TEXTS)
    return [*texts, size, *numbers, outputs]


def _text(fields: Fields, name: str) -> str:
    text = fields.text(name)
    return in_options(text) if name == "remedy" else text
