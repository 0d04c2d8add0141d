"""The small pictures of one photo: as encoded, and linearized; and its curve."""

from __future__ import annotations

import base64
import warnings
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path, PurePosixPath

import cv2
import numpy as np
import numpy.typing as npt
from PIL import Image, ImageOps

from facecrf_ocio.archive.report.contents import Archive, Row
from facecrf_ocio.archive.report.small_curves import DrawnCurve, drawn
from facecrf_ocio.color.srgb import encode_srgb
from facecrf_ocio.errors import FaceCRFError
from facecrf_ocio.image.lookup import curve_lookup
from facecrf_ocio.photo.pixels import Pixels, code_values
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.record.sidecar import SUFFIX, Sidecar, read_sidecar
from facecrf_ocio.values import Outcome

SIDE = 96
"""[pixel] Longer side of a thumbnail."""

QUALITY = 60
"""Of WebP: at this size a better one cannot be told apart on a screen."""

GONE = "The photo is no longer there."
CHANGED = "The photo has changed since it was calibrated."
UNREADABLE = "The photo cannot be read any more."
NO_RECORD = "The record of its calibration is missing or damaged."
NOT_OPENED = "Not opened again, since it could not be read before."

_JPEG = (".jpg", ".jpeg", ".jpe")


@dataclass(frozen=True, slots=True)
class Pictures:
    """What is shown of a photo.

    Attributes
    ----------
    before, after
        Base64 of WebP; empty where there is none.
    missing
        Why a picture is missing; empty if none is.
    curve
        The curve, if there is one.
    faces
        Number of faces used.
    expected
        [stop] Expected error over codes 64 to 235, and in the shadows; None where it is not known.
    """

    before: str = ""
    after: str = ""
    missing: str = ""
    curve: DrawnCurve | None = None
    faces: int = 0
    expected: tuple[float, float] | None = None


def pictures_of(archive: Archive, row: Row) -> Pictures:
    """Read a photo, without changing it, and its sidecar, and make its small pictures.

    Nothing that is wrong with the photo is an error here. A photo that failed is not opened, for
    it may have crashed or hung its decoder.
    """
    if row.kind == "failed":
        return Pictures(missing=NOT_OPENED)
    sidecar, problem = _sidecar(archive.folder, row)
    curve, expected = _curve_of(sidecar)
    faces = 0 if sidecar is None else len(sidecar.estimate.faces)
    inverse = None if sidecar is None else sidecar.estimate.found
    linear = row.outcome == str(Outcome.ALREADY_LINEAR)
    try:
        _require_unchanged(archive.source, row)
        encoded = _read(_path(archive.source, row), linear=linear)
    except _MissingError as missing:
        return Pictures(missing=str(missing), curve=curve, faces=faces, expected=expected)
    light = encoded if linear else None
    if inverse is not None and light is None:
        light = curve_lookup(inverse).apply(_shrunk(encoded, 2 * SIDE))
    after = "" if light is None else _webp(encode_srgb(_shrunk(light, SIDE)).astype(np.float32))
    before = after if linear else _webp(encoded)
    return Pictures(before, after, problem, curve, faces, expected)


def _curve_of(sidecar: Sidecar | None) -> tuple[DrawnCurve | None, tuple[float, float] | None]:
    """The curve with its band, and its expected errors in stops."""
    estimate = None if sidecar is None else sidecar.estimate
    if estimate is None or estimate.found is None or estimate.confidence is None:
        return None, None
    told = estimate.confidence.in_stops
    expected = None if told is None else (told.mid, told.shadows)
    return drawn(estimate.found, estimate.confidence.sigma, told), expected


class _MissingError(Exception):
    """A photo of which there is no picture; the text says why."""


def _path(source: Path | None, row: Row) -> Path:
    if source is None:
        raise _MissingError(GONE)
    return source / PurePosixPath(row.name)


def _require_unchanged(source: Path | None, row: Row) -> None:
    try:
        status = _path(source, row).stat()
    except (OSError, ValueError):
        raise _MissingError(GONE) from None
    if (status.st_size, status.st_mtime_ns) != (row.size, row.mtime_ns):
        raise _MissingError(CHANGED)


def _sidecar(folder: Path, row: Row) -> tuple[Sidecar | None, str]:
    """The photo's record, and what is wrong if it should be there and is not."""
    if not row.curve and row.kind in ("no curve", "unfinished"):
        return None, ""
    try:
        return read_sidecar(folder / PurePosixPath(row.name + SUFFIX)), ""
    except FaceCRFError:
        return None, NO_RECORD


def _read(path: Path, *, linear: bool) -> Pixels:
    """(H, W, 3) values of the file, upright; of a JPEG codes, no more than twice what is shown."""
    try:
        if path.suffix.lower() in _JPEG and not linear:
            return _read_jpeg(path)
        return np.asarray(read_photo(path).encoded, np.float32)
    except Exception:  # decoders raise all kinds, and one photo must not cost the report
        raise _MissingError(UNREADABLE) from None


def _read_jpeg(path: Path) -> npt.NDArray[np.uint8]:
    """Decode only the low frequencies, many times as fast as the whole."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of damaged metadata; its size the batch has checked
        with Image.open(path) as image:
            image.draft(None, (2 * SIDE, 2 * SIDE))
            image.thumbnail((2 * SIDE, 2 * SIDE), Image.Resampling.BOX)
            return np.array(ImageOps.exif_transpose(image).convert("RGB"))


def _shrunk(image: Pixels, side: int) -> Pixels:
    """Average over areas until the longer side is `side`; a smaller image stays as it is."""
    height, width = image.shape[:2]
    scale = side / max(height, width)
    if scale >= 1.0:
        return image
    size = (max(round(width * scale), 1), max(round(height * scale), 1))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), image.dtype)


def _webp(encoded: Pixels) -> str:
    values = code_values(encoded, 8) if encoded.dtype == np.uint8 else encoded
    codes = np.rint(255.0 * np.clip(_shrunk(values, SIDE), 0.0, 1.0)).astype(np.uint8)
    content = BytesIO()
    Image.fromarray(codes).save(content, "WEBP", quality=QUALITY, method=4)
    return base64.b64encode(content.getvalue()).decode()
