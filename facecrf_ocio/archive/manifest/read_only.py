"""Opening a manifest to read it alone, so that it may lie on a medium that cannot be written.

Elsewhere SQLite leaves two empty files of its journal beside it, which the next batch takes away.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from facecrf_ocio.archive.manifest.database import FILE
from facecrf_ocio.errors import OutputError

_TELLS = "read it again, or run the batch that makes it"


@contextmanager
def reading(folder: Path) -> Iterator[sqlite3.Connection]:
    """Give the manifest of any version, also while a batch writes to it.

    Raises
    ------
    OutputError
        If there is no manifest, or it cannot be read.
    """
    path = folder / FILE
    if not path.is_file():
        raise OutputError(f"{folder}: has no {FILE}; name the folder a batch was written to")
    try:
        with closing(_open(path)) as base:
            yield base
    except sqlite3.Error as error:
        raise OutputError(f"{path}: the manifest cannot be read: {error}; {_TELLS}") from error


def _open(path: Path) -> sqlite3.Connection:
    """Open for reading; on a medium that cannot be written, without the journal's files."""
    name = path.absolute().as_uri()
    base = sqlite3.connect(f"{name}?mode=ro", uri=True, isolation_level=None, timeout=30)
    try:
        base.execute("SELECT 1 FROM sqlite_master").fetchone()
    except sqlite3.OperationalError:
        base.close()
        return sqlite3.connect(f"{name}?immutable=1", uri=True, isolation_level=None)
    return base
