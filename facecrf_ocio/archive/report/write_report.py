"""From a folder of outputs to the file of its report."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from facecrf_ocio.archive.check_outputs import REPORT
from facecrf_ocio.archive.report.contents import Archive, Row, gather
from facecrf_ocio.archive.report.html import render
from facecrf_ocio.archive.report.pictures import Pictures, pictures_of
from facecrf_ocio.errors import OutputError
from facecrf_ocio.files.atomic import Draft, require_free, write_files
from facecrf_ocio.files.threads import one_opencv_thread

PICTURED = 10_000
"""Photos that get pictures unless more are asked for: a page of some 50 MB, as browsers like."""

# Misfits first, then what is worth a look; a prior's own curve is everywhere the same.
_WORTH = ("weak", "reliable", "no curve", "prior only", "failed", "unfinished")


@dataclass(frozen=True, slots=True)
class Written:
    """A report that was written: its file, its size in bytes, and of how many photos."""

    path: Path
    size: int
    photos: int
    pictured: int
    source_is_there: bool


def write_report(
    folder: Path,
    path: Path | None = None,
    *,
    overwrite: bool = False,
    limit: int = PICTURED,
    jobs: int = 1,
) -> Written:
    """Write the report of a batch as one HTML file.

    Parameters
    ----------
    folder
        Where the batch wrote to. The photos are looked up where its manifest says, and only read.
    path
        File to write, `verify.REPORT` in the folder by default.
    overwrite
        Replace an existing file.
    limit
        Number of photos that get pictures and curves.
    jobs
        Threads that read photos.

    Raises
    ------
    OutputError
        If there is no manifest, or the report exists, or cannot be written.
    """
    path = folder / REPORT if path is None else path
    if path.suffix.lower() not in (".html", ".htm"):
        raise OutputError(f"{path}: is not named as a page; give it the suffix .html")
    require_free(path, overwrite=overwrite)
    archive = gather(folder)
    there = archive.source is not None and archive.source.is_dir()
    pictures = _pictures(archive, limit, jobs)
    now = datetime.now().astimezone().isoformat(sep=" ", timespec="minutes")
    content = render(archive, pictures, generated=now, source_is_there=there)
    write_files([Draft(path, content, lambda _: None)], overwrite=overwrite)
    return Written(path, len(content), len(archive.rows), len(pictures), there)


def _pictures(archive: Archive, limit: int, jobs: int) -> dict[str, Pictures]:
    chosen: Sequence[Row] = archive.rows
    if limit < len(archive.rows):
        worth = {kind: place for place, kind in enumerate(_WORTH)}
        misfits = archive.misfits
        chosen = sorted(chosen, key=lambda row: (row.name not in misfits, worth[row.kind]))[:limit]
    with one_opencv_thread(), ThreadPoolExecutor(jobs) as readers:
        found = readers.map(lambda row: pictures_of(archive, row), chosen)
        return {row.name: pictures for row, pictures in zip(chosen, found, strict=True)}
