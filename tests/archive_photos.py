"""Small archives of rendered faces with EXIF, and what a batch made of them."""

from __future__ import annotations

import sqlite3
from functools import cache
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
from photo_files import write

from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.synthetic import SyntheticSpec, encode, gamma_curve, render_face

GAMMA = gamma_curve(2.2)
ONE = {"Make": "Acme", "Model": "One"}


@cache
def linear_face(seed: int):
    return render_face(SyntheticSpec(seed=seed, height=300, width=260, face_width=150.0)).linear


def write_face(path: Path, seed: int, curve=GAMMA, gain: float = 1.0, **said) -> Path:
    """A JPEG of a rendered face; `said` are attributes, `__` standing for `:`."""
    return write_picture(path, linear_face(seed) * np.float32(gain), curve, **said)


def write_picture(path: Path, linear, curve=GAMMA, **said) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    codes = np.rint(encode(np.clip(linear, 0, 1), curve) * 255).astype(np.uint8)
    return write(path, codes, oiio.UINT8, **{"CompressionQuality": 95, **said})


def exposed(second: int, stop: float):
    """EXIF of an exposure of so many stops, so many seconds after noon."""
    return {
        "Exif__DateTimeOriginal": f"2020:06:01 12:00:{second:02d}",
        "ExposureTime": 0.01 * 2.0**stop,
        "FNumber": 4.0,
        "Exif__PhotographicSensitivity": 100,
    }


def table(folder: Path, query: str):
    base = sqlite3.connect(folder / FILE)
    try:
        return base.execute(query).fetchall()
    finally:
        base.close()


def everything(folder: Path):
    """All that must not depend on how often a run was broken off: tables without times."""
    durations = {"read_s", "estimate_s", "write_s", "written_ns"}
    found = {}
    for name in ("photos", "evidence", "cameras", "brackets", "merges", "outputs"):
        columns = [row[1] for row in table(folder, f"PRAGMA table_info({name})")]
        kept = ", ".join(column for column in columns if column not in durations)
        found[name] = table(folder, f"SELECT {kept} FROM {name} ORDER BY 1")  # noqa: S608
    return found


def files(folder: Path):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and not path.name.startswith("facecrf-manifest.")
    }
