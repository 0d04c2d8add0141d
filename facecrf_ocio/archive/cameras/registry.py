"""A registry of measured cameras that changed: photos of those cameras are to be done again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping

from facecrf_ocio.archive.manifest.camera_rows import models, take_back
from facecrf_ocio.archive.manifest.damage import understanding
from facecrf_ocio.archive.manifest.database import Manifest
from facecrf_ocio.cameras.known_cameras import KnownCamera, names_of, own_cameras

_FACT = "cameras"


def reopen_measured(manifest: Manifest) -> int:
    """Take back all photos of models whose measurements by the user are others than before.

    They keep their row and their outputs until they are done again. What the package ships changes
    with its version, which is part of every recipe.

    Returns
    -------
    int
        The number of photos.

    Raises
    ------
    LutError
        If the user's registry cannot be read.
    """
    now = _digests(own_cameras())
    with understanding(manifest.path):
        before: Mapping[str, str] = json.loads(manifest.about(_FACT) or "{}")
    changed = {model for model, _ in now.items() ^ before.items()}
    if not changed:
        return 0
    affected = [model for model in models(manifest) if model.strip().casefold() in changed]
    with manifest.transaction():
        count = sum(take_back(manifest, model) for model in affected)
        manifest.note(_FACT, json.dumps(now, sort_keys=True))
    return count


def _digests(cameras: tuple[KnownCamera, ...]) -> dict[str, str]:
    """Hash of all that is measured of each model, by all of its names, whatever the order."""
    of_model: dict[str, list[str]] = {}
    for one in cameras:
        said = json.dumps([*one.key, one.grade, one.spread_stops, one.linear])
        for name in names_of(one.make, one.model):
            of_model.setdefault(name, []).append(said)
    return {
        model: hashlib.sha256("\n".join(sorted(said)).encode()).hexdigest()
        for model, said in of_model.items()
    }
