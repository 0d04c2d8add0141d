"""All frames of a clip through its curve, one EXR each, with time codes; what is there is kept."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio import __version__
from facecrf_ocio.clip.frame_list import Clip
from facecrf_ocio.image.apply import WrittenExr, linear_rows, write_exr
from facecrf_ocio.image.lookup import curve_lookup
from facecrf_ocio.values import Estimate, InverseCRF

_READ_AT_ONCE = 64  # frames between which a run that was broken off loses nothing


def write_sequence(
    clip: Clip, estimates: Callable[[int], Estimate], folder: Path, *, overwrite: bool = False
) -> Iterator[tuple[WrittenExr, bool]]:
    """Write NAME.NNNN.exr for every frame; yields each with whether it was there already.

    What an EXR does not hold is known of those that are written now.
    `estimates` gives the one of a frame's index. A frame is there if its EXR names the same curve
    and the same frame.
    """
    targets = [folder / f"{clip.name}.{n + 1:04d}.exr" for n in range(len(clip.times))]
    folder.mkdir(parents=True, exist_ok=True)
    wanted = []
    # Both once a curve, of which there are few.
    digest, lookup = cache(_digest), cache(curve_lookup)
    for index, target in enumerate(targets):
        if _is_there(target, digest(estimates(index).curve), clip.names[index]):
            yield WrittenExr(target), True
        else:
            wanted.append(index)
    for begin in range(0, len(wanted), _READ_AT_ONCE):
        part = wanted[begin : begin + _READ_AT_ONCE]
        for index, photo in zip(part, clip.read(part), strict=True):
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
            yield (
                write_exr(targets[index], rows, photo, provenance=provenance, overwrite=overwrite),
                False,
            )


def _digest(curve: InverseCRF) -> str:
    return hashlib.sha256(curve.linear.tobytes()).hexdigest()[:16]


def timecode(seconds: float, rate: float) -> str:
    """HH:MM:SS:FF, without drop frames."""
    whole = max(1, round(rate))
    frame = round(seconds * rate)
    second, rest = divmod(frame, whole)
    return f"{second // 3600:02d}:{second // 60 % 60:02d}:{second % 60:02d}:{rest:02d}"


def _is_there(path: Path, digest: str, frame: str) -> bool:
    if not path.exists():
        return False
    source = oiio.ImageInput.open(str(path))
    if source is None:
        oiio.geterror()
        return False
    spec = source.spec()
    source.close()
    said = (spec.get_string_attribute("facecrf:curve"), spec.get_string_attribute("facecrf:frame"))
    return said == (digest, frame)
