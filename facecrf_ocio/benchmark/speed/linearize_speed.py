"""How fast pixels are linearized, beside OpenColorIO's and OpenImageIO's own calls, in one run."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.benchmark.speed.race import Call, Timed, race
from facecrf_ocio.files.threads import usable_cores
from facecrf_ocio.image.apply import linear_rows, write_exr
from facecrf_ocio.image.lookup import Lookup
from facecrf_ocio.image.lut_lookup import described, lut_lookup, lut_processor
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.values import Photo

Pixels = npt.NDArray[Any]

PAIRS = (
    (np.uint8, np.float32),
    (np.uint8, np.float16),
    (np.uint16, np.float32),
    (np.uint16, np.float16),
    (np.float16, np.float16),
    (np.float32, np.float32),
    (np.float32, np.float16),
)
COMPRESSIONS = ("none", "zip")
_LOSSLESS = ocio.OptimizationFlags.OPTIMIZATION_LOSSLESS
_OIIO = {"uint8": oiio.UINT8, "uint16": oiio.UINT16, "float16": oiio.HALF, "float32": oiio.FLOAT}
_OCIO = {
    "uint8": ocio.BIT_DEPTH_UINT8,
    "uint16": ocio.BIT_DEPTH_UINT16,
    "float16": ocio.BIT_DEPTH_F16,
    "float32": ocio.BIT_DEPTH_F32,
}


@dataclass(frozen=True, slots=True)
class Speed:
    """What `measure_speed` found.

    Attributes
    ----------
    timed
        All calls.
    megapixels
        Of the picture.
    error
        The largest difference between the lookup and OpenColorIO, of white, in float32.
    """

    timed: tuple[Timed, ...]
    megapixels: float
    error: float

    @property
    def text(self) -> str:
        """The table that is printed."""
        lines = [
            f"{self.megapixels:.1f} megapixels, {usable_cores()} cores, "
            f"OpenColorIO {ocio.__version__}, OpenImageIO {oiio.VERSION_STRING}; "
            "best of several runs",
            f"largest difference from OpenColorIO: {self.error:.2g} of white",
            "",
            f"{'work':<25} {'by':<33} {'MP/s':>7} {'seconds':>8} {'CPU':>8} "
            f"{'/ first':>8} {'(CPU)':>7}",
        ]
        first: dict[str, Timed] = {}
        for item in self.timed:
            ours = first.setdefault(item.work, item)
            wall, cpu = item.seconds / ours.seconds, item.cpu / max(ours.cpu, 1e-9)
            lines.append(
                f"{item.work:<25} {item.by:<33} {item.rate:>7.1f} {item.seconds:>8.3f} "
                f"{item.cpu:>8.3f} {wall:>8.2f} {cpu:>7.2f}"
            )
        return "\n".join(lines)


def measure_speed(lut: Path, megapixels: float, repeat: int) -> Speed:
    """Time a LUT file's application to a picture.

    Parameters
    ----------
    lut
        Any that OpenColorIO reads.
    megapixels
        Of the generated picture.
    repeat
        Rounds; in each, every call is made once, so that a busy machine hits all alike.
    """
    codes = shades(megapixels)
    size = codes.shape[0] * codes.shape[1] / 1e6
    lookup = lut_lookup(lut)
    timed: list[Timed] = []
    for given, made in PAIRS:
        source = as_type(codes, given)
        work = f"{source.dtype} to {np.dtype(made)}"
        timed += race(work, _transforms(source, made, lookup, lut), size, repeat)
    with TemporaryDirectory(prefix="facecrf-") as folder:
        for compression in COMPRESSIONS:
            work = f"JPEG to half EXR, {compression}"
            timed += race(work, exr_calls(codes, lookup, compression, Path(folder)), size, repeat)
    return Speed(tuple(timed), size, _largest_error(codes[:256], lookup, lut))


def shades(megapixels: float) -> Pixels:
    """(H, W, 3) uint8 of smooth shades and some noise, which compresses as photos do."""
    width = round((megapixels * 1e6 * 1.5) ** 0.5)
    height = max(1, round(megapixels * 1e6 / width))
    x, y = np.linspace(0, 9, width)[None, :, None], np.linspace(0, 6, height)[:, None, None]
    wave = np.sin(x + np.arange(3)).astype(np.float32) * np.cos(y).astype(np.float32)
    noise = np.random.default_rng(0).integers(-4, 5, (height, width, 1), np.int8)
    wave *= 100
    wave += 128
    wave += noise
    return wave.astype(np.uint8)


def as_type(codes: Pixels, dtype: Any) -> Pixels:
    """8-bit codes as code values of another type."""
    if dtype is np.uint16:
        return codes.astype(np.uint16) * np.uint16(257)
    return codes if dtype is np.uint8 else (codes / np.float32(255)).astype(dtype)


def _transforms(source: Pixels, made: Any, lookup: Lookup, lut: Path) -> dict[str, Call]:
    result = np.empty(source.shape, made)
    height, width, _ = source.shape
    image = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, _OIIO[str(source.dtype)]))
    image.set_pixels(oiio.ROI(), source)
    target = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, _OIIO[str(np.dtype(made))]))
    calls: dict[str, Call] = {
        "this package": lambda: lookup.apply(source, dtype=made),
        "the same, into a reused buffer": lambda: lookup.apply(source, out=result),
        "OpenColorIO, packed": packed(source, result, lut),
    }
    if source.dtype == np.float32 and made is np.float32:
        cpu = lut_processor(lut).getOptimizedCPUProcessor(_LOSSLESS)
        spent = source.copy()
        calls["OpenColorIO, applyRGB"] = lambda: cpu.applyRGB(spent)
    calls["OpenImageIO, ociofiletransform"] = lambda: oiio.ImageBufAlgo.ociofiletransform(
        target, image, str(lut)
    )
    return calls


def packed(source: Pixels, result: Pixels, lut: Path) -> Call:
    """OpenColorIO's own call for whole pictures, from one buffer into another."""
    given, made = _OCIO[str(source.dtype)], _OCIO[str(result.dtype)]
    cpu = lut_processor(lut).getOptimizedCPUProcessor(given, made, _LOSSLESS)
    return lambda: cpu.apply(described(source, given), described(result, made))


def exr_calls(codes: Pixels, lookup: Lookup, compression: str, folder: Path) -> dict[str, Call]:
    """Ways from a JPEG, which is written first, to a half EXR; the floor at OpenEXR's level."""
    photo, target = folder / "photo.jpg", folder / "linear.exr"
    height, width, _ = codes.shape
    _write(photo, oiio.ImageSpec(width, height, 3, oiio.UINT8), codes)
    half = lookup.apply(codes, dtype=np.float16)
    header = oiio.ImageSpec(width, height, 3, oiio.HALF)
    header.attribute("compression", compression.partition(":")[0])

    known = read_photo(photo)

    def apply(source: Photo) -> None:
        rows = linear_rows(source, lookup)
        write_exr(target, rows, source, provenance={}, compression=compression, overwrite=True)

    def decode() -> None:
        source: Any = oiio.ImageInput.open(str(photo))
        source.read_image(0, 0, 0, 3, oiio.UINT8)
        source.close()

    def decode_and_apply() -> None:
        decode()
        apply(known)

    def floor(*, flushed: bool) -> None:
        decode()
        _write(target, header, half)
        if flushed:
            with target.open("rb+") as file:
                os.fsync(file.fileno())

    return {
        "read_photo + apply + write": lambda: apply(read_photo(photo)),
        "decode + this package's apply": decode_and_apply,
        "decode + write": lambda: floor(flushed=False),
        "decode + write + flush to disk": lambda: floor(flushed=True),
    }


def _write(path: Path, header: oiio.ImageSpec, pixels: Pixels) -> None:
    output: Any = oiio.ImageOutput.create(str(path))
    output.open(str(path), header)
    output.write_image(pixels)
    output.close()


def _largest_error(codes: Pixels, lookup: Lookup, lut: Path) -> float:
    worst = 0.0
    for dtype in (np.uint8, np.uint16, np.float16, np.float32):
        source = as_type(codes, dtype)
        values = source.astype(np.float32)
        if source.dtype.kind == "u":
            values /= np.float32(np.iinfo(source.dtype).max)
        expected = np.empty_like(values)
        packed(values, expected, lut)()
        worst = max(worst, float(np.abs(lookup.apply(source) - expected).max()))
    return worst
