"""The manifest of an archive: what is known of every photo, in SQLite, safe against any end.

`DST/facecrf-manifest.sqlite`, in WAL mode, every transaction flushed to the disk. Tables:

`photos`, one row a photo
    `name` (key: path relative to the source, slashes; bytes that are not UTF-8 escaped), `size`
    [bytes], `mtime_ns`, `sha256` (of the photo, empty if unreadable), `recipe` (hash of settings,
    version and formats), `state` (`started`: perhaps half written; `done`), `outcome` (`values.
    Outcome`, or `failed`), `verdict` (`values.Verdict` or empty), `estimator`, `reason`, `remedy`,
    `make`, `model`, `serial`, `software` (as the file says), `read_s`, `estimate_s`, `write_s`.
`outputs`, one row a written file
    `name` (key: path relative to DST), `photo` (-> photos.name), `size` [bytes], `sha256`.
`about`
    `key`, `value`: `schema` (the number 1) and `source` (folder of the photos).

All columns but the three durations are the same for an unbroken run and for one that was resumed
(`mtime_ns` is the source's).
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.archive.task import Output, Result
from facecrf_ocio.errors import OutputError

FILE = "facecrf-manifest.sqlite"
SCHEMA = "1"
STARTED, DONE = "started", "done"
_TABLES = """
CREATE TABLE IF NOT EXISTS about (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS photos (
    name TEXT PRIMARY KEY, size INTEGER NOT NULL, mtime_ns INTEGER NOT NULL,
    sha256 TEXT NOT NULL DEFAULT '', recipe TEXT NOT NULL, state TEXT NOT NULL,
    outcome TEXT NOT NULL DEFAULT '', verdict TEXT NOT NULL DEFAULT '',
    estimator TEXT NOT NULL DEFAULT '', reason TEXT NOT NULL DEFAULT '',
    remedy TEXT NOT NULL DEFAULT '', make TEXT NOT NULL DEFAULT '',
    model TEXT NOT NULL DEFAULT '', serial TEXT NOT NULL DEFAULT '',
    software TEXT NOT NULL DEFAULT '', read_s REAL NOT NULL DEFAULT 0,
    estimate_s REAL NOT NULL DEFAULT 0, write_s REAL NOT NULL DEFAULT 0
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS outputs (
    name TEXT PRIMARY KEY, photo TEXT NOT NULL REFERENCES photos(name),
    size INTEGER NOT NULL, sha256 TEXT NOT NULL
) WITHOUT ROWID;
CREATE INDEX IF NOT EXISTS outputs_of ON outputs (photo);
"""


@dataclass(frozen=True, slots=True)
class Stamp:
    """By what a photo is known to be unchanged without reading it, and how it was treated."""

    size: int
    mtime_ns: int
    recipe: str


@dataclass(frozen=True, slots=True)
class Known:
    """What the manifest says of a photo."""

    stamp: Stamp
    state: str
    outcome: str
    verdict: str


class Manifest:
    """The open manifest; one process at a time writes to it."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / FILE
        with self._telling():
            self._base = sqlite3.connect(self.path, isolation_level=None, timeout=30)
            self._base.execute("PRAGMA journal_mode=WAL")
            self._base.execute("PRAGMA synchronous=FULL")
            self._base.executescript(_TABLES)
            self._base.execute("INSERT OR IGNORE INTO about VALUES ('schema', ?)", (SCHEMA,))
        if self.about("schema") != SCHEMA:
            raise OutputError(f"{self.path}: is of another version; write to another folder")

    def close(self) -> None:
        """Close it; what was recorded stays."""
        self._base.close()

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Record all that happens within, or nothing; on the disk when it ends."""
        with self._telling():
            self._base.execute("BEGIN IMMEDIATE")
            try:
                yield
            except BaseException:
                self._base.execute("ROLLBACK")
                raise
            self._base.execute("COMMIT")

    def about(self, key: str) -> str | None:
        """Return a fact about the archive."""
        row = self._base.execute("SELECT value FROM about WHERE key = ?", (key,)).fetchone()
        return None if row is None else str(row[0])

    def note(self, key: str, value: str) -> None:
        """Record a fact about the archive."""
        self._base.execute("INSERT OR REPLACE INTO about VALUES (?, ?)", (key, value))

    def known(self, name: str) -> Known | None:
        """Return what is known of a photo."""
        row = self._base.execute(
            "SELECT size, mtime_ns, recipe, state, outcome, verdict FROM photos WHERE name = ?",
            (name,),
        ).fetchone()
        return None if row is None else Known(Stamp(*row[:3]), *row[3:])

    def start(self, name: str, stamp: Stamp) -> None:
        """Record that from now on the photo's outputs may be half there."""
        self._base.execute(
            "INSERT INTO photos (name, size, mtime_ns, recipe, state) VALUES (?, ?, ?, ?, ?) "
            "ON CONFLICT (name) DO UPDATE SET state = excluded.state",
            (name, stamp.size, stamp.mtime_ns, stamp.recipe, STARTED),
        )

    def finish(self, name: str, stamp: Stamp, result: Result) -> None:
        """Record what came of a photo."""
        self._base.execute(
            f"INSERT OR REPLACE INTO photos VALUES ({', '.join('?' * 18)})",  # noqa: S608
            (
                *(name, stamp.size, stamp.mtime_ns, result.sha256, stamp.recipe, DONE),
                *(result.outcome, result.verdict, result.estimator, result.reason, result.remedy),
                *result.camera,
                *(result.timing.read, result.timing.estimate, result.timing.write),
            ),
        )
        self._base.execute("DELETE FROM outputs WHERE photo = ?", (name,))
        self._base.executemany(
            "INSERT OR REPLACE INTO outputs VALUES (?, ?, ?, ?)",
            [(item.name, name, item.size, item.sha256) for item in result.outputs],
        )

    def forget(self, name: str) -> None:
        """Take back `start` of a photo that was never done."""
        self._base.execute("DELETE FROM photos WHERE name = ? AND outcome = ''", (name,))

    def started(self) -> tuple[str, ...]:
        """Return the photos whose outputs may be half there."""
        rows = self._base.execute("SELECT name FROM photos WHERE state = ?", (STARTED,))
        return tuple(row[0] for row in rows)

    def outputs(self, photo: str | None = None) -> Iterable[Output]:
        """Return the outputs of a photo, or stream those of all in the order of their names."""
        if photo is None:
            rows = self._base.execute("SELECT name, size, sha256 FROM outputs ORDER BY name")
            return (Output(*row) for row in rows)
        found = self._base.execute(
            "SELECT name, size, sha256 FROM outputs WHERE photo = ?", (photo,)
        )
        return [Output(*row) for row in found]

    def has_output(self, name: str) -> bool:
        """Whether a file is an output of the archive."""
        found = self._base.execute("SELECT 1 FROM outputs WHERE name = ?", (name,)).fetchone()
        return found is not None

    def counts(self) -> Mapping[tuple[str, str], int]:
        """Return the number of finished photos of each (outcome, verdict)."""
        rows = self._base.execute(
            "SELECT outcome, verdict, COUNT(*) FROM photos WHERE state = ? GROUP BY 1, 2", (DONE,)
        )
        return {(outcome, verdict): count for outcome, verdict, count in rows}

    def __len__(self) -> int:
        return int(self._base.execute("SELECT COUNT(*) FROM photos").fetchone()[0])

    @contextmanager
    def _telling(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise OutputError(
                f"{self.path}: the manifest cannot be used: {error}; free some space, or choose "
                "another folder"
            ) from error
