"""Whether the outputs of an archive are still what was written; nothing is changed."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.archive.manifest.read_only import reading
from facecrf_ocio.archive.walk import name_of
from facecrf_ocio.errors import OutputError
from facecrf_ocio.files.content import sha256_of

REPORT = "facecrf-report.html"
MISSING, ALTERED, EXTRA, UNREADABLE = "missing", "altered", "extra", "unreadable"


@dataclass(frozen=True, slots=True)
class Fault:
    """A file that is not as the manifest says: `missing`, `altered`, `unreadable` or `extra`."""

    name: str
    kind: str


def verify(folder: Path) -> Iterator[Fault]:
    """Compare all files below a folder with its manifest.

    Raises
    ------
    OutputError
        If there is no manifest, or it cannot be read.
    """
    with reading(folder) as base:
        for output in base.execute("SELECT name, size, sha256 FROM outputs ORDER BY name"):
            kind = _fault(folder, *output)
            if kind:
                yield Fault(output[0], kind)
        yield from _extras(folder, base)


def _fault(folder: Path, name: str, size: int, sha256: str) -> str:
    path = folder / name
    if not path.is_file():
        return MISSING
    if path.stat().st_size != size:
        return ALTERED
    try:
        return "" if sha256_of(path) == sha256 else ALTERED
    except OutputError:
        return UNREADABLE


def _extras(folder: Path, base: sqlite3.Connection) -> Iterator[Fault]:
    listed = "SELECT 1 FROM outputs WHERE name = ?"
    for place, _, names in os.walk(folder):
        for file in sorted(names):
            name = name_of(Path(place, file), folder)
            ours = name.startswith("facecrf-manifest.") or name == REPORT
            if not ours and base.execute(listed, (name,)).fetchone() is None:
                yield Fault(name, EXTRA)
