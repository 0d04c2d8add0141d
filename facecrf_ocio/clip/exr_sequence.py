"""All frames of a clip through its curve, one EXR each, with time codes; what is there is kept."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio import __version__
from facecrf_ocio.clip.frame_list import Clip
from facecrf_ocio.files.plain_text import complaint
from facecrf_ocio.image.apply import BEYOND_HALF, WrittenExr, linear_rows, write_exr
from facecrf_ocio.image.compression import COMPRESSION
from facecrf_ocio.image.lookup import curve_lookup
from facecrf_ocio.image.pixel_types import HALF_MAX
from facecrf_ocio.photo.decoding.picture import open_image
from facecrf_ocio.values import Estimate, InverseCRF, Outcome

_READ_AT_ONCE = 64  # frames between which a run that was broken off loses nothing


def write_sequence(
    clip: Clip,
    estimates: Callable[[int], Estimate],
    folder: Path,
    *,
    compression: str = COMPRESSION,
    overwrite: bool = False,
) -> Iterator[tuple[WrittenExr, bool]]:
    """Write NAME.NNNN.exr for every frame; yields each with whether it was there already.

    Frames that cannot be read have none; `clip.unread` names them.
    `estimates` gives the one of a frame's index. A frame is there if its EXR names the same curve
    and the same frame, and goes on to its last row, however it is compressed; one that ends before
    is written again.
    """
    targets = [folder / f"{clip.name}.{n + 1:04d}.exr" for n in range(len(clip.times))]
    folder.mkdir(parents=True, exist_ok=True)
    wanted: dict[int, bool] = {}  # frames to write, and whether over what is there
    # Both once a curve, of which there are few.
    digest, lookup = cache(_digest), cache(curve_lookup)
    for index, target in enumerate(targets):
        there = _found(target, digest(estimates(index).curve), clip.names[index])
        if there is _Found.WHOLE:
            linear = estimates(index).outcome is Outcome.ALREADY_LINEAR
            yield WrittenExr(target, _cut_in(target) if linear else ()), True
        else:
            wanted[index] = overwrite or there is _Found.CUT_SHORT
    numbers = list(wanted)
    for begin in range(0, len(numbers), _READ_AT_ONCE):
        part = numbers[begin : begin + _READ_AT_ONCE]
        for index, photo in clip.read(part):
            estimate = estimates(index)
            provenance = {
                "outcome": str(estimate.outcome),
                "estimator": estimate.estimator,
                "version": __version__,
                "curve": digest(estimate.curve),
                "frame": clip.names[index],
                "timecode": timecode(clip.times[index], clip.rate),
                "frames_per_second": f"{clip.rate:.6g}",
            }
            rows = (
                photo.encoded if photo.scene_linear else linear_rows(photo, lookup(estimate.curve))
            )
            how: dict[str, Any] = {"compression": compression, "overwrite": wanted[index]}
            yield write_exr(targets[index], rows, photo, provenance=provenance, **how), False


def _cut_in(path: Path) -> tuple[str, ...]:
    """What an EXR does not hold of light that no curve bounds, as `WrittenExr` tells it."""
    pixels = np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.HALF))
    return (BEYOND_HALF,) if (pixels >= HALF_MAX).any() else ()


def _digest(curve: InverseCRF) -> str:
    return hashlib.sha256(curve.linear.tobytes()).hexdigest()[:16]


def timecode(seconds: float, rate: float) -> str:
    """HH:MM:SS:FF, without drop frames."""
    whole = max(1, round(rate))
    frame = round(seconds * rate)
    second, rest = divmod(frame, whole)
    return f"{second // 3600:02d}:{second // 60 % 60:02d}:{second % 60:02d}:{rest:02d}"


class _Found(Enum):
    """What stands where a frame's EXR goes."""

    WHOLE = "the frame by the same curve"
    CUT_SHORT = "the same, which ends before its last row"
    OTHER = "something else, or nothing"


def _found(path: Path, digest: str, frame: str) -> _Found:
    source = open_image(path)[0] if path.exists() else None
    if source is None:
        return _Found.OTHER
    spec = source.spec()
    said = (spec.get_string_attribute("facecrf:curve"), spec.get_string_attribute("facecrf:frame"))
    if said != (digest, frame):
        found = _Found.OTHER
    else:
        end = spec.y + spec.height
        last = source.read_scanlines(end - 1, end, spec.z, 0, spec.nchannels, oiio.HALF)
        found = _Found.CUT_SHORT if last is None or source.has_error else _Found.WHOLE
    complaint(source.geterror)
    source.close()
    return found
