"""The code values of an open picture, all of them or an error in one line."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import complaint
from facecrf_ocio.photo.containers.integrity import COPY_AGAIN
from facecrf_ocio.photo.decoding.picture import MENDED, Picture
from facecrf_ocio.photo.raster.pixels import Pixels, code_values, filled
from facecrf_ocio.photo.tags.header import PHOTOMETRIC
from facecrf_ocio.photo.tags.radiance import has_old_runs

_BAND_ROWS = 32  # [px] read at once: what a processor keeps near, half a MB of 6000 px of width
_WHITE_IS_ZERO = 0  # TIFF 6.0
# As libtiff says it of what it was built without, and of what it does not know.
_UNKNOWN_COMPRESSION = re.compile(r"compression support is not configured|decoding is not impl")
_COMPRESS = "save it with LZW or Deflate compression"
# As libjpeg-turbo says it of whole files of kinds that it does not know, 12 bits above all.
_UNKNOWN_JPEG = re.compile(r"JPEG error: (Unsupported|Sorry|.*not supported)")
_RECODE = "write it anew with Radiance: ra_xyze -r OLD.hdr NEW.hdr"
_ORDINARY = "convert it to a JPEG of 8 bits, to PNG or TIFF"


def is_plain_16_bits(spec: Any, channels: Sequence[int]) -> bool:
    """Whether rows of R, G, B in 16 bits, and nothing else, can be read one after another."""
    rows_of_16_bits = spec.format.basetype == oiio.UINT16 and spec.tile_width == 0
    # Channels one after another in compressed strips cannot be read a part at a time.
    rows_of_16_bits &= spec.get_string_attribute("planarconfig") != "separate"
    return rows_of_16_bits and spec.nchannels == 3 and list(channels) == [0, 1, 2]


def decode_by_bands(path: Path, source: Any, bits: int) -> npt.NDArray[np.float32]:
    """(H, W, 3) encoded values; the code values of 16 bits are never there as a whole.

    Of 24 megapixels they would take 144 MB beside the 288 MB of the result.
    """
    spec = source.spec()
    encoded = np.empty((spec.height, spec.width, 3), np.float32)
    for rows, codes in _bands(path, source, oiio.UINT16):
        encoded[rows] = code_values(codes, bits)
    return encoded


def _bands(path: Path, source: Any, kind: Any) -> Iterator[tuple[slice, Pixels]]:
    """Rows from top to bottom, some at a time, with all of their channels."""
    spec = source.spec()
    for top in range(0, spec.height, _BAND_ROWS):
        end = min(top + _BAND_ROWS, spec.height)
        codes = _require_pixels(path, source, _rows(source, top, end, kind))
        yield slice(top, end), codes.reshape(end - top, spec.width, spec.nchannels)


def _rows(source: Any, top: int, end: int, kind: Any) -> Any:
    """Rows of all channels, or nothing if there is an error."""
    spec = source.spec()

    def read(top: int, end: int) -> Any:
        return source.read_scanlines(spec.y + top, spec.y + end, 0, 0, spec.nchannels, kind)

    rows = read(top, end)
    if rows is not None or source.has_error or end - top == 1 or source.format_name() != "tiff":
        return rows
    # OpenImageIO inflates strips by itself, which knows no reversed bits (FillOrder 2); single rows
    # come by libtiff, which does, and which says what is wrong otherwise.
    single = [read(row, row + 1) for row in range(top, end)]
    return None if any(row is None for row in single) else np.concatenate(single)


def decode(path: Path, picture: Picture) -> Pixels:
    """(H, W, C) of all channels: uint8 or uint16 as in the file, else float32."""
    source, spec = picture.source, picture.spec
    kind = spec.format.basetype if spec.format.basetype in (oiio.UINT8, oiio.UINT16) else oiio.FLOAT
    if kind == oiio.UINT8 and source.format_name() == "jpeg":
        # Read whole, it would be copied into memory that was never touched: half as long again.
        shape = spec.height, spec.width, spec.nchannels
        return filled(np.empty(shape, np.uint8), _bands(path, source, kind))
    read = source.read_image(picture.page, 0, 0, spec.nchannels, kind)
    if read is None and not source.has_error and spec.tile_width == 0:
        read = _rows(source, 0, spec.height, kind)
    codes = _require_pixels(path, source, read)
    if kind != oiio.UINT8 and spec.get_int_attribute(PHOTOMETRIC, -1) == _WHITE_IS_ZERO:
        white = 65535 if kind == oiio.UINT16 else 1
        np.subtract(white, codes, out=codes)  # OpenImageIO does so for 8 bits alone
    return codes.reshape(spec.height, spec.width, spec.nchannels)


def _require_pixels(path: Path, source: Any, codes: Any) -> Pixels:
    """What a decoder gave, if it gave all of it."""
    problem = first_line(complaint(source.geterror), path) if source.has_error else ""
    if _UNKNOWN_COMPRESSION.search(problem):
        raise PhotoError(path, f"is compressed as cannot be undone here ({problem})", _COMPRESS)
    if _UNKNOWN_JPEG.match(problem):
        raise PhotoError(path, f"is a kind of JPEG that is not read here ({problem})", _ORDINARY)
    if problem and source.format_name() == "hdr" and has_old_runs(path.read_bytes()):
        raise PhotoError(path, "has Radiance's old run-length coding, which is not read", _RECODE)
    if problem or codes is None or codes.size == 0:
        raise PhotoError(path, f"is cut short or damaged ({problem or 'no pixels'})", COPY_AGAIN)
    return np.asarray(codes)


def first_line(text: str, path: Path) -> str:
    """First line of a decoder's complaint, without the names of the file and of a mended copy."""
    first = re.sub(
        rf' *\((?:"[^"]*"|{re.escape(str(path))})\)', "", text.strip().partition("\n")[0]
    )
    first = re.sub(rf'(?: for)? *"(?:{re.escape(str(path))}|[^"]*/{MENDED})"', "", first)
    return first.strip(" .")[:160]
