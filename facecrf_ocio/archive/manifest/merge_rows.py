"""What the manifest says of brackets that are merged to one image."""

from __future__ import annotations

import json
from dataclasses import dataclass

from facecrf_ocio.archive.manifest.database import (
    CLAIMED,
    DONE,
    WRITING,
    Manifest,
    record_outputs,
)
from facecrf_ocio.archive.manifest.keys import key_of, name_of_key
from facecrf_ocio.archive.task import Output
from facecrf_ocio.files.plain_text import plain_text


@dataclass(frozen=True, slots=True)
class BracketNamed:
    """A bracket of a camera: its first photo, its stops, and the hash of the curve it gets."""

    name: str
    stops: float
    used: bool
    curve_sha256: str


@dataclass(frozen=True, slots=True)
class MergeRow:
    """What is recorded of a merge; see `schema.py` for the fields.

    `exposures` are names, hashes, stops and shares that moved of the photos.
    """

    name: str
    basis: str
    outcome: str
    reason: str = ""
    remedy: str = ""
    exposures: tuple[tuple[str, str, float, float], ...] = ()


def brackets_of(manifest: Manifest, camera: str) -> list[BracketNamed]:
    """The brackets of a camera, in the order of names."""
    rows = manifest.rows(
        "SELECT b.name, b.stops, b.used, CASE WHEN b.used THEN b.curve_sha256 ELSE "
        "c.curve_sha256 END FROM brackets AS b JOIN cameras AS c ON b.camera = c.key "
        "WHERE b.camera = ? ORDER BY b.name",
        camera,
    )
    return [
        BracketNamed(name_of_key(key), stops, bool(used), digest)
        for key, stops, used, digest in rows
    ]


def former_merge(manifest: Manifest, name: str) -> tuple[str, str]:
    """Basis and outcome of a bracket's merge; empty if there is none, or one half written."""
    query = "SELECT basis, outcome FROM merges WHERE name = ? AND state = ?"
    found = manifest.rows(query, key_of(name), DONE)
    return next(((basis, outcome) for basis, outcome in found), ("", ""))


def merge_begins(manifest: Manifest, name: str, claimed: str | None) -> None:
    """Record that a merge may be half written, within a transaction."""
    key = key_of(name)
    manifest.change(
        "INSERT INTO merges (name, state) VALUES (?, ?) ON CONFLICT (name) DO UPDATE SET "
        "state = excluded.state",
        *(key, WRITING),
    )
    if claimed is not None:
        record_outputs(manifest, key, [Output(claimed, CLAIMED, "")])


def merge_ends(manifest: Manifest, row: MergeRow, outputs: tuple[Output, ...]) -> None:
    """Record what came of a merge, within a transaction."""
    key = key_of(row.name)
    manifest.change(
        "INSERT OR REPLACE INTO merges VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
        *(key, row.basis, DONE, row.outcome, plain_text(row.reason), plain_text(row.remedy)),
        key_of(outputs[0].name) if outputs else "",
        json.dumps([[key_of(name), *told] for name, *told in row.exposures]),
    )
    record_outputs(manifest, key, outputs)


def merged_file(manifest: Manifest, name: str) -> str:
    """The file that a bracket was merged to, empty if there is none."""
    found = manifest.rows("SELECT file FROM merges WHERE name = ? AND file != ''", key_of(name))
    return next((name_of_key(key) for (key,) in found), "")


def merges_without_bracket(manifest: Manifest) -> list[str]:
    """Merges of what is no bracket any more."""
    rows = manifest.rows("SELECT name FROM merges WHERE name NOT IN (SELECT name FROM brackets)")
    return [name_of_key(key) for (key,) in rows]


def forget_merge(manifest: Manifest, name: str, file: str) -> None:
    """Take back a merge, within a transaction."""
    manifest.change("DELETE FROM merges WHERE name = ?", key_of(name))
    if file:
        manifest.change("DELETE FROM outputs WHERE name = ?", key_of(file))
