"""Which way a picture is to be turned, and turning it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np

from facecrf_ocio.photo.raster.pixels import Pixels
from facecrf_ocio.photo.tags.xmp import value_of

# EXIF 2.32, tag 0x0112: where row 0 and column 0 of the file are in the upright picture.
_UPRIGHT: dict[int, Callable[[Any], Any]] = {
    2: lambda image: cv2.flip(image, 1),
    3: lambda image: cv2.rotate(image, cv2.ROTATE_180),
    4: lambda image: cv2.flip(image, 0),
    5: cv2.transpose,
    6: lambda image: cv2.rotate(image, cv2.ROTATE_90_CLOCKWISE),
    7: lambda image: cv2.rotate(cv2.transpose(image), cv2.ROTATE_180),
    8: lambda image: cv2.rotate(image, cv2.ROTATE_90_COUNTERCLOCKWISE),
}
QUARTER_TURNS = (5, 6, 7, 8)
"""Orientations by which width and height are exchanged."""
# The same turned back (tag 0x0112 again), as views: a look at some rows copies nothing.
_STORED: dict[int, Callable[[Pixels], Pixels]] = {
    2: np.fliplr,
    3: lambda image: np.rot90(image, 2),
    4: np.flipud,
    5: lambda image: np.swapaxes(image, 0, 1),
    6: np.rot90,
    7: lambda image: np.swapaxes(np.rot90(image, 2), 0, 1),
    8: lambda image: np.rot90(image, -1),
}
# As XMP spells them; of any other text, thousands of digits among them, none is a number here.
_XMP = {str(orientation): orientation for orientation in range(1, 9)}


def upright(image: Pixels, orientation: int) -> Pixels:
    """Apply an EXIF orientation, 1 to 8, to (H, W) or (H, W, 3); other numbers change nothing."""
    turn = _UPRIGHT.get(orientation)
    return image if turn is None else np.asarray(turn(np.ascontiguousarray(image)))


def as_stored(image: Pixels, orientation: int) -> Pixels:
    """A view of an upright picture as its file holds it: what `upright` did, undone."""
    back = _STORED.get(orientation)
    return image if back is None else back(image)


def orientation_of(spec: Any, xmp: str) -> int:
    """EXIF's orientation, 1 to 8, else that of XMP, else 1."""
    told = int(spec.get_int_attribute("Orientation", 0))
    known = told == 1 or told in _UPRIGHT
    return told if known else _XMP.get(value_of(xmp, "tiff:Orientation"), 1)
