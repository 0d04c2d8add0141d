"""What a record tells of the photo that it is of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from facecrf_ocio.values import Camera, Photo, Primaries


@dataclass(frozen=True, slots=True)
class Source:
    """The photo a calibration was made from; `name` and `sha256` are None for one in memory.

    `gain_map` names the standard of the map that the file has, if any.
    """

    name: str | None
    sha256: str | None
    width: int
    height: int
    bit_depth: int | None
    scene_linear: bool
    grayscale: bool
    camera: Camera
    primaries: Primaries | None
    notes: tuple[str, ...] = ()
    named_curve: str = ""
    edits: tuple[str, ...] = ()
    gain_map: str | None = None
    adapted: tuple[str, ...] = ()


def source_of(photo: Photo) -> Source:
    """What a record tells of a photo."""
    height, width, _ = photo.shape
    return Source(
        name=None if photo.path is None else photo.path.name,
        sha256=photo.sha256,
        width=width,
        height=height,
        bit_depth=photo.bit_depth,
        scene_linear=photo.scene_linear,
        grayscale=photo.grayscale,
        camera=photo.camera,
        primaries=photo.primaries,
        notes=photo.notes,
        named_curve=photo.named_curve,
        edits=photo.edits,
        gain_map=None if photo.gain_map is None else photo.gain_map.standard,
        adapted=photo.adapted,
    )


def source_in(record: dict[str, Any]) -> Source:
    """What was written of a `Source`; what is missing or of another kind raises."""
    primaries = record["primaries"]
    if primaries is not None:
        pairs = {name: _pair(primaries[name]) for name in ("red", "green", "blue", "white")}
        primaries = Primaries(**{**primaries, **pairs})
    # Records told none of them before.
    clauses = ("notes", "edits", "adapted")
    texts = {name: tuple(map(str, record.get(name, ()))) for name in clauses}
    camera = Camera(**record["camera"])
    return Source(**{**record, "camera": camera, "primaries": primaries, **texts})


def _pair(numbers: Any) -> tuple[float, float]:
    x, y = map(float, numbers)
    if not np.isfinite([x, y]).all():
        raise ValueError("its primaries are not finite")
    return x, y
