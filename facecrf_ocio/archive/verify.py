"""Whether the outputs of an archive are still what was written."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.archive.content import sha256_of
from facecrf_ocio.archive.manifest import FILE, Manifest
from facecrf_ocio.archive.walk import name_of
from facecrf_ocio.errors import OutputError

REPORT = "facecrf-report.html"
MISSING, ALTERED, EXTRA = "missing", "altered", "extra"


@dataclass(frozen=True, slots=True)
class Fault:
    """A file that is not as the manifest says: `missing`, `altered` or `extra`."""

    name: str
    kind: str


def verify(folder: Path) -> Iterator[Fault]:
    """Compare all files below a folder with its manifest.

    Raises
    ------
    OutputError
        If there is no manifest, or a file cannot be read.
    """
    if not (folder / FILE).is_file():
        raise OutputError(f"{folder}: has no {FILE}; name the folder a batch was written to")
    manifest = Manifest(folder)
    try:
        for output in manifest.outputs():
            path = folder / output.name
            if not path.is_file():
                yield Fault(output.name, MISSING)
            elif path.stat().st_size != output.size or sha256_of(path) != output.sha256:
                yield Fault(output.name, ALTERED)
        yield from _extras(folder, manifest)
    finally:
        manifest.close()


def _extras(folder: Path, manifest: Manifest) -> Iterator[Fault]:
    for place, _, names in os.walk(folder):
        for file in sorted(names):
            name = name_of(Path(place, file), folder)
            ours = name.startswith("facecrf-manifest.") or name == REPORT
            if not ours and not manifest.has_output(name):
                yield Fault(name, EXTRA)
