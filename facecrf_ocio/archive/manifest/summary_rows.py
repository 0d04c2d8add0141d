"""Summaries of records in the manifest: given to a report while the record is as it was written."""

from __future__ import annotations

import hashlib
import os
import stat
from pathlib import Path

from facecrf_ocio.archive.manifest.database import Manifest
from facecrf_ocio.archive.manifest.keys import key_of
from facecrf_ocio.archive.manifest.read_only import Reader
from facecrf_ocio.archive.manifest.thumbnail_rows import keep_thumbnail
from facecrf_ocio.archive.task import Output, Result
from facecrf_ocio.errors import OutputError
from facecrf_ocio.files.content import sha256_of
from facecrf_ocio.record.output_names import RECORD, output_name


def keep_for_report(manifest: Manifest, name: str, result: Result) -> None:
    """Record the thumbnail and the summary of a photo that was looked at, within a transaction."""
    keep_thumbnail(manifest, name, result)
    record = output_name(name, RECORD)
    written = next((one for one in result.outputs if one.name == record), None)
    if written is not None and result.summary:
        manifest.change(
            "INSERT OR REPLACE INTO summaries VALUES (?, ?, ?)",
            *(key_of(name), _digest(written.sha256, result.summary), result.summary),
        )


def summary_text_in(manifest: Reader, name: str, folder: Path) -> str:
    """What is to be told of a photo's record; empty if it is not known, or not this record's."""
    record = manifest.output(output_name(name, RECORD))
    digest, text = manifest.summary(name) or ("", "")
    if record is None or not isinstance(text, str) or not text:
        return ""
    if digest != _digest(record.sha256, text):
        return ""
    return text if _is_as_written(record, folder) else ""


def _is_as_written(record: Output, folder: Path) -> bool:
    """By size and time; by its bytes where the time is another, as that of a copy."""
    try:
        path = os.path.join(folder, record.name)  # noqa: PTH118 - of ten thousand, and no Path
        status = os.lstat(path)
        if not stat.S_ISREG(status.st_mode) or status.st_size != record.size:
            return False
        return status.st_mtime_ns == record.written_ns or sha256_of(Path(path)) == record.sha256
    except (OSError, OutputError):
        return False


def _digest(sha256: str, text: str) -> str:
    """Hash of a record's hash and its summary."""
    return hashlib.sha256(f"{sha256} {text}".encode("utf-8", "surrogatepass")).hexdigest()
