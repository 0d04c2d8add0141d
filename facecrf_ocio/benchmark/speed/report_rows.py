"""The page of an archive: what a photo of it costs, against making its thumbnail."""

from __future__ import annotations

import os
from collections.abc import Iterator
from hashlib import sha256
from io import BytesIO
from pathlib import Path

from PIL import Image

from facecrf_ocio.archive.manifest.database import Manifest, Stamp
from facecrf_ocio.archive.manifest.summary_rows import keep_for_report
from facecrf_ocio.archive.report import write_report
from facecrf_ocio.archive.report.record_summary import summary_of
from facecrf_ocio.archive.report.write_report import LARGE
from facecrf_ocio.archive.task import Output, Result
from facecrf_ocio.archive.thumbnail import EFFORT, QUALITY, SIDE, thumbnail_of
from facecrf_ocio.benchmark.speed.race import race
from facecrf_ocio.benchmark.speed.speed_row import SpeedRow
from facecrf_ocio.benchmark.speed.subjects import portrait
from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.files.threads import usable_cores
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.record.output_names import RECORD, output_name
from facecrf_ocio.record.outputs import write_outputs
from facecrf_ocio.settings import Settings

_WANTED = 30.0  # [s] of 10,000 photos
_ALL = 10_000  # photos, of which large archives are told
_PHOTOS = 160  # of which the time is measured


def report_rows(folder: Path, scale: float, repeat: int) -> Iterator[SpeedRow]:
    """`facecrf report` on photos of 7.7 megapixels, on all cores, for 10,000 of them."""
    count = max(4, round(_PHOTOS * min(scale, 1.0)))
    photos, outputs = folder / "photos", folder / "luts"
    photo = _archive(photos, outputs, count, 7.7 * scale)

    def whole() -> None:
        large = round(LARGE * count / _ALL)
        write_report(outputs, limit=count, large=large, jobs=usable_cores(), overwrite=True)

    (ours,) = race("report", {"this package": whole}, 7.7 * scale, max(1, repeat // 2))
    (floor,) = race("thumbnail", {"Pillow": lambda: _thumbnail(photo)}, 7.7 * scale, repeat)
    share = _ALL / count
    at_best = floor.seconds * _ALL / usable_cores()
    yield SpeedRow(
        "report",
        f"report of 10,000 photos, by {count} of {7.7 * scale:g} MP",
        f"{ours.seconds * share:.0f} s ({ours.cpu * share:.0f} of CPU)",
        f"{at_best:.0f} s ({floor.cpu * _ALL:.0f} of CPU)",
        ours.seconds * share,
        ours.seconds * share / at_best,
        ours.cpu * share / (floor.cpu * _ALL),
        _WANTED,
    )


def _archive(photos: Path, outputs: Path, count: int, megapixels: float) -> Path:
    """What a batch leaves of one photo under many names."""
    photos.mkdir()
    first = portrait(photos / "0.jpg", megapixels)
    read = read_photo(first)
    estimate = calibrate(read)
    written = write_outputs(read, estimate, Settings(), outputs)
    summary = summary_of(estimate, tuple(path.name for path in written[:-1]))
    record = outputs / output_name(first.name, RECORD)
    content, written_ns = record.read_bytes(), record.stat().st_mtime_ns
    of_record = len(content), sha256(content).hexdigest(), written_ns
    thumbnail = thumbnail_of(read, estimate)
    status, digest = first.stat(), sha256(first.read_bytes()).hexdigest()
    manifest = Manifest(outputs)
    manifest.note("source", str(photos))
    with manifest.transaction():
        for number in range(count):
            name = f"{number}.jpg"
            own = output_name(name, RECORD)
            if number:
                os.link(first, photos / name)
                os.link(record, outputs / own)
            told = Result(
                *("calibrated", "weak", "joint", estimate.reason),
                sha256=digest,
                outputs=(Output(own, *of_record),),
                thumbnail=thumbnail,
                summary=summary,
            )
            stamp = Stamp(status.st_size, status.st_mtime_ns, "recipe")
            manifest.finish(name, stamp, told)
            keep_for_report(manifest, name, told)
    manifest.close()
    return first


def _thumbnail(photo: Path) -> None:
    with Image.open(photo) as image:
        image.draft(None, (2 * SIDE, 2 * SIDE))
        image.thumbnail((SIDE, SIDE), Image.Resampling.BOX)
        image.save(BytesIO(), "WEBP", quality=QUALITY, method=EFFORT)
