"""What is as it was: by a look at size and times, and at the bytes where the times alone differ."""

from __future__ import annotations

import stat
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from facecrf_ocio.archive.manifest.database import CLAIMED, STARTED, Known, Manifest, Stamp
from facecrf_ocio.archive.place import Place
from facecrf_ocio.archive.task import Output
from facecrf_ocio.files.content import sha256_or_unreadable

_TOGETHER = 500
"""Rows that only get another time are recorded so many at once: each alone would be flushed."""


class Unchanged:
    """Tells photos and outputs that are as they were, and records their new times."""

    def __init__(self, manifest: Manifest, place: Place) -> None:
        self.manifest, self.place = manifest, place
        self._touched: list[Callable[[], None]] = []

    def is_photo(self, name: str, known: Known, stamp: Stamp, path: Path) -> bool:
        """Whether a photo is the one that is known, and was treated as it is to be now."""
        if known.stamp == stamp:
            return True
        if replace(known.stamp, mtime_ns=stamp.mtime_ns, ctime_ns=stamp.ctime_ns) != stamp:
            return False
        times_tell = known.stamp.ctime_ns == 0 and known.stamp.mtime_ns == stamp.mtime_ns
        if not times_tell and not self._has_bytes(path, known):
            return False
        self._touch(lambda: self.manifest.touch(name, stamp))
        return True

    def _has_bytes(self, path: Path, known: Known) -> bool:
        return (
            known.state != STARTED
            and known.sha256 != ""
            and known.sha256 == sha256_or_unreadable(path)
        )

    def are_outputs(self, photo: str) -> bool:
        """Whether all that was made of a photo is there, as it was written.

        What is only claimed of one that is done is a merge that was broken off, and no fault of it.
        """
        made = (one for one in self.manifest.outputs(photo) if one.size != CLAIMED)
        return all(self.is_output(output) for output in made)

    def is_output(self, output: Output) -> bool:
        """Whether an output is there, as it was written."""
        try:
            path = self.place.inside(output.name)
            status = path.lstat()
        except OSError:
            return False
        if not stat.S_ISREG(status.st_mode) or status.st_size != output.size:
            return False
        if status.st_mtime_ns == output.written_ns:
            return True
        if output.written_ns and sha256_or_unreadable(path) != output.sha256:
            return False
        now = replace(output, written_ns=status.st_mtime_ns)
        self._touch(lambda: self.manifest.touch_output(now))
        return True

    def _touch(self, record: Callable[[], None]) -> None:
        self._touched.append(record)
        if len(self._touched) >= _TOGETHER:
            self.record()

    def record(self) -> None:
        """Record the new times."""
        with self.manifest.transaction():
            for record in self._touched:
                record()
        self._touched.clear()
