"""The photo and its smaller copies, so that every search runs at the size it needs."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float


@dataclass(frozen=True, slots=True, eq=False)
class Pyramid:
    """A photo at falling sizes.

    Attributes
    ----------
    levels
        (H, W, 3) RGB images, the photo itself first, each smaller than the one before.
    """

    levels: tuple[npt.NDArray[np.float32], ...]

    def scale_xy(self, level: int) -> Float:
        """(2,) pixels of the level per pixel of the photo, along x and y."""
        photo, copy = self.levels[0].shape, self.levels[level].shape
        return np.array([copy[1] / photo[1], copy[0] / photo[0]])

    def level_within(self, long_side: int) -> int:
        """Return the first level no longer than this, the last if all are longer."""
        sides = [max(level.shape[:2]) for level in self.levels]
        return next((k for k, side in enumerate(sides) if side <= long_side), len(sides) - 1)

    def level_for(self, step: float) -> tuple[npt.NDArray[np.float32], Float]:
        """Return the smallest level whose pixels are at most `step` pixels apart, and its scale."""
        last = len(self.levels) - 1
        fine = [k for k in range(last + 1) if self.scale_xy(k).min() * step >= 1.0]
        level = max(fine, default=0)
        return self.levels[level], self.scale_xy(level)


def build_pyramid(encoded: npt.NDArray[np.float32], *long_sides: int) -> Pyramid:
    """Shrink a photo by area averages.

    Parameters
    ----------
    encoded
        (H, W, 3).
    long_sides
        Falling lengths in pixels; those that the photo does not exceed are left out.
    """
    levels = [encoded]
    for long_side in long_sides:
        height, width = levels[-1].shape[:2]
        scale = long_side / max(height, width)
        if scale < 1.0:
            size = (max(1, round(width * scale)), max(1, round(height * scale)))
            smaller = cv2.resize(levels[-1], size, interpolation=cv2.INTER_AREA)
            levels.append(np.asarray(smaller, dtype=np.float32))
    return Pyramid(tuple(levels))
