"""One photo's result as a page of its own: the same detail as in the report of an archive."""

from __future__ import annotations

from pathlib import Path

from facecrf_ocio.archive.report.contents import KINDS, Archive, PhotoRow
from facecrf_ocio.archive.report.html import page_draft, render, this_minute
from facecrf_ocio.archive.report.links import relative_url, require_page
from facecrf_ocio.archive.report.page_source import PHOTO_PAGE
from facecrf_ocio.archive.report.pictures import told, with_images
from facecrf_ocio.archive.thumbnail import is_linear
from facecrf_ocio.files.atomic import write_files
from facecrf_ocio.values import Estimate, Photo
from facecrf_ocio.wording.sentence import COMMAND_LINE

LARGE_SIDE = 1280
"""[pixel] Longer side of the pictures: half of a wide screen, at two pixels a point."""


def write_photo_page(
    path: Path,
    photo: Photo,
    estimate: Estimate,
    files: tuple[Path, ...] = (),
    *,
    overwrite: bool = False,
) -> Path:
    """Write what came of a photo as one HTML file that needs nothing but a browser.

    Parameters
    ----------
    path
        File to write; an older page of a photo is replaced.
    photo, estimate
        A calibration, with a curve or without one.
    files
        What was written of it, in one folder; the page links to it.
    overwrite
        Replace any file.

    Raises
    ------
    OutputError
        If the path is another file's, or it cannot be written.
    """
    overwrite = require_page(path, PHOTO_PAGE, overwrite=overwrite)
    row = _row(photo, estimate)
    shown = told(estimate, tuple(file.name for file in files), COMMAND_LINE)
    shown = with_images(
        shown, photo.encoded, estimate.found, linear=is_linear(estimate), large=LARGE_SIDE
    )
    folder = files[0].parent if files else path.parent
    page = render(
        Archive(folder, None, (row,), (), ()),
        {row.name: shown},
        generated=this_minute(),
        source_is_there=True,
        links=(_address(path, photo), relative_url(path, folder)),
        title=PHOTO_PAGE,
    )
    return write_files([page_draft(path, page)], overwrite=overwrite)[0]


def _address(page: Path, photo: Photo) -> str:
    return "" if photo.path is None else relative_url(page, photo.path.parent)


def _row(photo: Photo, estimate: Estimate) -> PhotoRow:
    verdict = "" if estimate.confidence is None else str(estimate.confidence.verdict)
    camera = photo.camera
    return PhotoRow(
        name="photo in memory" if photo.path is None else photo.path.name,
        size=0 if photo.path is None else photo.path.stat().st_size,
        mtime_ns=0,
        sha256=photo.sha256 or "",
        kind=verdict if verdict in KINDS and estimate.found is not None else "no curve",
        outcome=str(estimate.outcome),
        estimator=estimate.estimator,
        reason=estimate.reason,
        remedy=estimate.remedy,
        camera=(camera.make, camera.model, camera.serial, camera.software),
        seconds=0.0,
        duplicate_of="",
        curve="" if estimate.found is None else "own",
        group="",
        misfit=0.0,
        bracket="",
    )
