"""Reading, estimating and writing a LUT in a process that is warm, beside decoding alone."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.benchmark.speed.race import Call, race
from facecrf_ocio.benchmark.speed.speed_row import SpeedRow, in_ratio
from facecrf_ocio.benchmark.speed.subjects import portrait
from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.photo.read import read_photo

# [megapixel] and the ratio to decoding that is wanted.
_SIZES = ((12.0, 2.5), (24.0, 2.0))


def calibrate_rows(folder: Path, scale: float, repeat: int) -> Iterator[SpeedRow]:
    """`read_photo`, `calibrate` and one LUT, against OpenImageIO's decode of the same JPEG."""
    for megapixels, wanted in _SIZES:
        photo = portrait(folder / f"close{megapixels:.0f}.jpg", megapixels * scale, close=True)
        lut = folder / "speed.spi1d"

        def whole(photo: Path = photo, lut: Path = lut) -> None:
            write_lut(calibrate(read_photo(photo)).curve, lut, overwrite=True)

        whole()  # networks and tables are there from now on
        calls: dict[str, Call] = {"this package": whole, "OpenImageIO": partial(decode, photo)}
        ours, floor = race("calibrate", calls, megapixels * scale, repeat)
        work = f"read + calibrate + LUT, {megapixels * scale:g} MP JPEG, against its decode"
        yield in_ratio(f"calibrate_{megapixels:.0f}mp", work, ours, floor, wanted)


def decode(photo: Path) -> None:
    """What nobody can do without: the code values, by OpenImageIO."""
    source: Any = oiio.ImageInput.open(str(photo))
    source.read_image(0, 0, 0, 3, oiio.UINT8)
    source.close()
