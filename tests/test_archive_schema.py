"""Manifests of older versions are brought up to date, those of newer ones are left alone."""

from __future__ import annotations

import ast
import re
import sqlite3
from pathlib import Path

import pytest

import facecrf_ocio
from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.archive.manifest.database import Manifest, Stamp
from facecrf_ocio.archive.manifest.schema import VERSION
from facecrf_ocio.archive.task import Output, Result
from facecrf_ocio.errors import OutputError

# As the first version of this package wrote it.
FIRST = """
CREATE TABLE about (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE photos (
    name TEXT PRIMARY KEY, size INTEGER NOT NULL, mtime_ns INTEGER NOT NULL,
    sha256 TEXT NOT NULL DEFAULT '', recipe TEXT NOT NULL, state TEXT NOT NULL,
    outcome TEXT NOT NULL DEFAULT '', verdict TEXT NOT NULL DEFAULT '',
    estimator TEXT NOT NULL DEFAULT '', reason TEXT NOT NULL DEFAULT '',
    remedy TEXT NOT NULL DEFAULT '', make TEXT NOT NULL DEFAULT '',
    model TEXT NOT NULL DEFAULT '', serial TEXT NOT NULL DEFAULT '',
    software TEXT NOT NULL DEFAULT '', read_s REAL NOT NULL DEFAULT 0,
    estimate_s REAL NOT NULL DEFAULT 0, write_s REAL NOT NULL DEFAULT 0
) WITHOUT ROWID;
CREATE TABLE outputs (
    name TEXT PRIMARY KEY, photo TEXT NOT NULL REFERENCES photos(name),
    size INTEGER NOT NULL, sha256 TEXT NOT NULL
) WITHOUT ROWID;
CREATE INDEX outputs_of ON outputs (photo);
INSERT INTO about VALUES ('schema', '1'), ('source', '/photos');
INSERT INTO photos VALUES ('a.jpg', 3, 4, 'ab', 'r', 'done', 'calibrated', 'weak', 'joint',
    'why', '', 'Acme', '', '', '', 1, 2, 3);
INSERT INTO outputs VALUES ('a.jpg.cube', 'a.jpg', 5, 'cd');
"""


def columns(folder):
    base = sqlite3.connect(folder / FILE)
    try:
        tables = base.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall()
        return {name: base.execute(f"PRAGMA table_info({name})").fetchall() for (name,) in tables}
    finally:
        base.close()


def test_a_manifest_of_the_first_version_keeps_what_it_knows_and_gets_the_new_tables(tmp_path):
    old, new = tmp_path / "old", tmp_path / "new"
    old.mkdir()
    new.mkdir()
    base = sqlite3.connect(old / FILE)
    base.executescript(FIRST)
    base.close()
    Manifest(new).close()
    manifest = Manifest(old)
    assert manifest.about("schema") == str(VERSION)
    assert manifest.about("source") == "/photos"
    known = manifest.known("a.jpg")
    assert (known.stamp, known.state, known.verdict) == (Stamp(3, 4, "r"), "done", "weak")
    assert list(manifest.outputs("a.jpg")) == [Output("a.jpg.cube", 5, "cd")]
    with manifest.transaction():
        manifest.finish("b.jpg", Stamp(1, 2, "r"), Result("failed"))
    manifest.close()
    assert columns(old) == columns(new)


def test_a_manifest_of_a_newer_version_is_refused_and_not_changed(tmp_path):
    Manifest(tmp_path).close()
    base = sqlite3.connect(tmp_path / FILE)
    with base:
        base.execute("UPDATE about SET value = '99' WHERE key = 'schema'")
    base.close()
    with pytest.raises(OutputError, match="newer facecrf; update"):
        Manifest(tmp_path)
    base = sqlite3.connect(tmp_path / FILE)
    assert base.execute("SELECT value FROM about WHERE key = 'schema'").fetchone() == ("99",)
    base.close()


STATEMENT = re.compile(
    r"\s*(SELECT .* FROM|INSERT .*INTO|UPDATE .* SET|DELETE FROM|CREATE (TABLE|INDEX)|PRAGMA) ",
    re.DOTALL,
)


def test_sql_is_spoken_by_the_manifest_alone():
    package = Path(facecrf_ocio.__file__).parent
    speaking = set()
    for path in package.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            text = node.value if isinstance(node, ast.Constant) else None
            if isinstance(text, str) and STATEMENT.match(text):
                speaking.add(path.parent.relative_to(package).as_posix())
    assert speaking == {"archive/manifest"}
