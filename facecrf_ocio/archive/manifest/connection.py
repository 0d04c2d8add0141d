"""The manifest's database: opened, changed as a whole or not at all, and asked in SQL.

`DST/facecrf-manifest.sqlite`, in WAL mode, every transaction flushed to the disk.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from facecrf_ocio.archive.manifest.damage import telling
from facecrf_ocio.archive.manifest.schema import VERSION, bring_up
from facecrf_ocio.errors import OutputError

FILE = "facecrf-manifest.sqlite"


class Connection:
    """An open manifest, of the tables that this version knows; one process at a time writes."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / FILE
        if self.path.is_symlink():
            raise OutputError(f"{self.path}: is a link; remove it, or choose another folder")
        with telling(self.path):
            self._base = sqlite3.connect(self.path, isolation_level=None, timeout=5)
        try:
            with telling(self.path):
                self._base.execute("PRAGMA journal_mode=WAL")
                self._base.execute("PRAGMA synchronous=FULL")
                version = bring_up(self._base)
            if version > VERSION:
                raise OutputError(
                    f"{self.path}: was written by a newer facecrf; update facecrf-ocio"
                )
        except BaseException:
            self._base.close()
            raise

    def close(self) -> None:
        """Close it; what was recorded stays."""
        self._base.close()

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Record all that happens within, or nothing; on the disk when it ends."""
        with telling(self.path):
            self._base.execute("BEGIN IMMEDIATE")
            try:
                yield
            except BaseException:
                self._base.execute("ROLLBACK")
                raise
            self._base.execute("COMMIT")

    def rows(self, query: str, *values: object) -> Iterator[tuple[Any, ...]]:
        """Stream the rows of a query on the tables that `schema.py` describes."""
        with telling(self.path):
            for row in self._base.execute(query, values):  # noqa: UP028 - may be left half way
                yield row

    def change(self, statement: str, *values: object) -> None:
        """Change the tables, within a transaction."""
        with telling(self.path):
            self._base.execute(statement, values)
