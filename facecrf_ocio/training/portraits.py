"""Portraits whose response nobody knows, each through several known curves.

Sent through a known curve h, a photo of the inverse response g has g(h^-1), whatever g is: the
estimates of two versions of a portrait must agree, and that is all that is learned from it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.benchmark.consistency import photo_in_8_bits
from facecrf_ocio.errors import FaceCRFError, SettingsError
from facecrf_ocio.files.plain_text import counted
from facecrf_ocio.joint.evidence import observe
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.settings import JointSettings
from facecrf_ocio.values import Float, Lacking

VERSIONS = 7  # of each portrait, the portrait itself among them; chosen by judgment
_SUFFIXES = (".jpg", ".jpeg", ".png")
_GRID = np.linspace(0.0, 1.0, 1024)  # encoded values
_EXPONENT = 0.22  # standard deviation of its logarithm: a gamma of 2.2 becomes 1.8 or 2.7
_BENDS = 0.03  # of full scale: standard deviation of the slowest bend
_STEEPEST = 4.0  # as many codes as are lost between two that are kept


@dataclass(frozen=True, slots=True, eq=False)
class Versions:
    """Versions of N portraits, K of each.

    Attributes
    ----------
    curves
        (N, K, 1024) the known curve from a portrait's encoded values to the version's.
    by_cue
        (N, K, S) statistics of each cue; NaN where a version does not show it.
    """

    curves: npt.NDArray[np.float32]
    by_cue: dict[str, npt.NDArray[np.float32]]

    def __len__(self) -> int:
        return len(self.curves)


def observe_portraits(folder: Path, seed: int, processes: int) -> Versions:
    """Send each portrait below a folder through known curves, and count what its versions show.

    Portraits that cannot be read, or show no face in a version, are passed over.

    Parameters
    ----------
    folder
        Of photos of faces, at any depth.
    seed
        Of the curves; those of a portrait depend on it and the portrait's place alone.
    processes
        That share the work.

    Raises
    ------
    SettingsError
        If there are no photos, or none shows a face in all of its versions.
    """
    paths = portrait_paths(folder)
    look = partial(_observed, seed)
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        found = [one for one in pool.map(look, enumerate(paths), chunksize=4) if one is not None]
    if not found:
        shown = f"none of {counted(len(paths), 'photo')} shows a face in all versions"
        raise SettingsError(f"{folder}: {shown}; give photos of faces")
    return _together(found)


def portrait_paths(folder: Path) -> list[Path]:
    """Photos below a folder, by name.

    Raises
    ------
    SettingsError
        If there are none.
    """
    paths = sorted(p for p in folder.rglob("*") if p.suffix.lower() in _SUFFIXES)
    if not paths:
        raise SettingsError(f"{folder}: holds no JPEG or PNG; give a folder of portraits")
    return paths


def write_versions(path: Path, versions: Versions) -> None:
    """Store them as .npz."""
    arrays: dict[str, Any] = {"curves": versions.curves, **versions.by_cue}
    with path.open("wb") as file:
        np.savez_compressed(file, **arrays)


def read_versions(path: Path) -> Versions:
    """Read what `write_versions` wrote.

    Raises
    ------
    SettingsError
        If it did not write the file.
    """
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
            return Versions(stored["curves"], {cue: stored[cue] for cue in CUES})
    except (ValueError, KeyError, EOFError, BadZipFile) as error:
        raise SettingsError(f"{path}: holds no versions of portraits; make it anew") from error


def known_curve(generator: np.random.Generator) -> Float:
    """An increasing curve (1024,) from 0 to 1: another exponent, and gentle bends."""
    order = np.arange(1, 5)
    while True:
        power = _GRID ** np.exp(generator.normal(0.0, _EXPONENT))
        heights = generator.normal(0.0, _BENDS, order.size) / order
        curve = power + heights @ np.sin(np.pi * order[:, None] * power)
        slopes = np.diff(curve[16:]) * (_GRID.size - 1)
        if slopes.min() > 1.0 / _STEEPEST and slopes.max() < _STEEPEST:
            return np.maximum.accumulate(np.clip(curve, 0.0, 1.0))


_Observed = tuple[Float, list[Mapping[str, Float]]]


def _observed(seed: int, numbered: tuple[int, Path]) -> _Observed | None:
    cv2.setNumThreads(1)
    number, path = numbered
    generator = np.random.default_rng([seed, number])
    curves = [_GRID, *(known_curve(generator) for _ in range(VERSIONS - 1))]
    try:
        photo = read_photo(path)
    except FaceCRFError:
        return None
    through = (np.interp(photo.encoded, _GRID, curve) for curve in curves)
    seen = [observe(photo_in_8_bits(photo, encoded), JointSettings()) for encoded in through]
    told = [one.statistics.by_cue for one in seen if not isinstance(one, Lacking)]
    return (np.array(curves), told) if len(told) == VERSIONS else None


def _together(found: Sequence[_Observed]) -> Versions:
    sizes = {cue: v.size for _, told in found for one in told for cue, v in one.items()}
    by_cue = {
        cue: np.array(
            [[one.get(cue, np.full(sizes[cue], np.nan)) for one in told] for _, told in found],
            np.float32,
        )
        for cue in CUES
    }
    return Versions(np.array([curves for curves, _ in found], np.float32), by_cue)
