"""Pixels from numpy into an ImageBuf.

`ImageBuf.set_pixels`, and the constructor that takes an array, go sample by sample; what copies in
blocks is reading an uncompressed TIFF and copying between ImageBufs. So where the system has files
in memory, pixels are made behind the header of one, a band of rows at a time, and OpenImageIO
reads the band from there.
"""

from __future__ import annotations

import mmap
import os
import struct
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.files.threads import usable_cores

Pixels = npt.NDArray[Any]

_BAND = 1 << 19  # [pixel] of 2^17 to 2^21 the fastest, or nearly
_SMALLEST = 1 << 14  # [pixel] below it, opening a file takes longer than it saves
_LARGEST = 1 << 28  # [byte] of a band of one row; far below what a TIFF can hold
_DTYPES = {
    oiio.UINT8: np.uint8,
    oiio.UINT16: np.uint16,
    oiio.HALF: np.float16,
    oiio.FLOAT: np.float32,
}


def store(image: oiio.ImageBuf, region: oiio.ROI, make: Callable[[oiio.ROI, Pixels], None]) -> None:
    """Let `make` give the pixels of a region of an image, on all cores.

    Parameters
    ----------
    image
        Of uint8, uint16, half or float pixels.
    region
        Within the image, with all its channels.
    make
        Called with a band of the region, one slice deep, and (H, W, C) of the image's type to be
        filled; from several threads at once.

    Raises
    ------
    MemoryError
        If OpenImageIO cannot take the pixels.
    """
    dtype = np.dtype(_DTYPES[image.spec().format.basetype])
    bands = _bands(region)
    workers = min(usable_cores(), len(bands))
    with ThreadPoolExecutor(workers) as threads:
        shares = [bands[first::workers] for first in range(workers)]
        for done in [threads.submit(_store, image, share, dtype, make) for share in shares]:
            done.result()


def can_store(image: oiio.ImageBuf) -> bool:
    """Whether `store` knows the type of an image's pixels."""
    return image.spec().format.basetype in _DTYPES


def _store(
    image: oiio.ImageBuf,
    bands: Sequence[oiio.ROI],
    dtype: np.dtype[Any],
    make: Callable[[oiio.ROI, Pixels], None],
) -> None:
    files: dict[int, _TiffInMemory | None] = {}
    with ExitStack() as opened:
        for band in bands:
            shape = (band.height, band.width, band.nchannels)
            if band.height not in files:
                files[band.height] = _file_for(shape, dtype, opened)
            file = files[band.height]
            if file is None:
                pixels = np.empty(shape, dtype)
                make(band, pixels)
                _require(image.set_pixels(band, pixels), image)
                continue
            make(band, file.pixels)
            part = file.read()
            part.set_origin(band.xbegin, band.ybegin, band.zbegin)
            _require(oiio.ImageBufAlgo.copy(image, part, roi=band, nthreads=1), image)


def _file_for(
    shape: tuple[int, int, int], dtype: np.dtype[Any], opened: ExitStack
) -> _TiffInMemory | None:
    """A file for a band, closed with `opened`; None where there can be none."""
    height, width, channels = shape
    fits = height * width >= _SMALLEST and height * width * channels * dtype.itemsize <= _LARGEST
    # A cache would remember by name what another file, of the same number, held before.
    cached = oiio.get_int_attribute("imagebuf:use_imagecache", 0)
    if not fits or cached or not has_files_in_memory():
        return None
    try:
        return opened.enter_context(_TiffInMemory(shape, dtype))
    except OSError:  # a limit on open files, or on the size of files
        return None


def _require(done: bool, image: oiio.ImageBuf) -> None:
    if not done:
        raise MemoryError(image.geterror().strip().partition("\n")[0])


def _bands(region: oiio.ROI) -> list[oiio.ROI]:
    rows = max(1, min(_BAND // region.width, -(-region.height // usable_cores())))
    return [
        oiio.ROI(
            region.xbegin,
            region.xend,
            y,
            min(y + rows, region.yend),
            z,
            z + 1,
            region.chbegin,
            region.chend,
        )
        for z in range(region.zbegin, region.zend)
        for y in range(region.ybegin, region.yend, rows)
    ]


@cache
def has_files_in_memory() -> bool:
    """Whether this system has files without a folder that can be opened by a name (Linux does)."""
    if not hasattr(os, "memfd_create") or sys.byteorder != "little":
        return False
    try:
        with _TiffInMemory((1, 1, 1), np.dtype(np.uint8)) as file:
            file.pixels[...] = 7
            return bool(file.read().get_pixels(oiio.UINT8).ravel().tolist() == [7])
    except (MemoryError, OSError):
        return False


class _TiffInMemory:
    """An uncompressed TIFF whose pixels, (H, W, C), can be written to at any time."""

    def __init__(self, shape: tuple[int, int, int], dtype: np.dtype[Any]) -> None:
        size = int(np.prod(shape)) * dtype.itemsize
        header = _tiff_header(shape, dtype, size)
        self._file = os.memfd_create("facecrf")
        try:
            os.ftruncate(self._file, len(header) + size)
            content = mmap.mmap(self._file, len(header) + size)
        except BaseException:
            os.close(self._file)
            raise
        content[: len(header)] = header
        # The array keeps the mapping for as long as anyone holds on to it.
        self.pixels: Pixels = np.frombuffer(content, dtype, offset=len(header)).reshape(shape)
        self._type = next(kind for kind, known in _DTYPES.items() if known == dtype)

    def __enter__(self) -> _TiffInMemory:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        os.close(self._file)

    def read(self) -> oiio.ImageBuf:
        """What the pixels are now, in memory of OpenImageIO's own."""
        image = oiio.ImageBuf(str(Path("/proc/self/fd", str(self._file))))
        _require(image.read(0, 0, True, self._type), image)
        return image


def _tiff_header(shape: tuple[int, int, int], dtype: np.dtype[Any], size: int) -> bytes:
    """All of a little-endian TIFF 6.0 before its pixels, which are a single strip of `size` bytes.

    The channels are one gray and others without a meaning, so that none is taken for alpha.
    """
    height, width, channels = shape
    integer, real, short, long = 1, 3, "H", "I"
    fields: list[tuple[int, str, list[int]]] = [
        (256, long, [width]),
        (257, long, [height]),
        (258, short, [8 * dtype.itemsize] * channels),
        (259, short, [1]),  # not compressed
        (262, short, [1]),  # black is zero
        (273, long, [0]),  # where the strip begins, filled in below
        (277, short, [channels]),
        (278, long, [height]),  # rows of a strip
        (279, long, [size]),
        (284, short, [1]),  # channels of a pixel stand together
        (339, short, [real if dtype.kind == "f" else integer] * channels),
    ]
    if channels > 1:
        fields.insert(-1, (338, short, [0] * (channels - 1)))
    after = 8 + 2 + 12 * len(fields) + 4
    beyond = sum(_padded(len(v) * struct.calcsize(kind)) for _, kind, v in fields)
    start = -(-(after + beyond) // 64) * 64
    directory, long_values = struct.pack("<H", len(fields)), b""
    for tag, kind, values in fields:
        value = struct.pack(f"<{len(values)}{kind}", *([start] if tag == 273 else values))
        if len(value) > 4:
            place = struct.pack("<I", after + len(long_values))
            long_values += value.ljust(_padded(len(value)), b"\0")
            value = place
        directory += struct.pack("<HHI", tag, {short: 3, long: 4}[kind], len(values))
        directory += value.ljust(4, b"\0")
    head = b"II" + struct.pack("<HI", 42, 8) + directory + struct.pack("<I", 0) + long_values
    return head.ljust(start, b"\0")


def _padded(length: int) -> int:
    return 0 if length <= 4 else length + length % 2
