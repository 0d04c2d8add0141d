"""Photos with the same bytes, as the manifest knows them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from facecrf_ocio.archive.manifest.damage import understanding
from facecrf_ocio.archive.manifest.database import STARTED, Manifest
from facecrf_ocio.archive.manifest.keys import key_of, name_of_key
from facecrf_ocio.archive.task import Result
from facecrf_ocio.photo.shot import Shot


@dataclass(frozen=True, slots=True)
class Twin:
    """A photo that probably has the bytes of another; `key` is its camera's, empty without."""

    name: str
    state: str
    result: Result
    key: str


def twins_of(manifest: Manifest, name: str, fingerprint: str, recipe_sha256: str) -> list[Twin]:
    """Return the photos that probably have a photo's bytes and were treated as it is to be."""
    rows = manifest.rows(
        "SELECT name, state, outcome, verdict, estimator, reason, remedy, sha256, make, model, "
        "serial, software, camera, taken, exposure_s, aperture, iso FROM photos "
        "WHERE fingerprint = ? AND recipe = ? AND state != ? AND name != ? ORDER BY name",
        *(fingerprint, recipe_sha256, STARTED, key_of(name)),
    )
    return [_twin(manifest.path, row) for row in rows]


def mark_duplicates(manifest: Manifest) -> None:
    """Record for every photo which one, first in the order of names, has the same bytes."""
    first = (
        "IFNULL((SELECT MIN(name) FROM photos AS other "
        "WHERE other.fingerprint = photos.fingerprint AND other.sha256 = photos.sha256 "
        "AND other.fingerprint != '' AND other.name < photos.name), '')"
    )
    with manifest.transaction():
        manifest.change(
            f"UPDATE photos SET duplicate_of = {first} "  # noqa: S608
            "WHERE fingerprint IN (SELECT fingerprint FROM photos WHERE fingerprint != '' "
            "GROUP BY fingerprint HAVING COUNT(*) > 1) OR duplicate_of != ''"
        )


def _twin(path: Path, row: tuple[Any, ...]) -> Twin:
    key, state, outcome, verdict, estimator, reason, remedy, sha256, *rest = row
    make, model, serial, software, camera, *exposure = rest
    with understanding(path):
        style = json.loads(camera)[-1] if camera else ""
    result = Result(
        *(outcome, verdict, estimator, reason, remedy, sha256),
        camera=(make, model, serial, software),
        shot=Shot(style, *exposure),
    )
    return Twin(name_of_key(key), state, result, camera)
