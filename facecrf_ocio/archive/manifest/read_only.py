"""Opening a manifest to read it alone, so that it may lie on a medium that cannot be written.

Elsewhere SQLite leaves two empty files of its journal beside it, which the next batch takes away.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.archive.manifest.damage import telling, understanding
from facecrf_ocio.archive.manifest.database import CLAIMED
from facecrf_ocio.archive.manifest.keys import key_of, name_of_key
from facecrf_ocio.archive.manifest.schema import VERSION, fact, version_in
from facecrf_ocio.archive.task import Output
from facecrf_ocio.errors import OutputError


@dataclass(frozen=True, slots=True)
class Fields:
    """Columns of a row by name, empty where a manifest of an older version has none."""

    record: Mapping[str, Any] | sqlite3.Row

    def text(self, name: str) -> str:
        """A text."""
        return str(self._get(name, ""))

    def name(self, column: str) -> str:
        """A name of a file, which stands there as its key; empty if the key is."""
        key = self.text(column)
        return name_of_key(key) if key else ""

    def number(self, name: str) -> float:
        """A number."""
        return float(self._get(name, 0.0))

    def whole(self, name: str) -> int:
        """A whole number."""
        return int(self._get(name, 0))

    def _get(self, name: str, default: Any) -> Any:
        value = self.record[name] if name in self.record.keys() else None  # noqa: SIM118
        return default if value is None else value


class Reader:
    """A manifest of any version up to this one, as it is at one moment."""

    def __init__(self, base: sqlite3.Connection, path: Path) -> None:
        self._base, self.path = base, path
        base.row_factory = sqlite3.Row

    def about(self, key: str) -> str | None:
        """Return a fact about the archive."""
        return fact(self._base, key)

    def photos(self) -> Iterator[Fields]:
        """The rows of all photos, in the order of names."""
        return self._all("photos", "name")

    def cameras(self) -> Iterator[Fields]:
        """The rows of all cameras, in the order of keys."""
        return self._all("cameras", "key")

    def brackets(self) -> Iterator[Fields]:
        """The rows of all brackets, in the order of names."""
        return self._all("brackets", "name")

    def merges(self) -> Iterator[Fields]:
        """The rows of all merges, in the order of names."""
        return self._all("merges", "name")

    def outputs(self) -> Iterator[tuple[str, Output]]:
        """Written outputs with the photos they were made of, in the order of names."""
        for fields in self._all("outputs", "name"):
            output = Output(fields.name("name"), fields.whole("size"), fields.text("sha256"))
            if output.size != CLAIMED:
                yield fields.name("photo"), output

    def output_counts(self) -> dict[str, int]:
        """Number of written outputs by the keys of their photos."""
        query = "SELECT photo, COUNT(*) FROM outputs WHERE size != ? GROUP BY photo"
        return {str(key): int(count) for key, count in self._base.execute(query, (CLAIMED,))}

    def recipe_sha256_of(self, photo: str) -> str:
        """Hash of how a photo was treated, empty if it is not known."""
        query = "SELECT recipe FROM photos WHERE name = ?"
        row = self._base.execute(query, (key_of(photo),)).fetchone()
        return "" if row is None else str(row[0])

    def has_output(self, name: str) -> bool:
        """Whether a file is an output of the archive, or about to be one."""
        listed = "SELECT 1 FROM outputs WHERE name = ?"
        return self._base.execute(listed, (key_of(name),)).fetchone() is not None

    def thumbnail(self, photo: str) -> tuple[object, object, object] | None:
        """What is kept of a photo's thumbnail: hash, before, after; None if nothing is."""
        if not self._has("thumbnails"):
            return None
        query = "SELECT sha256, before, after FROM thumbnails WHERE photo = ?"
        row = self._base.execute(query, (key_of(photo),)).fetchone()
        return None if row is None else (row[0], row[1], row[2])

    def summary(self, photo: str) -> tuple[object, object] | None:
        """What is kept of what a photo's record tells: hash, text; None if nothing is."""
        if not self._has("summaries"):
            return None
        query = "SELECT sha256, text FROM summaries WHERE photo = ?"
        row = self._base.execute(query, (key_of(photo),)).fetchone()
        return None if row is None else (row[0], row[1])

    def output(self, name: str) -> Output | None:
        """A written output, as it was written; None if there is none of the name."""
        query = "SELECT * FROM outputs WHERE name = ? AND size != ?"
        row = self._base.execute(query, (key_of(name), CLAIMED)).fetchone()
        if row is None:
            return None
        fields = Fields(row)
        return Output(name, fields.whole("size"), fields.text("sha256"), fields.whole("written_ns"))

    def _has(self, table: str) -> bool:
        there = self._base.execute("SELECT 1 FROM sqlite_master WHERE name = ?", (table,))
        return there.fetchone() is not None

    def _all(self, table: str, key: str) -> Iterator[Fields]:
        """Rows of a table that a manifest of another version may lack."""
        if self._has(table):
            # Both names are ours.
            rows = self._base.execute(f"SELECT * FROM {table} ORDER BY {key}")  # noqa: S608
            yield from map(Fields, rows)


@contextmanager
def reading(folder: Path) -> Iterator[Reader]:
    """Give the manifest of any version, also while a batch writes to it.

    Raises
    ------
    OutputError
        If there is no manifest, or it cannot be read.
    """
    path = folder / FILE
    try:
        there = path.is_file()
    except OSError:
        there = True  # opening it tells what is wrong
    if not there:
        raise OutputError(f"{folder}: has no {FILE}; name the folder a batch was written to")
    with telling(path), understanding(path), closing(_open(path)) as base:
        base.execute("BEGIN")
        if base.execute("SELECT 1 FROM sqlite_master").fetchone() is None:
            raise OutputError(f"{path}: has nothing in it yet; start the batch again, or wait")
        reader = Reader(base, path)
        if version_in(reader.about("schema")) > VERSION:
            raise OutputError(f"{path}: was written by a newer facecrf; update facecrf-ocio")
        yield reader


def _open(path: Path) -> sqlite3.Connection:
    """Open for reading; on a medium that cannot be written, without the journal's files."""
    name = path.absolute().as_uri()
    base = sqlite3.connect(f"{name}?mode=ro", uri=True, isolation_level=None, timeout=5)
    try:
        base.execute("SELECT 1 FROM sqlite_master").fetchone()
    except sqlite3.OperationalError:
        base.close()
        return sqlite3.connect(f"{name}?immutable=1", uri=True, isolation_level=None)
    return base
