"""Whether the outputs of an archive are still what was written; nothing is changed."""

from __future__ import annotations

import os
import stat
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.archive.manifest.read_only import Reader, reading
from facecrf_ocio.archive.place import LOCK, Place
from facecrf_ocio.archive.task import Output
from facecrf_ocio.errors import OutputError
from facecrf_ocio.files.content import sha256_of

REPORT = "facecrf-report.html"
MISSING, ALTERED, EXTRA, UNREADABLE = "missing", "altered", "extra", "unreadable"


@dataclass(frozen=True, slots=True)
class Fault:
    """A file that is not as the manifest says: `missing`, `altered`, `unreadable` or `extra`.

    `photo` is what it was made of, empty for what is extra.
    """

    name: str
    kind: str
    photo: str = ""


def faults_in(folder: Path) -> Iterator[Fault]:
    """Compare all files below a folder with its manifest.

    Raises
    ------
    OutputError
        If there is no manifest, or it cannot be read.
    """
    place = Place.of(folder)
    with reading(folder) as manifest:
        for photo, output in manifest.outputs():
            kind = _fault(place, output)
            if kind:
                yield Fault(output.name, kind, photo)
        yield from _extras(folder, manifest)


def _fault(place: Place, output: Output) -> str:
    try:
        path = place.inside(output.name)
        status = path.lstat()
    except FileNotFoundError:
        return MISSING
    except OutputError:  # a link leads elsewhere: what is there was not written by a batch
        return ALTERED
    except OSError:
        return UNREADABLE
    if not stat.S_ISREG(status.st_mode) or status.st_size != output.size:
        return ALTERED
    try:
        return "" if sha256_of(path) == output.sha256 else ALTERED
    except OutputError:
        return UNREADABLE


def _extras(folder: Path, manifest: Reader) -> Iterator[Fault]:
    unread: list[OSError] = []
    for place, below, names in os.walk(folder, onerror=unread.append):
        below.sort()
        for file in sorted(names):
            name = Path(place, file).relative_to(folder).as_posix()
            ours = name.startswith("facecrf-manifest.") or name in (REPORT, LOCK)
            # Some file systems compose names otherwise than they were given.
            if not ours and not any(map(manifest.has_output, (name, _composed(name)))):
                yield Fault(name, EXTRA)
    for error in unread:
        yield Fault(Path(error.filename).relative_to(folder).as_posix(), UNREADABLE)


def _composed(name: str) -> str:
    return unicodedata.normalize("NFC", name)
