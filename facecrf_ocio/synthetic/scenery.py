"""Hair, clothes and the background: what makes a rendered face a portrait."""

from __future__ import annotations

import cv2
import numpy as np

from facecrf_ocio.synthetic.head import height_above_hairline
from facecrf_ocio.synthetic.spec import Color, Image, rgb
from facecrf_ocio.values import Float

STRANDS = 900  # of hair around the head


def hair_albedo(rng: np.random.Generator, uv: Image, color: Color, scalp: Float) -> Image:
    """(N, 3) albedo of hair at (N, 2) coordinates around the head, in strands from the crown.

    Toward the hairline the strands thin out to the color of the scalp.
    """
    noise = rng.standard_normal((64, STRANDS)).astype(np.float32)
    fine = cv2.GaussianBlur(noise, (9, 33), sigmaX=0.8, sigmaY=9.0)
    locks = fine + 1.5 * cv2.GaussianBlur(fine, (41, 33), sigmaX=9.0, sigmaY=9.0)
    locks /= locks.std()
    column = (uv[:, 0] * STRANDS).astype(int) % STRANDS
    strand = locks[np.clip(uv[:, 1] * 64, 0, 63).astype(int), column]
    tint = np.exp(0.35 * strand)[:, None] * rgb(color)

    azimuth, polar = 2 * np.pi * (uv[:, 0] - 0.5), np.pi * uv[:, 1]
    direction = np.stack(
        [np.sin(polar) * np.sin(azimuth), np.cos(polar), np.sin(polar) * np.cos(azimuth)], axis=1
    )
    cover = np.clip(0.5 + (height_above_hairline(direction) + 0.012 * strand) / 0.07, 0, 1)[:, None]
    albedo: Image = cover * tint + (1 - cover) * scalp
    return albedo


def cloth_albedo(rng: np.random.Generator, count: int) -> Image:
    """(count, 3) albedo of plain cloth with a little weave."""
    color = rng.uniform(0.03, 0.3) * rng.uniform(0.4, 1.0, 3)
    weave = 1 + 0.06 * rng.standard_normal((count, 1))
    albedo: Image = (weave * color).clip(0.005, 0.9).astype(np.float32)
    return albedo


def background(rng: np.random.Generator, height: int, width: int) -> Image:
    """(H, W, 3) linear light of a wall with panels and out-of-focus spots."""
    size = max(height, width)
    wall = rng.uniform(0.06, 0.3) * rng.uniform(0.75, 1.0, 3)
    picture = np.empty((height, width, 3), dtype=np.float32)
    picture[:] = np.linspace(1.25, 0.6, height)[:, None, None] * wall
    for _ in range(14):
        center = (int(rng.uniform(0, width)), int(rng.uniform(0, height)))
        color = rng.uniform(0.02, 0.6) * rng.uniform(0.35, 1.0, 3)
        cv2.circle(picture, center, int(size * rng.uniform(0.02, 0.09)), color.tolist(), -1)
    cv2.GaussianBlur(picture, (0, 0), 0.02 * size, dst=picture)
    for _ in range(2):
        left, top = int(rng.uniform(0, 0.9) * width), int(rng.uniform(0, 0.5) * height)
        extent = (rng.uniform(0.15, 0.35, 2) * size).astype(int)
        panel = picture[top : top + int(extent[1]), left : left + int(extent[0])]
        panel *= np.float32(rng.uniform(0.25, 2.2) * rng.uniform(0.7, 1.0, 3))
    return np.clip(picture, 0.002, 0.85)
