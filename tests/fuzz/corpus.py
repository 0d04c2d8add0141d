"""Sound files to start from, made here: nothing is fetched, and nothing is stored."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
from PIL import Image

sys.path.insert(0, str(Path(__file__).parents[1]))

from maker_note_files import NOTES, exif_with
from photo_files import CURVE, app1, matrix_profile, with_segments, write

from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.archive.manifest.database import Manifest, Stamp
from facecrf_ocio.archive.task import Gathered, Output, Result, Shot
from facecrf_ocio.lut.format_table import FORMATS
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.record.calibration_record import write_record
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Confidence, Estimate, InverseCRF, Outcome, Photo, Verdict

EXIF = {
    "Make": "Acme",
    "Model": "One",
    "Software": "1.0",
    "Artist": "N. N.",
    "Orientation": 6,
    "ExposureTime": 0.01,
    "FNumber": 4.0,
    "Exif__DateTimeOriginal": "2020:06:01 12:00:00",
    "Exif__PhotographicSensitivity": 100,
}
REC709 = ((0.64, 0.33), (0.3, 0.6), (0.15, 0.06), (0.3127, 0.329))


def luts(folder: Path) -> list[Path]:
    """One LUT in each format."""
    few = np.linspace(0.0, 1.0, 33)
    curve = InverseCRF(few, np.stack([np.interp(few, CURVE.encoded, row) for row in CURVE.linear]))
    return [write_lut(curve, folder / f"lut.{name}", overwrite=True) for name in FORMATS]


def profiles(folder: Path) -> list[Path]:
    """ICC profiles of both versions."""
    made = []
    for version in (2, 4):
        path = folder / f"v{version}.icc"
        path.write_bytes(matrix_profile(*REC709, version=version))
        made.append(path)
    return made


def photos(folder: Path) -> list[Path]:
    """Small photos of the formats that cameras and editors write."""
    codes = np.random.default_rng(1).integers(0, 256, (24, 32, 3), np.uint8)
    made = [
        write(folder / f"photo{suffix}", codes, oiio.UINT8, **EXIF)
        for suffix in (".jpg", ".png", ".tif", ".bmp", ".webp", ".tga")
    ]
    deep = codes.astype(np.uint16) * 257
    made.append(write(folder / "deep.tif", deep, oiio.UINT16))
    return [*made, write(folder / "light.exr", codes.astype(np.float32) / 255, oiio.HALF)]


def tagged(folder: Path) -> list[Path]:
    """JPEGs, whose beginnings are EXIF and a profile."""
    codes = np.zeros((8, 8, 3), np.uint8)
    profile = np.frombuffer(matrix_profile(*REC709), np.uint8)
    path = folder / "tags.jpg"
    spec = oiio.ImageSpec(8, 8, 3, oiio.UINT8)
    for name, value in EXIF.items():
        spec.attribute(name.replace("__", ":"), value)
    spec.attribute("ICCProfile", oiio.TypeDesc(f"uint8[{profile.size}]"), profile)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec)
    assert output.write_image(codes)
    output.close()
    return [path, *_with_maker_notes(folder, codes)]


def _with_maker_notes(folder: Path, codes: np.ndarray) -> Iterator[Path]:
    """JPEGs with a maker's notes, of each kind one with a value and one with an array."""
    out = BytesIO()
    Image.fromarray(codes).save(out, "JPEG")
    arrays = {0x4018: (9, (20, 1, 0, 1, 0)), 0x99: (4, (28, 1, 1, 20, 1, 0x204, 1))}
    values = {0x22: (3, (1,)), 0x50F: (8, (0, -1, 1, 1)), 0x1402: (3, (0,)), 0x140B: (3, (200,))}
    for number, make in enumerate(NOTES):
        path = folder / f"notes_{number}.jpg"
        exif = app1(exif_with(make, {**arrays, **values}))
        path.write_bytes(with_segments(out.getvalue(), exif))
        yield path


def records(folder: Path) -> list[Path]:
    """The record of a calibration, with and without a curve."""
    photo = Photo(np.zeros((4, 6, 3), np.float32), path=Path("a.jpg"), sha256="ab" * 32)
    codes = np.linspace(0.0, 1.0, 64)
    sigma = np.tile(0.1 * codes * (1.0 - codes), (3, 1))
    estimate = Estimate(
        Outcome.CALIBRATED,
        "joint",
        "1 photo, 3 cues",
        found=InverseCRF(codes, np.tile(codes**2.2, (3, 1))),
        confidence=Confidence(sigma, np.ones((3, 64)), Verdict.WEAK, ("few",)),
        coefficients=np.ones((3, 5)),
        energy={"E_p": 1.0},
    )
    none = Estimate(Outcome.NOT_CALIBRATED, "joint", "no face", "give one with a face")
    return [
        write_record(folder / f"{name}.crf.json", photo, one, Settings(), overwrite=True)
        for name, one in (("curve", estimate), ("none", none))
    ]


def manifests(folder: Path) -> list[Path]:
    """The manifest of two photos, one of them pooled."""
    place = folder / "manifest"
    place.mkdir(exist_ok=True)
    manifest = Manifest(place)
    output = Output("a.jpg.cube", 5, "ab" * 32, 7)
    told = Gathered('{"messages": {}, "coverage": [], "leaning": 0, "lacking": "", "remedy": ""}')
    camera, shot = ("Acme", "One", "", ""), Shot("", 1.0, 0.1, 4.0, 100.0)
    done = Result("calibrated", "weak", "joint", "why", sha256="ab" * 32, outputs=(output,))
    pooled = Result("", sha256="cd" * 32, camera=camera, shot=shot, gathered=told)
    with manifest.transaction():
        manifest.note("source", "/photos")
        manifest.finish("a.jpg", Stamp(1, 2, "r", 3), done, "f")
        manifest.record_gathered("sub/b.jpg", Stamp(1, 2, "r", 3), pooled, "g")
    manifest.change("PRAGMA journal_mode=DELETE")
    manifest.close()
    return [place / FILE]
