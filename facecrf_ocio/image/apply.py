"""From code values to linear light, by a curve or by any LUT file, and on to a scene-linear EXR."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.errors import OutputError, SettingsError
from facecrf_ocio.files.atomic import require_free
from facecrf_ocio.files.plain_text import complaint
from facecrf_ocio.image.compression import COMPRESSION, require_compression
from facecrf_ocio.image.exr_header import exr_header
from facecrf_ocio.image.lookup import Lookup, curve_lookup
from facecrf_ocio.image.lut_lookup import lut_lookup
from facecrf_ocio.image.output import write_image_file
from facecrf_ocio.image.pixel_types import HALF_MAX
from facecrf_ocio.record.output_names import require_exr_name
from facecrf_ocio.values import InverseCRF, Photo

Float32 = npt.NDArray[np.float32]
Pixels = npt.NDArray[Any]
Rows = Callable[[int, int], Pixels]

BEYOND_HALF = f"light above {HALF_MAX:.0f}, the most half floats hold, is written as that"
"""What is told of an EXR of half floats; one of floats keeps such light."""
_LARGEST_TABLE = 16  # [bit]
_BAND = 256  # [row] a multiple of what OpenEXR compresses as one block


@dataclass(frozen=True, slots=True)
class WrittenExr:
    """An EXR, and what its pixels do not hold of the light that they were made from.

    Attributes
    ----------
    path
        The file.
    notes
        Clauses; none where the light is all there, within the rounding of its type.
    """

    path: Path
    notes: tuple[str, ...] = ()


def linearize_photo(photo: Photo, curve: InverseCRF) -> Float32:
    """Map a photo's code values to relative linear light.

    Parameters
    ----------
    photo
        The photo; one that is scene-linear already is returned as it is.
    curve
        The inverse camera response.

    Returns
    -------
    numpy.ndarray
        (H, W, 3), equal to `curve.linearize(photo.encoded)`.
    """
    return photo.encoded if photo.scene_linear else _whole(photo, curve_lookup(curve))


def apply_lut(photo: Photo, lut: str | Path, direction: str | None = None) -> Float32:
    """Send a photo through a LUT file, as `oiiotool PHOTO --ociofiletransform LUT` does.

    Only an ICC profile goes the other way, toward light; see `lut_lookup.lut_lookup`, also for
    where inverses differ.

    Parameters
    ----------
    photo
        The photo, scene-linear or not.
    lut
        Any file OpenColorIO reads. Values outside of its domain are clamped.
    direction
        `linearize` or `encode`; None refuses LUTs that encode.

    Returns
    -------
    numpy.ndarray
        (H, W, 3) what the LUT makes of the code values.

    Raises
    ------
    LutError
        If the file is missing, is not a LUT, encodes though no direction is given, or makes NaN
        or infinities of codes.
    """
    return _whole(photo, lut_lookup(lut, direction))


def linear_rows(photo: Photo, lookup: Lookup, *, half: bool = True) -> Rows:
    """What a transform makes of a photo, a band of rows at a time, for `write_exr`.

    Parameters
    ----------
    photo
        The photo.
    lookup
        By `lookup.curve_lookup` or `lut_file.lut_lookup`.
    half
        Whether float16 will do; photos with alpha stay float32 until they are multiplied by it.

    Returns
    -------
    Rows
        Gives the rows from `begin` to `end`, (end - begin, W, 3); the next call reuses the memory.
    """
    dtype = np.float16 if half and photo.alpha is None else np.float32
    buffer = np.empty((0, *photo.shape[1:]), dtype)

    def rows(begin: int, end: int) -> Pixels:
        nonlocal buffer
        if len(buffer) < end - begin:
            buffer = np.empty((end - begin, *buffer.shape[1:]), dtype)
        return _look_up(photo, lookup, begin, end, buffer[: end - begin])

    return rows


def write_exr(
    path: str | Path,
    linear: Pixels | Rows,
    photo: Photo,
    *,
    provenance: Mapping[str, str],
    half: bool = True,
    compression: str = COMPRESSION,
    overwrite: bool = False,
    beside: Mapping[str, Rows] | None = None,
) -> WrittenExr:
    """Write linear light as a scene-linear OpenEXR file, whole or not at all.

    Parameters
    ----------
    path
        The file, named .exr.
    linear
        (H, W, 3) relative linear light, float16 or float32; or a function that gives its rows, so
        that a band of them is in memory and no more.
    photo
        Where it comes from: gives alpha (colors are multiplied by it, as OpenEXR has it),
        primaries, and the metadata of its file that still hold.
    provenance
        Written as attributes `facecrf:KEY`.
    half
        16-bit floats, values clamped to 65504, or 32-bit floats.
    compression
        One of `compression.COMPRESSIONS`, of some with a level, such as `zip:1`.
    overwrite
        Replace an existing file. The photo itself is never replaced.
    beside
        Further channels by their names: functions that give rows (end - begin, W).

    Returns
    -------
    WrittenExr
        The file written. Light that half floats do not hold is told where it was given as float32;
        float16 was cut before.

    Raises
    ------
    OutputError
        If it exists and `overwrite` is false, or cannot be written.
    SettingsError
        If pixels are not the photo's, or OpenEXR has no such compression.
    """
    path = Path(path)
    shape = photo.shape
    if not callable(linear) and linear.shape != shape:
        raise SettingsError(f"{linear.shape} pixels do not belong to a {shape} photo")
    require_exr_name(path)
    require_free(path, overwrite=overwrite)
    if photo.path is not None and path.exists() and path.samefile(photo.path):
        raise OutputError(f"{path}: is the photo itself; choose another name")
    names = (*("RGB" if photo.alpha is None else "RGBA"), *(beside or {}))
    kind = oiio.HALF if half else oiio.FLOAT
    header = exr_header(shape[:2], names, photo, provenance, kind)
    header.attribute("compression", require_compression(compression))
    rows = linear if callable(linear) else _rows_of(linear)
    cut = False

    def finished(begin: int, end: int) -> Pixels:
        nonlocal cut
        color = _finished(rows(begin, end), photo, begin, end)
        if half and color.dtype != np.float16:
            cut = cut or bool((color > HALF_MAX).any())
            color = np.clip(color, -HALF_MAX, HALF_MAX)
        more = [channel(begin, end)[..., None] for channel in (beside or {}).values()]
        return np.concatenate([color, *more], axis=2, dtype=color.dtype) if more else color

    written = write_image_file(path, partial(_write_bands, header, finished), overwrite=overwrite)
    return WrittenExr(written, (BEYOND_HALF,) if cut else ())


def _whole(photo: Photo, lookup: Lookup) -> Float32:
    result = np.empty(photo.shape, np.float32)
    for begin in range(0, len(result), _BAND):
        end = min(begin + _BAND, len(result))
        _look_up(photo, lookup, begin, end, result[begin:end])
    return result


def _look_up(photo: Photo, lookup: Lookup, begin: int, end: int, out: Pixels) -> Pixels:
    """Send rows through a transform, as integer codes where that is what they were.

    Photos with alpha may hold values between codes, where their file had them multiplied by it.
    """
    bits = photo.bit_depth
    if photo.codes is not None and not photo.scene_linear:
        return lookup.apply(photo.codes[begin:end], out=out)
    band = photo.encoded[begin:end]
    if bits is None or bits > _LARGEST_TABLE or photo.alpha is not None or photo.scene_linear:
        return lookup.apply(band, out=out)
    if bits == 8:
        return lookup.apply(cv2.convertScaleAbs(band, alpha=255), out=out)
    maximum = 2**bits - 1
    codes = np.rint(band * np.float32(maximum)).astype(np.uint16)
    return lookup.apply(codes, out=out, maximum=maximum)


def _rows_of(linear: Pixels) -> Rows:
    return lambda begin, end: linear[begin:end]


def _finished(linear: Pixels, photo: Photo, begin: int, end: int) -> Pixels:
    """Rows (H, W, 3) as they go into the file: multiplied by alpha, which comes fourth."""
    if photo.alpha is not None:
        alpha = photo.alpha[begin:end, :, None]
        linear = np.concatenate([linear * alpha, alpha], axis=2, dtype=np.float32)
    return np.ascontiguousarray(linear)


def _write_bands(header: oiio.ImageSpec, rows: Rows, path: Path) -> str:
    """Write an EXR file over an empty one; what OpenImageIO says if it cannot."""
    output: Any = oiio.ImageOutput.create("openexr")
    written = output.open(str(path), header)
    try:
        for begin in range(0, header.height, _BAND):
            end = min(begin + _BAND, header.height)
            first, last = header.y + begin, header.y + end
            written = written and output.write_scanlines(first, last, 0, rows(begin, end))
    finally:
        written = output.close() and written
    return "" if written else complaint(output.geterror) or "no reason given"
