"""The HDR rendition that a photo's gain map gives: what its maker meant, not proven scene light."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio import __version__
from facecrf_ocio.color.adaptation import rgb_to_xyz
from facecrf_ocio.color.primaries import known_primaries
from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.image.apply import WrittenExr, write_exr
from facecrf_ocio.image.compression import COMPRESSION
from facecrf_ocio.photo.decoding.unrounded import unrounded
from facecrf_ocio.values import Float, GainMap, Photo, Primaries

Float32 = npt.NDArray[np.float32]
NOT_PROVEN = "the rendition its maker meant for bright screens, not proven scene light"


def write_rendition(
    path: Path,
    photo: Photo,
    *,
    half: bool = True,
    compression: str = COMPRESSION,
    overwrite: bool = False,
) -> WrittenExr:
    """Write what a photo's gain map makes of it as an EXR, white of the encoded picture being 1.

    Its color space is told as `unknown`, with the primaries beside it: the light is linear, but
    nobody says that it is the scene's.

    Raises
    ------
    SettingsError
        If the photo has no gain map.
    OutputError
        If the file exists and `overwrite` is false, or it cannot be written.
    """
    gain_map = photo.gain_map
    if gain_map is None:
        raise SettingsError(f"{photo.path}: has no gain map; calibrate it instead")
    space = _space(photo, gain_map)
    photo = exact_base(photo, gain_map)
    return write_exr(
        path,
        partial(hdr_rows, photo, gain_map),
        replace(photo, primaries=replace(space, name=f"{space.name} (HDR rendition)")),
        provenance=_provenance(gain_map),
        half=half,
        compression=compression,
        overwrite=overwrite,
    )


def exact_base(photo: Photo, gain_map: GainMap) -> Photo:
    """The photo with its code values before rounding, from which libultrahdr goes to light."""
    base = unrounded(gain_map.base, gain_map.orientation) if gain_map.base else None
    if base is None or base.shape != photo.encoded.shape:
        return photo
    return replace(photo, encoded=base)


def _provenance(gain_map: GainMap) -> Mapping[str, str]:
    return {
        "hdr": f"gain map ({gain_map.standard}): {NOT_PROVEN}",
        "headroom": f"{headroom(gain_map):.3f} stops",
        "version": __version__,
    }


def headroom(gain_map: GainMap) -> float:
    """[stop] By which white may be brightened."""
    return float(np.max(gain_map.high))


def _space(photo: Photo, gain_map: GainMap) -> Primaries:
    """Primaries of the rendition."""
    own = gain_map.rendition or gain_map.primaries or photo.primaries
    return own or known_primaries("Rec.709", "assumed")


def hdr_rows(photo: Photo, gain_map: GainMap, begin: int, end: int) -> Float32:
    """(end - begin, W, 3) light of some rows, white of the encoded picture being 1; not below 0.

    The encoded picture is taken for sRGB, as the standards of gain maps have it.
    """
    encoded = photo.encoded[begin:end]
    if _in_steps(gain_map):
        encoded = _stepped(encoded)
    light: npt.NDArray[Any] = decode_srgb(encoded).astype(np.float32)
    if gain_map.primaries is not None:
        light = light @ _between(photo.primaries, gain_map.primaries).T
    gain = _gain(gain_map, map_rows(gain_map, photo.encoded.shape, begin, end))
    light = (light + gain_map.base_offset) * gain - gain_map.offset
    if gain_map.rendition is not None:
        light = light @ _between(gain_map.primaries or photo.primaries, gain_map.rendition).T
    return np.asarray(np.maximum(light, 0), np.float32)


def _between(source: Primaries | None, target: Primaries) -> Float:
    """Matrix (3, 3) from one set of primaries to another of the same white."""
    source = source or known_primaries("Rec.709", "assumed")
    to_xyz, back = (
        rgb_to_xyz((one.red, one.green, one.blue), one.white) for one in (source, target)
    )
    return np.asarray(np.linalg.solve(back, to_xyz))


def _gain(gain_map: GainMap, values: Float32) -> npt.NDArray[np.floating]:
    if gain_map.standard == "Apple":  # its map is encoded as Rec.709's light is, near to sRGB's
        return np.asarray(1 + (2**gain_map.high - 1) * decode_srgb(values))
    raised = values if (gain_map.gamma == 1).all() else values ** (1 / gain_map.gamma)
    if _in_steps(gain_map):
        raised = _stepped(raised)
    return np.asarray(np.exp2(gain_map.low + (gain_map.high - gain_map.low) * raised))


def _in_steps(gain_map: GainMap) -> bool:
    """Whether libultrahdr reads such a map: a JPEG's, but not Apple's."""
    return not gain_map.centered and gain_map.standard != "Apple"


def _stepped(values: npt.NDArray[Any]) -> Float32:
    """The nearest entries of libultrahdr's tables, in [0, 1].

    A step is a quarter of a code of 8 bits, so a photo holds nothing finer. Yet without it up to 8
    of 100 pixels differ by more than 1 %: where an offset is taken off again, little light is left.
    """
    nearest = np.floor(np.asarray(values, np.float32) * _STEPS + np.float32(0.5))
    return np.asarray(nearest / _STEPS, np.float32)


def map_rows(gain_map: GainMap, shape: tuple[int, ...], begin: int, end: int) -> Float32:
    """(end - begin, W, 3) of a coarser map: the four values around, weighed by nearness.

    Weights are one through the distance (Shepard), and the file's first pixel lies at the map's
    first, as libultrahdr samples a JPEG's; linear weights would be off by up to 3 % at edges.
    """
    height, width = shape[:2]
    values, turned = gain_map.values, gain_map.orientation
    if values.shape[:2] == (height, width):
        return values[begin:end]
    if gain_map.centered:
        return _centered_rows(values, (height, width), begin, end)
    rows, columns = values.shape[:2]
    scale_y, scale_x = _scales(height / rows, width / columns, sideways=turned in _SIDEWAYS)
    total = np.zeros((end - begin, width, 1), np.float32)
    result = np.zeros((end - begin, width, 3), np.float32)
    for step_y in (0, 1):
        row, away_y = _beside(height, scale_y, rows, step_y, backward=turned in _UP)
        for step_x in (0, 1):
            column, away_x = _beside(width, scale_x, columns, step_x, backward=turned in _LEFT)
            distance = np.hypot(away_y[begin:end, None], away_x[None])
            weight = (1 / np.maximum(distance, _AT_A_VALUE))[..., None]
            result += weight * values[row[begin:end, None], column[None]]
            total += weight
    return np.asarray(result / total, np.float32)


def _centered_rows(values: Float32, shape: tuple[int, int], begin: int, end: int) -> Float32:
    """(end - begin, W, 3) linear between the middles of a map's pixels, as libavif scales it."""
    height, width = shape
    last = len(values) - 1
    place = np.clip((np.arange(begin, end) + 0.5) * len(values) / height - 0.5, 0, last)
    row = place.astype(np.intp)
    below = (place - row).astype(np.float32)[:, None, None]
    between = values[row] * (1 - below) + values[np.minimum(row + 1, last)] * below
    return np.asarray(cv2.resize(between, (width, end - begin), interpolation=cv2.INTER_LINEAR))


def _scales(y: float, x: float, *, sideways: bool) -> tuple[float, float]:
    """Photo pixels a map value; that of the file's width for both where they are nearly alike."""
    if abs(y / x - 1) > _ALIKE:
        return y, x
    return (y, y) if sideways else (x, x)


def _beside(
    pixels: int, scale: float, values: int, step: int, *, backward: bool
) -> tuple[npt.NDArray[np.intp], Float32]:
    """Which map value lies before (0) or behind (1) each pixel in the file, and how far away.

    In single precision, as libultrahdr: a pixel that lies at a value has the next one beside it,
    and one that rounding put before it has the last.
    """
    place = np.arange(pixels, dtype=np.float32) / np.float32(scale)
    before = place.astype(np.intp)
    last = np.minimum(before, values - 1)
    index = np.minimum(before + step, values - 1)
    # Where the map ends early, whole scales count on from value to value, others from the last.
    away = place - (before if float(scale).is_integer() else last) - (index - last)
    away = away.astype(np.float32)
    return (values - 1 - index[::-1], away[::-1]) if backward else (index, away)


_STEPS = np.float32(1023)  # between 0 and 1 in libultrahdr's tables of light and of gain
_AT_A_VALUE = 1e-6  # [map pixel] nearer than this, a value is taken as it is
_ALIKE = 0.01  # [ratio] by which libultrahdr lets the sides' scales differ
# EXIF orientations in which the file's first pixel is below, or to the right, once upright; and
# those in which its rows stand.
_UP, _LEFT, _SIDEWAYS = (3, 4, 7, 8), (2, 3, 6, 7), (5, 6, 7, 8)
