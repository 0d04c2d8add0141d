"""The photo and its smaller copies, so that every search runs at the size it needs."""

from __future__ import annotations

import cv2
import numpy as np

from facecrf_ocio.photo.raster.halves import halved
from facecrf_ocio.photo.raster.pixels import Pixels, code_values
from facecrf_ocio.values import Float


class Pyramid:
    """A photo at falling sizes, each made when it is asked for.

    By area averages. Photos larger than the first level are halved first: OpenCV halves pixels of
    8 bits ten times as fast as it scales them by any other factor. It rounds up, an eighth of a
    code a time, which no detector sees.

    Parameters
    ----------
    pixels
        (H, W, 3) RGB in [0, 1], or in 8 bits.
    long_sides
        Falling lengths in pixels; those that the photo does not exceed are left out.
    """

    def __init__(self, pixels: Pixels, *long_sides: int) -> None:
        self._sizes: list[tuple[int, int]] = [(pixels.shape[0], pixels.shape[1])]
        self._sides: list[int] = [max(pixels.shape[:2])]
        for side in long_sides:
            if side < self._sides[-1]:
                height, width = self._sizes[-1]
                scale = side / max(height, width)
                self._sizes.append((max(1, round(height * scale)), max(1, round(width * scale))))
                self._sides.append(max(self._sizes[-1]))
        self._is_large = self._sides[0] > long_sides[0]
        self._levels: dict[int, Pixels] = {0: pixels}

    def __len__(self) -> int:
        return len(self._sizes)

    def level(self, index: int) -> Pixels:
        """(H, W, 3) float32 in [0, 1] of a level; the photo itself, as it was given, of level 0."""
        if index not in self._levels:
            height, width = self._sizes[index]
            halvings = self._halvings(index)
            source = halved(self._levels[0], halvings) if self._is_large else self.level(index - 1)
            source = code_values(source, 8)
            copy = cv2.resize(source, (width, height), interpolation=cv2.INTER_AREA)
            self._levels[index] = np.asarray(copy, np.float32)
        return self._levels[index]

    def scale_xy(self, level: int) -> Float:
        """(2,) pixels of the level per pixel of the photo, along x and y."""
        halvings = self._halvings(level)
        # What is halved loses its last row where their number is odd.
        height, width = ((edge >> halvings) << halvings for edge in self._sizes[0])
        return np.array([self._sizes[level][1] / width, self._sizes[level][0] / height])

    def level_within(self, long_side: int) -> int:
        """Return the first level no longer than this, the last if all are longer."""
        return next((k for k, side in enumerate(self._sides) if side <= long_side), len(self) - 1)

    def level_for(self, step: float) -> tuple[Pixels, Float]:
        """Return the smallest level whose pixels are at most `step` pixels apart, and its scale."""
        fine = [k for k in range(len(self)) if self.scale_xy(k).min() * step >= 1.0]
        level = max(fine, default=0)
        return self.level(level), self.scale_xy(level)

    def _halvings(self, level: int) -> int:
        """How often the photo is halved before it is scaled to a level."""
        if not (self._is_large and level):
            return 0
        largest = min(self._sizes[0]).bit_length() - 1  # of which a pixel is left
        return min(largest, (self._sides[0] // self._sides[level]).bit_length() - 1)
