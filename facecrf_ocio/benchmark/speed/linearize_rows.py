"""Applying a LUT, and a whole EXR, beside OpenColorIO's packed call and decode + write."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.speed.linearize_speed import (
    PAIRS,
    Pixels,
    as_type,
    exr_calls,
    packed,
    shades,
)
from facecrf_ocio.benchmark.speed.race import Call, Timed, race
from facecrf_ocio.benchmark.speed.speed_row import SpeedRow, in_ratio
from facecrf_ocio.files.threads import one_opencv_thread, usable_cores
from facecrf_ocio.image.compression import COMPRESSION
from facecrf_ocio.image.lut_lookup import lut_lookup
from facecrf_ocio.lut.write import write_lut
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import CURVE_SIZE, dorf_model, strictly_increasing
from facecrf_ocio.values import InverseCRF

_MEGAPIXELS = 12.0  # of the picture
_APPLY = 1.5  # wanted: so many times as fast as OpenColorIO, each pair of types
_EXR = {"none": 1.10, COMPRESSION: 0.9}  # wanted: the ratio to decode + write


def srgb_lut(folder: Path) -> Path:
    """Write the curve that is applied where none is given."""
    encoded = np.linspace(0.0, 1.0, CURVE_SIZE)
    curve = strictly_increasing([fixed_curve("srgb", encoded, dorf_model())] * 3)
    return write_lut(InverseCRF(encoded, curve), folder / "srgb.spi1d", overwrite=True)


def apply_rows(folder: Path, scale: float, repeat: int) -> Iterator[SpeedRow]:
    """The slowest pair of types, into a buffer that is there, on one core and on all."""
    codes = shades(_MEGAPIXELS * scale)
    lut = srgb_lut(folder)
    with _one_core():
        yield _slowest(codes, lut, 1, repeat)
    cores = usable_cores()
    if cores > 1:
        yield _slowest(codes, lut, cores, repeat)


def exr_rows(folder: Path, scale: float, repeat: int) -> Iterator[SpeedRow]:
    """JPEG to half EXR, whole, against decoding and writing without anything in between."""
    codes, lookup = shades(_MEGAPIXELS * scale), lut_lookup(srgb_lut(folder))
    for compression, wanted in _EXR.items():
        calls = exr_calls(codes, lookup, compression, folder)
        kept = {name: calls[name] for name in ("read_photo + apply + write", _FLUSHED)}
        ours, floor = race("exr", kept, _MEGAPIXELS * scale, repeat)
        work = f"JPEG to half EXR, {compression}, whole, against decode + write + flush"
        yield in_ratio(f"exr_{compression.replace(':', '_')}", work, ours, floor, wanted)


_FLUSHED = "decode + write + flush to disk"  # what is not on the disk is not written


def _slowest(codes: Pixels, lut: Path, cores: int, repeat: int) -> SpeedRow:
    lookup, found = lut_lookup(lut), {}
    for given, made in PAIRS:
        source = as_type(codes, given)
        result = np.empty(source.shape, made)
        bands = np.array_split(np.arange(len(source)), cores)
        ranges = [slice(band[0], band[-1] + 1) for band in bands]
        parts = [packed(source[rows], result[rows], lut) for rows in ranges]
        calls: dict[str, Call] = {
            "this package": partial(lookup.apply, source, out=result),
            "OpenColorIO": partial(_at_once, parts),
        }
        found[f"{source.dtype} to {result.dtype}"] = race("apply", calls, 1.0, repeat)
    pairs = {name: tuple(timed) for name, timed in found.items()}
    name, (ours, floor) = max(pairs.items(), key=lambda item: _ratio(item[1]))
    work = f"apply, slowest pair ({name}), {cores} {'core' if cores == 1 else 'cores'}"
    told = in_ratio(f"apply_{'one' if cores == 1 else 'all'}", work, ours, floor, 1 / _APPLY)
    return replace(told, value=1 / told.ratio, wanted=_APPLY, more=True)


def _ratio(timed: Sequence[Timed]) -> float:
    return timed[0].seconds / timed[1].seconds


def _at_once(calls: Sequence[Call]) -> None:
    if len(calls) == 1:
        calls[0]()
        return
    with ThreadPoolExecutor(len(calls)) as threads:
        for done in [threads.submit(call) for call in calls]:
            done.result()


@contextmanager
def _one_core() -> Iterator[None]:
    """Let this process use one core, where the system lets it choose."""
    choose = hasattr(os, "sched_setaffinity")
    former = os.sched_getaffinity(0) if choose else set()
    if choose:
        os.sched_setaffinity(0, {max(former)})
    try:
        with one_opencv_thread():
            yield
    finally:
        if choose:
            os.sched_setaffinity(0, former)
