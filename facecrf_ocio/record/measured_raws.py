"""Cameras measured by raw files, each by the picture inside of it; all files of one model together.

Files of one model are measured apart, so that how far their curves lie from each other tells how
sure the measurement is.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from facecrf_ocio.cameras.known_cameras import KnownCamera, names_of
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.pair.calibrate_pair import calibrate_pair
from facecrf_ocio.photo.camera_picture import camera_in_raw, camera_picture
from facecrf_ocio.record.measured import entry, rounded, spread_codes
from facecrf_ocio.values import Camera, Float

MOST_FILES = 8
"""Of a model that are measured, spread over all: what the files share stays in the mean of more."""

_PROOF = "raw files by the pictures inside: "
_AGREEING = 3  # files that agree make grade A
_APART = 0.15  # [stop] that they may lie apart for that
_LEAST = 0.06  # [stop] that is told of the surest, as of those that ship


@dataclass(frozen=True, slots=True)
class MeasuredRaws:
    """What raw files gave.

    Attributes
    ----------
    cameras
        A measurement of each model, with the number of files that it rests on.
    passed
        Why files gave none.
    """

    cameras: tuple[tuple[KnownCamera, int], ...]
    passed: tuple[PhotoError, ...]


def measure_raws(
    paths: Sequence[Path], *, progress: Callable[[str, int, int], None] = lambda *_: None
) -> MeasuredRaws:
    """Measure each model of camera that took some raw files, by at most `MOST_FILES` of them.

    Parameters
    ----------
    paths
        Raw files.
    progress
        Called with what is done, how many times it was, and how many times it will be.
    """
    passed: list[PhotoError] = []
    models: dict[frozenset[str], list[tuple[Path, Camera]]] = {}
    for number, path in enumerate(paths):
        progress(f"looking into {path}", number, len(paths))
        try:
            camera = camera_in_raw(path)
            if not camera.model:
                raise PhotoError(path, "does not name its camera", "give a file with EXIF")
            models.setdefault(names_of(camera.make, camera.model), []).append((path, camera))
        except PhotoError as error:
            passed.append(error)
    chosen = [files[:: -(-len(files) // MOST_FILES)] for files in models.values()]
    done, cameras = 0, []
    for files in chosen:
        entries = []
        for path, camera in files:
            progress(f"measuring by {path}", done, sum(map(len, chosen)))
            done += 1
            try:
                entries.append(_measured(path, camera))
            except PhotoError as error:
                passed.append(error)
        if entries:
            cameras.append((_together(entries), len(entries)))
    return MeasuredRaws(tuple(cameras), tuple(passed))


def with_measured(
    own: Sequence[KnownCamera], measured: Sequence[KnownCamera]
) -> tuple[KnownCamera, ...]:
    """A registry with what raw files have measured, and without what some of them had before."""
    files = [_hashes(one) for one in measured]

    def is_among_them(one: KnownCamera) -> bool:
        return one.proof.startswith(_PROOF) and any(_hashes(one) <= each for each in files)

    return (*(one for one in own if not is_among_them(one)), *measured)


def _hashes(measured: KnownCamera) -> frozenset[str]:
    return frozenset(re.findall(r"\b[0-9a-f]{64}\b", measured.proof))


def _measured(path: Path, camera: Camera) -> KnownCamera:
    picture = camera_picture(path)
    estimate = calibrate_pair(path, picture).estimate
    return entry(camera, estimate, f"{path.name} sha256 {picture.sha256}")


def _together(entries: Sequence[KnownCamera]) -> KnownCamera:
    """The mean of measurements in the root of light, by how sure each is, and how they scatter."""
    trust = np.array([one.spread_stops**-2 for one in entries])
    roots = np.sqrt(np.array([one.linear for one in entries]))
    rows = (np.tensordot(trust / trust.sum(), roots, 1)) ** 2
    proof = _PROOF + ", ".join(one.proof for one in entries)
    first = replace(entries[0], proof=proof, linear=rounded(rows))
    if len(entries) == 1:
        return first
    apart = max(_scatter(roots[:, 1] ** 2, rows[1]), _LEAST)
    agree = len(entries) >= _AGREEING and apart <= _APART
    spread = float(f"{apart:.3g}")
    return replace(
        first, grade="A" if agree else min(e.grade for e in entries), spread_stops=spread
    )


def _scatter(each: Float, mean: Float) -> float:
    """[stop] Root mean square distance of curves (N, L) from their mean, where codes are seen."""
    seen = spread_codes(np.linspace(0.0, 1.0, mean.size))
    away = np.log2(each[:, seen] / mean[seen])
    return float(np.sqrt((away**2).mean() * len(each) / (len(each) - 1)))
