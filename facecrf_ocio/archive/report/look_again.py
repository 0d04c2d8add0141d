"""A photo of an archive, read again for its pictures; why it cannot be shown, where it cannot."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageOps

from facecrf_ocio.archive.report.contents import Archive, PhotoRow
from facecrf_ocio.archive.report.pictures import Pictures, with_images
from facecrf_ocio.archive.report.record_summary import Summary, summary_in, summary_of_record
from facecrf_ocio.archive.task import Thumbnail
from facecrf_ocio.archive.thumbnail import SIDE
from facecrf_ocio.errors import FaceCRFError
from facecrf_ocio.photo.containers.suffixes import suffixes_named
from facecrf_ocio.photo.raster.pixels import Pixels
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.photo.tags.unwarned import unwarned
from facecrf_ocio.record.calibration_record import Record, read_record
from facecrf_ocio.record.output_names import EXR, RECORD, output_name
from facecrf_ocio.values import Outcome

GONE = "The photo is no longer there."
CHANGED = "The photo has changed since it was calibrated."
UNREADABLE = "The photo cannot be read any more."
NO_RECORD = "The record of its calibration is missing or damaged."
NOT_OPENED = "Not opened again, since it could not be read before."

_JPEG = suffixes_named("JPEG")


@dataclass(frozen=True, slots=True)
class Kept:
    """What a batch kept of a photo for its report: None and empty where it kept nothing."""

    thumbnail: Thumbnail | None = None
    summary: str = ""


def pictures_of(archive: Archive, row: PhotoRow, kept: Kept = Kept(), large: int = 0) -> Pictures:
    """Take the thumbnail and the summary that were kept; or read the photo, and its record.

    The photo is read, without being changed, where none was kept, or large ones are wanted.

    Nothing that is wrong with the photo is an error here. A photo that failed is not opened, for
    it may have crashed or hung its decoder.
    """
    if row.kind == "failed":
        return Pictures(missing=NOT_OPENED)
    small = kept.thumbnail
    summary = summary_in(kept.summary) if kept.summary and small and not large else None
    record, problem = (None, "") if summary is not None else _record_of(archive.folder, row)
    if record is not None:
        summary = summary_of_record(record)
    shown = Pictures() if summary is None else _with_files(archive, row, summary)
    linear = row.outcome == str(Outcome.ALREADY_LINEAR)
    try:
        _require_unchanged(archive.source, row)
        has_light = linear or shown.curve is not None
        if small is not None and not large and (small.after or not has_light):
            small = small if has_light else Thumbnail(small.before)
            return replace(shown, missing=problem, small=small)
        encoded = _read(_path(archive.source, row), max(SIDE, large), linear=linear)
    except _MissingError as missing:
        return replace(shown, missing=str(missing))
    shown = replace(shown, missing=problem)
    inverse = None if record is None else record.estimate.found
    return with_images(shown, encoded, inverse, linear=linear, large=large)


class _MissingError(Exception):
    """A photo of which there is no picture; the text says why."""


def _with_files(archive: Archive, row: PhotoRow, summary: Summary) -> Pictures:
    """With names of the photo's files below the outputs: LUTs, the EXR if any, the record."""
    folder = PurePosixPath(row.name).parent
    exr = output_name(row.name, EXR)
    exrs = [exr] if (archive.folder / exr).is_file() else []
    luts = (str(folder / each) for each in summary.luts)
    return replace(summary.shown, files=(*luts, *exrs, output_name(row.name, RECORD)))


def _path(source: Path | None, row: PhotoRow) -> Path:
    if source is None:
        raise _MissingError(GONE)
    return source / PurePosixPath(row.name)


def _require_unchanged(source: Path | None, row: PhotoRow) -> None:
    try:
        status = _path(source, row).stat()
    except (OSError, ValueError):
        raise _MissingError(GONE) from None
    if (status.st_size, status.st_mtime_ns) != (row.size, row.mtime_ns):
        raise _MissingError(CHANGED)


def _record_of(folder: Path, row: PhotoRow) -> tuple[Record | None, str]:
    """The photo's record, and what is wrong if it should be there and is not."""
    if not row.curve and row.kind in ("no curve", "unfinished"):
        return None, ""
    try:
        return read_record(folder / PurePosixPath(output_name(row.name, RECORD))), ""
    except FaceCRFError:
        return None, NO_RECORD


def _read(path: Path, side: int, *, linear: bool) -> Pixels:
    """(H, W, 3) values of the file, upright; of a JPEG codes, as few as are shown."""
    try:
        if path.suffix.lower() in _JPEG and not linear:
            return _read_jpeg(path, side)
        return np.asarray(read_photo(path).encoded, np.float32)
    except Exception:  # decoders raise all kinds, and one photo must not cost the report
        raise _MissingError(UNREADABLE) from None


def _read_jpeg(path: Path, side: int) -> npt.NDArray[np.uint8]:
    """Decode only the low frequencies: one to two pixels for each of the longer side, mostly."""
    with unwarned(), Image.open(path) as image:  # whose size the batch has checked
        image.draft(None, (side, side))
        return np.array(ImageOps.exif_transpose(image).convert("RGB"))
