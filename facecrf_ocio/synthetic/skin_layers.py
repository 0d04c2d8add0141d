"""Beer-Lambert skin: where melanin and hemoglobin lie on the face, and what they absorb."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.synthetic.spec import Image
from facecrf_ocio.values import Float, frozen

# Unit change of log linear sRGB with pigment density under D65: spectra of melanin and of blood
# (ISETCam; the Soret band limited to 3 times the mean over 540-580 nm) and measured skin, averaged
# over six cameras (AMPAS rawtoaces) with white-preserving matrices to sRGB. Single cameras, skins
# and blood oxygenations lie within 4.3 (melanin) and 5.3 degrees (hemoglobin) rms of it.
DIRECTIONS: Float = frozen([[-0.3285, -0.4967, -0.8033], [-0.1300, -0.6212, -0.7728]])

# Linear sRGB albedo of fair, medium and dark skin under D65, from ISETCam's measured reflectances.
TONES: Float = frozen([[0.62, 0.345, 0.28], [0.38, 0.185, 0.130], [0.065, 0.037, 0.030]])

# The texture spans the face's texture coordinates and a margin for the skull behind it.
TEXTURE_SIZE = 1024  # [px] side
TEXTURE_MARGIN = 0.25  # of the face's texture on each side, for the head around it

# Marks are drawn in 8 bits, with this optical density at 255.
DENSEST_MARK = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class PigmentMaps:
    """Pigments over the face's texture.

    Attributes
    ----------
    melanin, hemoglobin
        (T, T) optical density relative to plain skin, in units of `DIRECTIONS`.
    """

    melanin: Image
    hemoglobin: Image


def base_color(tone: float) -> Float:
    """(3,) log RGB albedo of plain skin from fair (0) to dark (1)."""
    anchors = np.linspace(0.0, 1.0, len(TONES))
    return np.array([np.interp(tone, anchors, channel) for channel in np.log(TONES).T])


def to_texture(uv: Float) -> Float:
    """Texture coordinates to pixels of the texture, (..., 2) x, y."""
    scaled: Float = (uv + TEXTURE_MARGIN) * (TEXTURE_SIZE / (1 + 2 * TEXTURE_MARGIN)) - 0.5
    return scaled


def paint_pigments(
    rng: np.random.Generator, melanin_contrast: float, hemoglobin_contrast: float
) -> PigmentMaps:
    """Draw both pigments, each from random numbers of its own, so that they are independent.

    Both are smooth fields of low contrast under sparse sharp marks, as in real skin: freckles,
    moles and a few spots of melanin; blemishes and vessels of hemoglobin.
    """
    melanin_rng, hemoglobin_rng = rng.spawn(2)
    return PigmentMaps(
        np.float32(melanin_contrast) * _melanin(melanin_rng),
        np.float32(hemoglobin_contrast) * _hemoglobin(hemoglobin_rng),
    )


def _melanin(rng: np.random.Generator) -> Image:
    marks = np.zeros((TEXTURE_SIZE, TEXTURE_SIZE), dtype=np.uint8)
    _draw_discs(marks, rng, count=40, radius=(0.008, 0.016), density=(0.1, 0.25))
    _draw_discs(marks, rng, count=600, radius=(0.003, 0.008), density=(0.12, 0.5))
    _draw_discs(marks, rng, count=10, radius=(0.006, 0.011), density=(0.8, 1.4))
    return smooth_noise(rng, (6, 12, 24), 0.035) + _soften(marks)


def _hemoglobin(rng: np.random.Generator) -> Image:
    marks = np.zeros((TEXTURE_SIZE, TEXTURE_SIZE), dtype=np.uint8)
    _draw_discs(marks, rng, count=220, radius=(0.005, 0.012), density=(0.08, 0.3))
    _draw_discs(marks, rng, count=20, radius=(0.009, 0.017), density=(0.25, 0.5))
    _draw_vessels(marks, rng, count=90)
    return smooth_noise(rng, (6, 12, 24), 0.035) + _soften(marks)


def smooth_noise(rng: np.random.Generator, cells: tuple[int, ...], deviation: float) -> Image:
    """(T, T) noise of several scales, `cells` across the texture, of a given standard deviation."""
    total = np.zeros((TEXTURE_SIZE, TEXTURE_SIZE), dtype=np.float32)
    for count in cells:
        coarse = rng.standard_normal((count + 3, count + 3)) / np.sqrt(count)
        total += cv2.resize(coarse.astype(np.float32), total.shape, interpolation=cv2.INTER_CUBIC)
    scaled: Image = (total - total.mean()) * np.float32(deviation / total.std())
    return scaled


def _draw_discs(
    marks: npt.NDArray[np.uint8],
    rng: np.random.Generator,
    count: int,
    radius: tuple[float, float],
    density: tuple[float, float],
) -> None:
    """Spread flat discs; radii in texture coordinates."""
    scale = TEXTURE_SIZE / (1 + 2 * TEXTURE_MARGIN)
    centers = np.round(rng.uniform(0, TEXTURE_SIZE, (count, 2)) * 16).astype(int)
    radii = np.round(rng.uniform(*radius, count) * scale * 16).astype(int)
    codes = np.round(rng.uniform(*density, count) * (255 / DENSEST_MARK)).astype(int)
    for center, r, code in zip(centers.tolist(), radii.tolist(), codes.tolist(), strict=True):
        cv2.circle(marks, center, r, code, -1, cv2.LINE_AA, 4)


def _draw_vessels(marks: npt.NDArray[np.uint8], rng: np.random.Generator, count: int) -> None:
    """Draw thin curves: random walks that keep their heading for a while."""
    for _ in range(count):
        steps = int(rng.integers(10, 28))
        heading = rng.uniform(0, 2 * np.pi) + np.cumsum(rng.normal(0, 0.35, steps))
        path = rng.uniform(0, TEXTURE_SIZE, 2) + 4.0 * np.cumsum(
            np.column_stack([np.cos(heading), np.sin(heading)]), axis=0
        )
        code = int(rng.uniform(0.12, 0.5) * 255 / DENSEST_MARK)
        cv2.polylines(marks, [np.round(path * 16).astype(np.int32)], False, code, 2, cv2.LINE_AA, 4)


def _soften(marks: npt.NDArray[np.uint8]) -> Image:
    """Marks in density, with rims about as wide as a pixel of a face 240 px wide."""
    density = marks * np.float32(DENSEST_MARK / 255)
    return np.asarray(cv2.GaussianBlur(density, (7, 7), 1.3), dtype=np.float32)
