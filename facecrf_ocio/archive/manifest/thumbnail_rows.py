"""Thumbnails in the manifest: kept by a batch, and given to a report if they are the photo's."""

from __future__ import annotations

import hashlib

from facecrf_ocio.archive.manifest.database import Manifest
from facecrf_ocio.archive.manifest.keys import key_of
from facecrf_ocio.archive.manifest.read_only import Reader
from facecrf_ocio.archive.task import Result, Thumbnail


def keep_thumbnail(manifest: Manifest, name: str, result: Result) -> None:
    """Record the thumbnail of a photo that was looked at, within a transaction."""
    kept = result.thumbnail
    if kept is not None:
        manifest.change(
            "INSERT OR REPLACE INTO thumbnails VALUES (?, ?, ?, ?)",
            *(key_of(name), _digest(result.sha256, kept), kept.before, kept.after),
        )


def thumbnail_in(manifest: Reader, name: str, sha256: str) -> Thumbnail | None:
    """The thumbnail of a photo of these bytes; None if none is kept, or it is damaged."""
    found = manifest.thumbnail(name)
    if found is None:
        return None
    digest, before, after = found
    if not isinstance(before, bytes) or not isinstance(after, bytes):
        return None
    kept = Thumbnail(before, after)
    return kept if before and digest == _digest(sha256, kept) else None


def _digest(sha256: str, kept: Thumbnail) -> str:
    """Hash of a photo's hash and its pictures; the first one's length tells them apart."""
    head = f"{sha256} {len(kept.before)} ".encode()
    return hashlib.sha256(head + kept.before + kept.after).hexdigest()
