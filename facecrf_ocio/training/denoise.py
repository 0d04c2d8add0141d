"""How cameras and software take noise away, of the root of light or of encoded values."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.training.before_camera import gray_of

Light = npt.NDArray[np.float32]
# Shares, most of what keeps edges; chosen by judgment.
_KINDS = {"bilateral": 0.4, "shrink": 0.4, "median": 0.1, "blur": 0.1}


@dataclass(frozen=True, slots=True)
class Denoiser:
    """How noise is taken away, of light's root or of encoded values.

    Attributes
    ----------
    kind
        `none`, `bilateral`, `shrink` (small details of two octaves), `median` or `blur`.
    strength
        In deviations of the noise, or [px] for `blur`.
    radius
        [px] Of the neighborhood.
    chroma
        [px] Blur of color alone, 0 for none.
    """

    kind: str
    strength: float
    radius: float
    chroma: float

    @staticmethod
    def draw(generator: np.random.Generator, share: float) -> Denoiser:
        """One that does something in `share` of all photos."""
        chroma = generator.uniform(0.6, 3.0) if generator.random() < 0.6 * share else 0.0
        if generator.random() >= share:
            return Denoiser("none", 0.0, 1.0, chroma)
        kind = str(generator.choice(list(_KINDS), p=list(_KINDS.values())))
        strength = generator.uniform(*((0.3, 0.9) if kind == "blur" else (0.5, 4.0)))
        return Denoiser(kind, strength, generator.uniform(0.8, 2.5), chroma)

    def apply(self, values: Light, noise: float) -> Light:
        """Denoise (H, W, 3); `noise` is the deviation to be expected in it."""
        values = self._apply(values, noise)
        if self.chroma:
            gray = gray_of(values)
            values = gray + np.asarray(cv2.GaussianBlur(values - gray, (0, 0), self.chroma))
        return np.asarray(values, np.float32)

    def _apply(self, values: Light, noise: float) -> Light:
        if self.kind == "bilateral":
            reach = max(float(self.strength * noise), 1e-4)
            return np.asarray(cv2.bilateralFilter(values, 5, reach, self.radius), np.float32)
        if self.kind == "shrink":
            return _shrunk(values, np.float32(0.5 * self.strength * noise), self.radius)
        if self.kind == "median":
            return np.asarray(cv2.medianBlur(values, 3), np.float32)
        if self.kind == "blur":
            return np.asarray(cv2.GaussianBlur(values, (0, 0), self.strength), np.float32)
        return values


def _shrunk(values: Light, least: np.float32, radius: float) -> Light:
    """Details smaller than `least` removed, larger ones reduced by it, in two octaves."""
    base = cv2.GaussianBlur(values, (0, 0), radius)
    coarse = cv2.GaussianBlur(base, (0, 0), 2.0 * radius)
    total = coarse
    for detail, limit in ((base - coarse, 0.4 * least), (values - base, least)):
        total = total + detail - np.clip(detail, -limit, limit)
    return np.asarray(total, np.float32)
