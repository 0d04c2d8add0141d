"""What is fed with changed files, and what it may answer: a result, or an error of ours."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import corpus

from facecrf_ocio.archive.check_outputs import faults_in
from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.archive.manifest.database import Manifest
from facecrf_ocio.archive.manifest.twin_rows import mark_duplicates, twins_of
from facecrf_ocio.archive.report.contents import read_archive
from facecrf_ocio.image.lut_lookup import lut_lookup
from facecrf_ocio.lut.lint import lint
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.photo.shot import read_shot
from facecrf_ocio.photo.tags.named_curve import curve_of_profile, is_other_curve
from facecrf_ocio.photo.tags.profile import primaries_from_icc, profile_notes
from facecrf_ocio.record.calibration_record import read_record, read_source


@dataclass(frozen=True)
class Target:
    """A reader of files, and what makes the files it starts from.

    `name` is what a changed file is called; empty: as the one it was made of.
    """

    corpus: Callable[[Path], list[Path]]
    feed: Callable[[Path], object]
    name: str = ""


def _profile(path: Path) -> None:
    content = path.read_bytes()
    for read in (primaries_from_icc, profile_notes, curve_of_profile, is_other_curve):
        read(content)


def _record(path: Path) -> None:
    read_source(path)
    read_record(path)


def _tags(path: Path) -> None:
    read_shot(path)
    read_photo(path)


def _manifest(path: Path) -> None:
    for leftover in path.parent.glob(f"{FILE}-*"):
        leftover.unlink()
    read_archive(path.parent)
    list(faults_in(path.parent))
    manifest = Manifest(path.parent)
    try:
        for name in list(manifest.started()):
            manifest.outputs(name)
        manifest.known("a.jpg")
        manifest.outputs("a.jpg")
        twins_of(manifest, "c.jpg", "f", "r")
        mark_duplicates(manifest)
    finally:
        manifest.close()


TARGETS: Mapping[str, Target] = {
    "lint": Target(corpus.luts, lint),
    "lut": Target(corpus.luts, lut_lookup),
    "icc": Target(corpus.profiles, _profile),
    "record": Target(corpus.records, _record),
    "exif": Target(corpus.tagged, _tags),
    "manifest": Target(corpus.manifests, _manifest, FILE),
    "read_photo": Target(corpus.photos, read_photo),
}
