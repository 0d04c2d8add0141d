"""The tables of a manifest, and how older manifests are brought up to them.

`photos`, one row a photo
    `name` (key: path relative to the source, as `keys.py` writes it), `size` [bytes; -1 for what
    could not be looked at or is in the way of the outputs, which every run tries anew], `mtime_ns`,
    `ctime_ns` (0: not known), `sha256` (of the photo, empty if unreadable), `recipe` (hash of
    settings, version and formats), `state` (`started`: perhaps half written; `gathered`: its
    evidence is there, its outputs wait for its camera's curve; `writing`: these are perhaps half
    written; `done`), `outcome` (`values.Outcome`, or `failed`), `verdict` (`values.Verdict` or
    empty),
    `estimator`, `reason`, `remedy`, `make`, `model`, `serial`, `software` (as the file says),
    `read_s`, `estimate_s`, `write_s`; `fingerprint` (of size and ends of the file, by which
    duplicates are sought), `duplicate_of` (first photo, in the order of names, with the same bytes;
    empty for itself), `curve` (whose curve it gets: `own`, `camera`, `bracket`; empty if there
    is none). Of a run with `--pool camera` also: `camera` (-> cameras.key, empty for a photo that
    is not pooled), `misfit` (how far its evidence lies from the camera's curve, in standard
    deviations; -1 if it says nothing), `curve_sha256` (of the camera's or bracket's curve that was
    written), `bracket` (-> brackets.name), `taken` (EXIF time, [s] since 1970 in the camera's own
    zone), `exposure_s`, `aperture` (f-number), `iso`; 0 where the file does not tell.
`evidence`, one row a photo of such a run
    `photo` (key), `evidence` (`PhotoEvidence.to_json`), `face` (JSON: x, y, width, height, score of
    the face used; empty without), `samples` (8-bit RGB code values at the points of a regular grid,
    see `pair/code_samples.py`; by these brackets are recognized and solved).
`cameras`, one row a group of photos whose curve is one
    `key`, `make`, `model`, `serial`, `software`, `style` (picture settings that EXIF gives),
    `recipe`, `members` (number of photos), `telling` (of them with evidence), `used` (of them in
    the curve), `misfits` (of them farther from the curve than the limit), `basis` (hash of all the
    curve depends on), `verdict`, `reason`, `curve` (JSON: `encoded`, and for each channel `linear`
    and `sigma`; empty if no member tells anything), `curve_sha256` (of the exact curve).
`brackets`, one row a series of exposures of one scene
    `name` (key: its first photo), `camera`, `photos` (number), `stops` (from the shortest to the
    longest exposure), `used` (1 if its curve is what its photos get), `reason` (why not),
    `halves` (RMSE between the curves of two halves of the points), `bend` (between those of half
    and of double the smoothness), `residual` (stops), `covered` (share of code values
    that points lie near), `rmse` (against the camera's curve after one free scale; -1 without
    one), `curve` (as above), `curve_sha256`.
`merges`, one row a bracket that was to be merged (`--merge`)
    `name` (-> brackets.name), `basis` (hash of all the image depends on), `state` (`writing`:
    perhaps half written; `done`), `outcome` (`merged`, `not merged`, `failed`), `reason`, `remedy`
    (why not; of one that was merged what its curve rests on, and what its EXR does not hold),
    `file` (-> outputs.name, empty without), `exposures` (JSON: of each photo its name,
    `sha256`, stops relative to the one that the image shows, share of its pixels that moved).
`outputs`, one row a written file, or one that is about to be
    `name` (key: path relative to DST, as `keys.py` writes it), `photo` (-> photos.name), `size`
    [bytes; -1: about to be written], `sha256`, `written_ns` (its time when it was written, by which
    it is known to be as it was; 0: not known), `folded` (its name as a file system without regard
    to case and composition compares it).
`thumbnails`, one row a photo that could be read, for the report
    `photo` (key), `before` and `after` (WebP, 96 pixels: as it is, and by its curve; empty without
    one), `sha256` (of the photo's own hash and both pictures, by which another photo's and a
    damaged one are told).
`summaries`, one row a photo with a record, for the report
    `photo` (key), `text` (JSON: what a report tells of the record), `sha256` (of the record's own
    hash and the text, by which another record's and a damaged one are told).
`about`
    `key`, `value`: `schema`; `source` (folder of the photos); `recipe HASH` (JSON: how photos of
    that recipe were treated, for whoever makes outputs again); `cpu` (JSON: the processors that
    worked on it, see `files/processor.py`); `cameras` (JSON: of each model that the user measured,
    the hash of what was known of it when photos were last done).

All columns but the three durations, `written_ns` and the source's own `mtime_ns` and `ctime_ns` are
the same for an unbroken run and for one that was resumed.
"""

from __future__ import annotations

import sqlite3

from facecrf_ocio.archive.manifest.keys import folded, key_of

VERSION = 6  # of the tables below; one more for each change of them

_ABOUT = "CREATE TABLE IF NOT EXISTS about (key TEXT PRIMARY KEY, value TEXT NOT NULL)"
_FIRST = (
    """
    CREATE TABLE photos (
        name TEXT PRIMARY KEY, size INTEGER NOT NULL, mtime_ns INTEGER NOT NULL,
        sha256 TEXT NOT NULL DEFAULT '', recipe TEXT NOT NULL, state TEXT NOT NULL,
        outcome TEXT NOT NULL DEFAULT '', verdict TEXT NOT NULL DEFAULT '',
        estimator TEXT NOT NULL DEFAULT '', reason TEXT NOT NULL DEFAULT '',
        remedy TEXT NOT NULL DEFAULT '', make TEXT NOT NULL DEFAULT '',
        model TEXT NOT NULL DEFAULT '', serial TEXT NOT NULL DEFAULT '',
        software TEXT NOT NULL DEFAULT '', read_s REAL NOT NULL DEFAULT 0,
        estimate_s REAL NOT NULL DEFAULT 0, write_s REAL NOT NULL DEFAULT 0
    ) WITHOUT ROWID
    """,
    """
    CREATE TABLE outputs (
        name TEXT PRIMARY KEY, photo TEXT NOT NULL REFERENCES photos(name),
        size INTEGER NOT NULL, sha256 TEXT NOT NULL
    ) WITHOUT ROWID
    """,
    "CREATE INDEX outputs_of ON outputs (photo)",
)
_SECOND = (
    "ALTER TABLE photos ADD COLUMN fingerprint TEXT NOT NULL DEFAULT ''",
    "ALTER TABLE photos ADD COLUMN duplicate_of TEXT NOT NULL DEFAULT ''",
    "ALTER TABLE photos ADD COLUMN curve TEXT NOT NULL DEFAULT ''",
    "ALTER TABLE photos ADD COLUMN curve_sha256 TEXT NOT NULL DEFAULT ''",
    "ALTER TABLE photos ADD COLUMN camera TEXT NOT NULL DEFAULT ''",
    "ALTER TABLE photos ADD COLUMN misfit REAL NOT NULL DEFAULT 0",
    "ALTER TABLE photos ADD COLUMN bracket TEXT NOT NULL DEFAULT ''",
    "ALTER TABLE photos ADD COLUMN taken REAL NOT NULL DEFAULT 0",
    "ALTER TABLE photos ADD COLUMN exposure_s REAL NOT NULL DEFAULT 0",
    "ALTER TABLE photos ADD COLUMN aperture REAL NOT NULL DEFAULT 0",
    "ALTER TABLE photos ADD COLUMN iso REAL NOT NULL DEFAULT 0",
    """
    UPDATE photos SET curve = 'own'
    WHERE EXISTS (SELECT 1 FROM outputs WHERE outputs.photo = photos.name)
    """,
    "CREATE INDEX photos_alike ON photos (fingerprint, sha256, name) WHERE fingerprint != ''",
    "CREATE INDEX photos_of_camera ON photos (camera, name) WHERE camera != ''",
    "CREATE INDEX photos_not_done ON photos (state, name) WHERE state != 'done'",
    """
    CREATE TABLE evidence (
        photo TEXT PRIMARY KEY REFERENCES photos(name), evidence TEXT NOT NULL,
        face TEXT NOT NULL DEFAULT '', samples BLOB NOT NULL DEFAULT x''
    )
    """,
    """
    CREATE TABLE cameras (
        key TEXT PRIMARY KEY, make TEXT NOT NULL, model TEXT NOT NULL, serial TEXT NOT NULL,
        software TEXT NOT NULL, style TEXT NOT NULL, recipe TEXT NOT NULL,
        members INTEGER NOT NULL, telling INTEGER NOT NULL, used INTEGER NOT NULL,
        misfits INTEGER NOT NULL, basis TEXT NOT NULL, verdict TEXT NOT NULL,
        reason TEXT NOT NULL, curve TEXT NOT NULL, curve_sha256 TEXT NOT NULL
    ) WITHOUT ROWID
    """,
    """
    CREATE TABLE brackets (
        name TEXT PRIMARY KEY, camera TEXT NOT NULL REFERENCES cameras(key),
        photos INTEGER NOT NULL, stops REAL NOT NULL, used INTEGER NOT NULL, reason TEXT NOT NULL,
        halves REAL NOT NULL, bend REAL NOT NULL, residual REAL NOT NULL,
        covered REAL NOT NULL, rmse REAL NOT NULL,
        curve TEXT NOT NULL, curve_sha256 TEXT NOT NULL
    ) WITHOUT ROWID
    """,
)
_THIRD = (
    "ALTER TABLE photos ADD COLUMN ctime_ns INTEGER NOT NULL DEFAULT 0",
    "ALTER TABLE outputs ADD COLUMN written_ns INTEGER NOT NULL DEFAULT 0",
    "ALTER TABLE outputs ADD COLUMN folded TEXT NOT NULL DEFAULT ''",
    # Outputs' names stood there as they are; their photos' names could be read in two ways.
    """
    UPDATE photos SET name = key_of(name)
    WHERE name LIKE '%\\x%' AND (EXISTS (SELECT 1 FROM outputs WHERE outputs.photo = photos.name)
    OR EXISTS (SELECT 1 FROM evidence WHERE evidence.photo = photos.name))
    """,
    "UPDATE evidence SET photo = key_of(photo) WHERE photo LIKE '%\\x%'",
    """
    UPDATE outputs SET folded = folded(name), name = key_of(name), photo = key_of(photo)
    """,
    "CREATE INDEX outputs_alike ON outputs (folded)",
)
_FOURTH = (
    """
    CREATE TABLE merges (
        name TEXT PRIMARY KEY, basis TEXT NOT NULL DEFAULT '', state TEXT NOT NULL,
        outcome TEXT NOT NULL DEFAULT '', reason TEXT NOT NULL DEFAULT '',
        remedy TEXT NOT NULL DEFAULT '', file TEXT NOT NULL DEFAULT '',
        exposures TEXT NOT NULL DEFAULT '[]'
    ) WITHOUT ROWID
    """,
)
_FIFTH = (
    """
    CREATE TABLE thumbnails (
        photo TEXT PRIMARY KEY REFERENCES photos(name), sha256 TEXT NOT NULL,
        before BLOB NOT NULL, after BLOB NOT NULL
    )
    """,
)
_SIXTH = (
    """
    CREATE TABLE summaries (
        photo TEXT PRIMARY KEY REFERENCES photos(name), sha256 TEXT NOT NULL, text TEXT NOT NULL
    )
    """,
)
_STEPS = (_FIRST, _SECOND, _THIRD, _FOURTH, _FIFTH, _SIXTH)


def bring_up(base: sqlite3.Connection) -> int:
    """Make the tables, or bring those of an older version up to this one, in one transaction.

    Returns
    -------
    int
        The version of the manifest afterward; above `VERSION` if a newer facecrf wrote it, which
        is left as it is.

    Raises
    ------
    sqlite3.DatabaseError
        If it is the database of another program, or cannot be used.
    """
    for function in (key_of, folded):
        base.create_function(function.__name__, 1, function, deterministic=True)
    base.execute("BEGIN IMMEDIATE")
    try:
        _require_ours(base)
        base.execute(_ABOUT)
        told = fact(base, "schema")
        version = 0 if told is None else version_in(told)
        for step in _STEPS[version:]:
            for statement in step:
                base.execute(statement)
        if version < VERSION:
            version = VERSION
            note_fact(base, "schema", str(version))
    except BaseException:
        base.execute("ROLLBACK")
        raise
    base.execute("COMMIT")
    return version


def fact(base: sqlite3.Connection, key: str) -> str | None:
    """Return what the table `about` tells of the archive; None if it does not."""
    row = base.execute("SELECT value FROM about WHERE key = ?", (key,)).fetchone()
    return None if row is None else str(row[0])


def note_fact(base: sqlite3.Connection, key: str, value: str) -> None:
    """Let the table `about` tell something of the archive."""
    base.execute("INSERT OR REPLACE INTO about VALUES (?, ?)", (key, value))


def _require_ours(base: sqlite3.Connection) -> None:
    tables = {name for (name,) in base.execute("SELECT name FROM sqlite_master")}
    if tables and not {"about", "photos", "outputs"} <= tables:
        raise sqlite3.DatabaseError("it is the database of another program")


def version_in(value: object) -> int:
    """The version that a manifest tells of itself, or sqlite3.DatabaseError."""
    if not str(value).isascii() or not str(value).isdigit():
        raise sqlite3.DatabaseError(f"its version is {str(value)[:20]!r}")
    return int(str(value)[:9])
