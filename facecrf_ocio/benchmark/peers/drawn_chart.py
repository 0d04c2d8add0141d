"""Photos of a color chart, drawn: any response, light, place and compression."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.chart.reflectances import reflectances
from facecrf_ocio.synthetic.jpeg import codes_of, jpeg_of
from facecrf_ocio.values import Float, InverseCRF, Photo

PATCH, GAP, FRAME = 60, 9, 25  # [px]
WIDE = 6 * PATCH + 5 * GAP + 2 * FRAME  # [px]
HIGH = 4 * PATCH + 3 * GAP + 2 * FRAME  # [px]


def flat_chart(known: Float) -> Float:
    """(H, W, 3) light of the chart seen straight on."""
    picture = np.full((HIGH, WIDE, 3), 0.035)
    for patch, light in enumerate(known):
        row, column = divmod(patch, 6)
        top, left = FRAME + row * (PATCH + GAP), FRAME + column * (PATCH + GAP)
        picture[top : top + PATCH, left : left + PATCH] = light
    return picture


def lit_chart(
    seed: int = 0,
    *,
    white: float = 0.8,
    fall: float = 0.0,
    turn: float = 0.0,
    glare: float = 0.005,
    shape: tuple[int, int] = (640, 820),
) -> tuple[Float, Float]:
    """(H, W, 3) light and (4, 2) corners: in perspective, turned [degree], light falling [stop].

    A lens lays glare on all of it, in units of what white reflects in the middle.
    """
    random = np.random.default_rng(seed)
    height, width = shape
    plain = np.array([[0, 0], [WIDE, 0], [WIDE, HIGH], [0, HIGH]], float)
    angle = np.deg2rad(turn)
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    placed = (plain - [WIDE / 2, HIGH / 2]) @ rotation.T + [width / 2, height / 2]
    placed += random.uniform(-0.05, 0.05, (4, 2)) * WIDE
    matrix = cv2.getPerspectiveTransform(_single(plain), _single(placed))
    flat = _single(flat_chart(reflectances()))
    lit = cv2.warpPerspective(flat, matrix, (width, height), borderValue=(0.3, 0.3, 0.3))
    y, x = np.mgrid[:height, :width]
    away = (x / width - 0.5) * 0.8 + (y / height - 0.5) * 0.6
    lit *= np.exp2(fall * away - 0.5 * fall * ((x / width - 0.5) ** 2))[..., None]
    edge = [[FRAME, FRAME], [WIDE - FRAME, FRAME], [WIDE - FRAME, HIGH - FRAME]]
    edge.append([FRAME, HIGH - FRAME])
    corners = np.asarray(cv2.perspectiveTransform(_single([edge]), matrix)[0], np.float64)
    return np.asarray(lit + glare, np.float64) * white / reflectances()[18, 1], corners


def shot(
    light: Float, curve: InverseCRF, *, quality: int = 92, seed: int = 0
) -> tuple[bytes, Photo]:
    """The photo that a camera with this inverse response makes: shot noise, rounding, JPEG."""
    random = np.random.default_rng(seed)
    noisy = light + random.normal(size=light.shape) * np.sqrt(2e-5 * light + 1e-6)
    codes = np.rint(curve.encode(np.clip(noisy, 0.0, 1.0)) * 255).astype(np.uint8)
    content = jpeg_of(codes, quality)
    return content, Photo(_single(codes_of(content)) / np.float32(255), bit_depth=8)


def _single(values: npt.ArrayLike) -> npt.NDArray[np.float32]:
    return np.asarray(values, np.float32)
