"""What the manifest says of cameras, their photos and their brackets."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass

from facecrf_ocio.archive.manifest.damage import understanding
from facecrf_ocio.archive.manifest.database import GATHERED, STARTED, WRITING, Manifest
from facecrf_ocio.archive.manifest.keys import key_of, name_of_key
from facecrf_ocio.photo.shot import Shot

_PAGE = 500
"""Rows that are read at a time where rows are changed meanwhile."""


@dataclass(frozen=True, slots=True)
class Member:
    """A photo of a camera, as the manifest has it."""

    name: str
    sha256: str
    state: str
    curve: str
    curve_sha256: str
    bracket: str
    misfit: float
    outcome: str
    verdict: str


@dataclass(frozen=True, slots=True)
class CameraRow:
    """What is recorded of a camera; see `schema.py` for the fields."""

    key: str
    recipe_sha256: str
    members: int
    telling: int
    used: int
    misfits: int
    basis: str
    verdict: str
    reason: str
    curve: str
    curve_sha256: str


@dataclass(frozen=True, slots=True)
class BracketRow:
    """What is recorded of a bracket; see `schema.py` for the fields."""

    name: str
    camera: str
    photos: int
    stops: float
    used: bool
    reason: str
    halves: float
    bend: float
    residual: float
    covered: float
    rmse: float
    curve: str
    curve_sha256: str


def camera_keys(manifest: Manifest, recipe_sha256: str) -> list[str]:
    """Cameras that photos of a recipe are of, in their order."""
    query = "SELECT DISTINCT camera FROM photos WHERE camera != '' AND recipe = ? ORDER BY 1"
    return [key for (key,) in manifest.rows(query, recipe_sha256)]


def former_curve(manifest: Manifest, key: str) -> tuple[str, str]:
    """Basis and hash of the curve that is recorded of a camera, empty if none is."""
    query = "SELECT basis, curve_sha256 FROM cameras WHERE key = ?"
    return next(((basis, digest) for basis, digest in manifest.rows(query, key)), ("", ""))


def models(manifest: Manifest) -> list[str]:
    """Models that photos' files name, in their order."""
    return [model for (model,) in manifest.rows("SELECT DISTINCT model FROM photos ORDER BY 1")]


def take_back(manifest: Manifest, model: str) -> int:
    """Let the photos of a model, whose number is returned, be done by no recipe.

    Within a transaction. They keep their rows and outputs until they are done again.
    """
    (count,) = next(manifest.rows("SELECT COUNT(*) FROM photos WHERE model = ?", model))
    manifest.change("UPDATE photos SET recipe = '' WHERE model = ?", model)
    return int(count)


def contents(manifest: Manifest, key: str, recipe_sha256: str) -> Iterator[tuple[str, str]]:
    """Names and hashes of a camera's photos, in the order of names."""
    rows = manifest.rows(
        "SELECT name, sha256 FROM photos WHERE camera = ? AND recipe = ? AND state != ? "
        "ORDER BY name",
        *(key, recipe_sha256, STARTED),
    )
    return ((name_of_key(name), sha256) for name, sha256 in rows)


def different_photos(manifest: Manifest, key: str, recipe_sha256: str) -> Iterator[str]:
    """A camera's photos, each content once."""
    rows = manifest.rows(
        "SELECT MIN(name) FROM photos WHERE camera = ? AND recipe = ? AND state != ? "
        "GROUP BY sha256 ORDER BY sha256",
        *(key, recipe_sha256, STARTED),
    )
    return (name_of_key(name) for (name,) in rows)


def exposed_photos(
    manifest: Manifest, key: str, recipe_sha256: str, bracket: str | None = None
) -> Iterator[tuple[str, str, Shot]]:
    """A camera's photos, or a bracket's, that tell time and exposure; each content once."""
    rows = manifest.rows(
        "SELECT MIN(name), sha256, taken, exposure_s, aperture, iso FROM photos "
        "WHERE camera = ? AND recipe = ? AND state != ? AND taken > 0 AND exposure_s > 0 "
        "AND bracket = IFNULL(?, bracket) GROUP BY sha256 ORDER BY taken, MIN(name)",
        *(key, recipe_sha256, STARTED, None if bracket is None else key_of(bracket)),
    )
    return ((name_of_key(name), sha256, Shot("", *told)) for name, sha256, *told in rows)


def has_unassigned(manifest: Manifest, key: str, recipe_sha256: str) -> bool:
    """Whether a photo of a camera has no curve assigned, gathered again perhaps."""
    found = manifest.rows(
        "SELECT 1 FROM photos WHERE camera = ? AND recipe = ? AND state = ? AND curve = '' LIMIT 1",
        *(key, recipe_sha256, GATHERED),
    )
    return next(found, None) is not None


def members(manifest: Manifest, key: str, recipe_sha256: str) -> Iterator[Member]:
    """All photos of a camera, which may be changed meanwhile."""
    return _paged(manifest, key, recipe_sha256, "state != ?", STARTED)


def waiting_members(manifest: Manifest, key: str, recipe_sha256: str) -> Iterator[Member]:
    """The photos of a camera whose outputs are still to be written; they may be changed."""
    return _paged(manifest, key, recipe_sha256, "state IN (?, ?)", GATHERED, WRITING)


def _paged(
    manifest: Manifest, key: str, recipe_sha256: str, which: str, *states: str
) -> Iterator[Member]:
    last = ""
    while True:
        page = list(
            manifest.rows(
                "SELECT name, sha256, state, curve, curve_sha256, bracket, misfit, outcome, "  # noqa: S608
                f"verdict FROM photos WHERE camera = ? AND recipe = ? AND {which} AND name > ? "
                "ORDER BY name LIMIT ?",
                *(key, recipe_sha256, *states, last, _PAGE),
            )
        )
        for name, sha256, state, curve, digest, bracket, *rest in page:
            told = name_of_key(bracket) if bracket else ""
            yield Member(name_of_key(name), sha256, state, curve, digest, told, *rest)
        if len(page) < _PAGE:
            return
        last = page[-1][0]


def assign(manifest: Manifest, member: Member) -> None:
    """Record whose curve a photo gets, within a transaction."""
    bracket = key_of(member.bracket) if member.bracket else ""
    manifest.change(
        "UPDATE photos SET misfit = ?, bracket = ?, state = ?, curve = ?, curve_sha256 = ? "
        "WHERE name = ?",
        *(member.misfit, bracket, member.state, member.curve, member.curve_sha256),
        key_of(member.name),
    )


def record_camera(manifest: Manifest, row: CameraRow) -> None:
    """Record a camera, within a transaction."""
    with understanding(manifest.path):
        make, model, serial, software, style = json.loads(row.key)
    manifest.change(
        f"INSERT OR REPLACE INTO cameras VALUES ({', '.join('?' * 16)})",  # noqa: S608
        *(row.key, make, model, serial, software, style, row.recipe_sha256, row.members),
        *(row.telling, row.used, row.misfits, row.basis, row.verdict, row.reason),
        *(row.curve, row.curve_sha256),
    )


def forget_brackets(manifest: Manifest, key: str) -> None:
    """Take back the brackets of a camera, within a transaction."""
    manifest.change("DELETE FROM brackets WHERE camera = ?", key)


def record_bracket(manifest: Manifest, row: BracketRow) -> None:
    """Record a bracket, within a transaction."""
    manifest.change(
        f"INSERT INTO brackets VALUES ({', '.join('?' * 13)})",  # noqa: S608
        *(key_of(row.name), row.camera, row.photos, row.stops, int(row.used), row.reason),
        *(row.halves, row.bend, row.residual, row.covered, row.rmse, row.curve, row.curve_sha256),
    )


def forget_empty_cameras(manifest: Manifest) -> None:
    """Take back cameras without photos, and their brackets."""
    with manifest.transaction():
        manifest.change(
            "DELETE FROM cameras WHERE NOT EXISTS "
            "(SELECT 1 FROM photos WHERE photos.camera = cameras.key)"
        )
        manifest.change("DELETE FROM brackets WHERE camera NOT IN (SELECT key FROM cameras)")
