"""Simulate many photos in parallel, part by part, going on where an earlier run stopped."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from multiprocessing import get_context
from pathlib import Path

import cv2

from facecrf_ocio.training.before_camera import Head, Light, read_head, read_surroundings
from facecrf_ocio.training.draw_process import FROM_CAMERAS, HARDLY_PROCESSED
from facecrf_ocio.training.parts import write_part
from facecrf_ocio.training.plan import PARTS_FROM_CAMERAS, Data
from facecrf_ocio.training.simulate import simulate

_PHOTOS = 72  # of each part: two of each of 36 heads
_HEAPS, _HEAPS_SEED = 16, 0  # heaps of leaves beside real surroundings


def simulate_parts(data: Data, folder: Path, parts: int, seed: int, processes: int) -> None:
    """Write `part0000.npz` and so on; those that exist are kept.

    The photos of a part depend on `seed` and the part's number alone, not on the processes.
    """
    folder.mkdir(parents=True, exist_ok=True)
    missing = [n for n in range(parts) if not _path(folder, n).exists()]
    make = partial(_make, data, folder, seed)
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        for _ in pool.map(make, missing):
            pass


def _make(data: Data, folder: Path, seed: int, part: int) -> None:
    cv2.setNumThreads(1)
    heads, around = _content(data)
    shares = FROM_CAMERAS if part < PARTS_FROM_CAMERAS else HARDLY_PROCESSED
    examples = list(simulate(heads, around, data.curves(), _PHOTOS, [seed, part], shares))
    write_part(_path(folder, part), examples)


@cache
def _content(data: Data) -> tuple[tuple[Head, ...], tuple[Light, ...]]:
    heads = tuple(read_head(path, noisy=True) for path in data.heads())
    return heads, read_surroundings(data.scenes(), _HEAPS, _HEAPS_SEED)


def _path(folder: Path, part: int) -> Path:
    return folder / f"part{part:04d}.npz"
