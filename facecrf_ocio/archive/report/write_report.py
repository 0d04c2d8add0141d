"""From a folder of outputs to the file of its report."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.archive.check_outputs import REPORT
from facecrf_ocio.archive.manifest.read_only import Reader, reading
from facecrf_ocio.archive.manifest.summary_rows import summary_text_in
from facecrf_ocio.archive.manifest.thumbnail_rows import thumbnail_in
from facecrf_ocio.archive.report.contents import Archive, PhotoRow, read_archive
from facecrf_ocio.archive.report.html import page_draft, render, this_minute
from facecrf_ocio.archive.report.links import relative_url, require_page
from facecrf_ocio.archive.report.look_again import Kept, pictures_of
from facecrf_ocio.archive.report.page_source import ARCHIVE_PAGE
from facecrf_ocio.archive.report.pictures import Pictures
from facecrf_ocio.files.atomic import write_files
from facecrf_ocio.files.threads import one_opencv_thread

PICTURED = 10_000
"""Photos that get pictures unless more are asked for: a page of some 50 MB, as browsers like."""

LARGE = 300
"""Photos that get pictures to compare at a larger size, of some 70 kB each: 20 MB at most."""

LARGE_SIDE = 512
"""[pixel] Longer side of those: what fits a phone, and half of a wide dialog."""

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
    large: int = LARGE,
    jobs: int = 1,
    watch: Callable[[int], None] = lambda _: None,
) -> Written:
    """Write the report of a batch as one HTML file.

    Parameters
    ----------
    folder
        Where the batch wrote to. The photos are looked up where its manifest says, and only read.
    path
        File to write, `check_outputs.REPORT` in the folder by default.
    overwrite
        Replace an existing file, even one that is no report.
    limit
        Number of photos that get pictures and curves.
    large
        How many of these get pictures to compare at a larger size.
    jobs
        Threads that read photos.
    watch
        Called with the number of photos in all, once for each that was read.

    Raises
    ------
    OutputError
        If there is no manifest, or the path is another file's, or it cannot be written.
    """
    path = folder / REPORT if path is None else path
    overwrite = require_page(path, ARCHIVE_PAGE, overwrite=overwrite)
    archive = read_archive(folder)
    there = archive.source is not None and archive.source.is_dir()
    pictures = _pictures(archive, (limit, large), jobs, watch)
    now = this_minute()
    photos = relative_url(path, archive.source) if there and archive.source is not None else ""
    links = (photos, relative_url(path, folder))
    page = render(archive, pictures, generated=now, source_is_there=there, links=links)
    write_files([page_draft(path, page)], overwrite=overwrite)
    return Written(path, path.stat().st_size, len(archive.rows), len(pictures), there)


def _pictures(
    archive: Archive, counts: tuple[int, int], jobs: int, watch: Callable[[int], None]
) -> dict[str, Pictures]:
    worth = {kind: place for place, kind in enumerate(_WORTH)}
    chosen = sorted(
        archive.rows, key=lambda row: (row.name not in archive.misfits, worth[row.kind])
    )[: counts[0]]
    large = {row.name for row in chosen[: counts[1]]}

    def pictures(row: PhotoRow, kept: Kept) -> Pictures:
        made = pictures_of(archive, row, kept, LARGE_SIDE if row.name in large else 0)
        watch(len(chosen))
        return made

    with reading(archive.folder) as manifest:
        kept = [_kept(manifest, row, archive.folder) for row in chosen]
    with one_opencv_thread(), ThreadPoolExecutor(jobs) as readers:
        found = readers.map(pictures, chosen, kept)
        return {row.name: pictures for row, pictures in zip(chosen, found, strict=True)}


def _kept(manifest: Reader, row: PhotoRow, folder: Path) -> Kept:
    thumbnail = thumbnail_in(manifest, row.name, row.sha256)
    return Kept(thumbnail, summary_text_in(manifest, row.name, folder))
