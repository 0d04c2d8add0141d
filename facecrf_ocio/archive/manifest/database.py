"""The manifest of an archive: what is known of every photo, in SQLite, safe against any end.

`DST/facecrf-manifest.sqlite`, in WAL mode, every transaction flushed to the disk. `schema.py`
describes its tables.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from facecrf_ocio.archive.manifest.schema import VERSION, bring_up
from facecrf_ocio.archive.walk import as_utf8
from facecrf_ocio.archive.work.task import Gathered, Output, Result
from facecrf_ocio.errors import OutputError

FILE = "facecrf-manifest.sqlite"
UNSEEN = -1
STARTED, GATHERED, WRITING, DONE = "started", "gathered", "writing", "done"


_COLUMNS = (
    "name, size, mtime_ns, sha256, recipe, state, outcome, verdict, estimator, reason, remedy, "
    "make, model, serial, software, read_s, estimate_s, write_s, curve, fingerprint"
)


@dataclass(frozen=True, slots=True)
class Stamp:
    """By what a photo is known to be unchanged without reading it, and how it was treated.

    The size is `UNSEEN` where nothing can be known of it.
    """

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
    sha256: str = ""


class Manifest:
    """The open manifest; one process at a time writes to it."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / FILE
        with self._telling():
            self._base = sqlite3.connect(self.path, isolation_level=None, timeout=30)
            self._base.execute("PRAGMA journal_mode=WAL")
            self._base.execute("PRAGMA synchronous=FULL")
            version = bring_up(self._base)
        if version > VERSION:
            raise OutputError(f"{self.path}: was written by a newer facecrf; update facecrf-ocio")

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

    def rows(self, query: str, *values: object) -> Iterator[tuple[Any, ...]]:
        """Stream the rows of a query on the tables that `schema.py` describes."""
        return iter(self._base.execute(query, values))

    def change(self, statement: str, *values: object) -> None:
        """Change the tables, within a transaction."""
        self._base.execute(statement, values)

    def known(self, name: str) -> Known | None:
        """Return what is known of a photo."""
        row = self._base.execute(
            "SELECT size, mtime_ns, recipe, state, outcome, verdict, sha256 FROM photos "
            "WHERE name = ?",
            (name,),
        ).fetchone()
        return None if row is None else Known(Stamp(*row[:3]), *row[3:])

    def touch(self, name: str, stamp: Stamp) -> None:
        """Record that a photo is the one it was, though its time is not."""
        self.change("UPDATE photos SET mtime_ns = ? WHERE name = ?", stamp.mtime_ns, name)

    def start(self, name: str, stamp: Stamp) -> None:
        """Record that from now on the photo's outputs may be half there."""
        self._base.execute(
            "INSERT INTO photos (name, size, mtime_ns, recipe, state) VALUES (?, ?, ?, ?, ?) "
            "ON CONFLICT (name) DO UPDATE SET state = excluded.state",
            (name, stamp.size, stamp.mtime_ns, stamp.recipe, STARTED),
        )

    def gather(self, name: str, stamp: Stamp, result: Result, fingerprint: str, key: str) -> None:
        """Record what a photo says; its outputs wait for the curve of its camera."""
        shot, gathered = result.shot, result.gathered
        if gathered is None:
            raise ValueError(f"{name} says nothing")
        self._replace(name, stamp, result, fingerprint, GATHERED)
        self.change(
            "UPDATE photos SET camera = ?, taken = ?, exposure_s = ?, aperture = ?, iso = ? "
            "WHERE name = ?",
            *(key, shot.taken, shot.exposure_s, shot.aperture, shot.iso, name),
        )
        self.change(
            "INSERT OR REPLACE INTO evidence VALUES (?, ?, ?, ?)",
            *(name, gathered.evidence, gathered.face, gathered.samples),
        )

    def gathered(self, name: str) -> Gathered:
        """Return what a photo says, which `gather` recorded."""
        (row,) = self.rows("SELECT evidence, face, samples FROM evidence WHERE photo = ?", name)
        return Gathered(*row)

    def written(self, name: str, result: Result) -> None:
        """Record that a photo of which the evidence is known has its outputs."""
        self.change(
            "UPDATE photos SET state = ?, outcome = ?, verdict = ?, estimator = ?, reason = ?, "
            "remedy = ?, write_s = ?, curve = CASE WHEN ? THEN curve ELSE '' END WHERE name = ?",
            *(DONE, result.outcome, result.verdict, result.estimator, as_utf8(result.reason)),
            *(result.remedy, result.timing.write, bool(result.outputs), name),
        )
        self._list_outputs(name, result.outputs)

    def finish(self, name: str, stamp: Stamp, result: Result, fingerprint: str = "") -> None:
        """Record what came of a photo."""
        self._replace(name, stamp, result, fingerprint, DONE)
        self.change("DELETE FROM evidence WHERE photo = ?", name)
        self._list_outputs(name, result.outputs)

    def _replace(
        self, name: str, stamp: Stamp, result: Result, fingerprint: str, state: str
    ) -> None:
        self._base.execute(
            f"INSERT OR REPLACE INTO photos ({_COLUMNS}) "  # noqa: S608
            f"VALUES ({', '.join('?' * 20)})",
            (
                *(name, stamp.size, stamp.mtime_ns, result.sha256, stamp.recipe, state),
                *(result.outcome, result.verdict, result.estimator, as_utf8(result.reason)),
                *(result.remedy, *result.camera),
                *(result.timing.read, result.timing.estimate, result.timing.write),
                *("own" if result.outputs else "", fingerprint if result.sha256 else ""),
            ),
        )

    def _list_outputs(self, name: str, outputs: Iterable[Output]) -> None:
        self.change("DELETE FROM outputs WHERE photo = ?", name)
        self._base.executemany(
            "INSERT OR REPLACE INTO outputs VALUES (?, ?, ?, ?)",
            [(item.name, name, item.size, item.sha256) for item in outputs],
        )

    def forget(self, name: str) -> None:
        """Take back `start` of a photo that was never done."""
        self._base.execute(
            "DELETE FROM photos WHERE name = ? AND outcome = '' AND state = ?", (name, STARTED)
        )

    def forget_unseen(self) -> None:
        """Take back what could not be looked at: whether it can be now is to be found out."""
        with self.transaction():
            self.change("DELETE FROM photos WHERE size = ?", UNSEEN)

    def started(self) -> tuple[str, ...]:
        """Return the photos whose outputs may be half there."""
        rows = self._base.execute(
            "SELECT name FROM photos WHERE state IN (?, ?)", (STARTED, WRITING)
        )
        return tuple(row[0] for row in rows)

    def outputs(self, photo: str) -> list[Output]:
        """Return the outputs of a photo."""
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
