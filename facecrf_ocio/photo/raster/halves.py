"""A photo at a half, a quarter and so on of its size, for all who look at it so."""

from __future__ import annotations

import weakref

import cv2
import numpy as np

from facecrf_ocio.photo.raster.pixels import Pixels

# Halvings from which on a copy is kept, a sixteenth of the photo's memory and less; and how much is
# [byte] kept anyway, beside the tens of megabytes that a photo takes.
_KEPT, _SMALL = 2, 8 << 20

_last: tuple[weakref.ref[Pixels], dict[int, Pixels]] | None = None


def halved(pixels: Pixels, times: int) -> Pixels:
    """Average 2 x 2 pixels of (H, W, C) so many times; an odd last row or column is left out.

    Halving a large photo takes as long as reading its memory, so small copies of the one that was
    halved last are kept as long as it is there, if nobody can write to it.
    """
    if times == 0:
        return pixels
    kept = _kept(pixels)
    if times not in kept:
        found = _half(halved(pixels, times - 1))
        if pixels.flags.writeable or (times < _KEPT and found.nbytes > _SMALL):
            return found
        found.flags.writeable = False
        kept[times] = found
    return kept[times]


def halved_part(pixels: Pixels, times: int, part: tuple[slice, slice]) -> Pixels:
    """Some rows and columns of `halved`, counted in its pixels: nothing else is halved for them."""
    kept = _kept(pixels)
    already = max((number for number in kept if number <= times), default=0)
    left = times - already
    rows, columns = (slice(edges.start << left, edges.stop << left) for edges in part)
    found = kept.get(already, pixels)[rows, columns]
    for _ in range(left):
        found = _half(found)
    return found


def _kept(pixels: Pixels) -> dict[int, Pixels]:
    global _last  # noqa: PLW0603 - one photo at a time is halved
    last = _last
    if last is None or last[0]() is not pixels:
        last = weakref.ref(pixels, _forget), {}
        _last = last
    return last[1]


def _forget(gone: weakref.ref[Pixels]) -> None:
    global _last  # noqa: PLW0603
    if _last is not None and _last[0] is gone:
        _last = None


def _half(image: Pixels) -> Pixels:
    height, width = image.shape[0] // 2, image.shape[1] // 2
    even = image[: 2 * height, : 2 * width]
    small = cv2.resize(even, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small, image.dtype)
