"""An image that obeys the rivals' assumption exactly: uniform colors that blend in linear light."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np

from facecrf_ocio.published.energy.color_blend import EdgeBlends
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.values import Photo

MODEL = dorf_model()
GRID = MODEL.grid
CELL = 64
RADIUS = 14.0
LOW, HIGH = 0.01, 0.97
GAMMA22 = np.tile(GRID**2.2, (3, 1))
MEAN = np.tile(MODEL.mean, (3, 1))


@cache
def linear_scene(*, rows=10, columns=16, blur=0.7, seed=0):
    """Disks on grounds in linear light, and both colors of every cell (rows, columns, 2, 3).

    Each cell shows one disk whose rim is spread over a few pixels, far from the cell's border.
    """
    rng = np.random.default_rng(seed)
    colors = scattered_colors(rng, rows * columns).reshape(rows, columns, 2, 3)
    grounds = np.repeat(np.repeat(colors, CELL, axis=0), CELL, axis=1)
    y, x = np.mgrid[: rows * CELL, : columns * CELL] % CELL - (CELL - 1) / 2.0
    shift = np.repeat(np.repeat(rng.uniform(-1, 1, (rows, columns, 2)), CELL, 0), CELL, 1)
    depth = (RADIUS - np.hypot(y - shift[..., 0], x - shift[..., 1])) / blur
    share = (1.0 / (1.0 + np.exp(-1.7 * depth)))[..., None]
    return share * grounds[:, :, 0] + (1.0 - share) * grounds[:, :, 1], colors


def scattered_colors(rng, count):
    """Pairs of colors (count, 2, 3): half near the corners of the cube, half anywhere in it."""
    anywhere = rng.uniform(LOW, HIGH, (count, 2, 3))
    corners = rng.integers(0, 2, (count, 2, 3)) * HIGH + rng.uniform(-0.35, 0.35, (count, 2, 3))
    chosen = np.where(rng.uniform(size=(count, 1, 1)) < 0.5, corners, anywhere)
    return np.clip(chosen, LOW, HIGH)


def photograph(linear, inverse, *, bits=16):
    """The photo of a linear image by a camera whose inverse curves are (3, K), quantized."""
    encoded = np.stack([np.interp(linear[..., c], inverse[c], GRID) for c in range(3)], axis=-1)
    top = 2**bits - 1
    return Photo(encoded=(np.round(encoded * top) / top).astype(np.float32), bit_depth=bits)


def plausible_curves(seed):
    """Three different increasing curves (3, K) drawn from the response model's own mixture."""
    rng = np.random.default_rng(seed)
    curves = []
    while len(curves) < 3:
        part = rng.integers(len(MODEL.mixture.means))
        spread = 0.5 * MODEL.mixture.covariances[part]
        curve = MODEL.samples(rng.multivariate_normal(MODEL.mixture.means[part], spread))
        if np.diff(curve).min() > 0.0:
            curves.append(curve)
    return np.array(curves)


def sharpened(photo, amount=1.0):
    """The photo after an unsharp mask on its encoded values, as cameras and editors apply it."""
    blurred = cv2.GaussianBlur(np.array(photo.encoded), (0, 0), 1.0)
    return Photo(encoded=np.clip(photo.encoded + amount * (photo.encoded - blurred), 0.0, 1.0))


def rmse(samples, truth):
    """Error (3,) of each channel over all encoded values."""
    return np.sqrt(((samples - truth) ** 2).mean(axis=1))


def random_blends(seed):
    """Colors of four patches that obey nothing, for tests of energies as functions."""
    rng = np.random.default_rng(seed)
    patch = np.sort(np.concatenate([np.arange(4), rng.integers(0, 4, 10)]))
    return EdgeBlends(rng.uniform(0, 1, (3, 4, 2)), rng.uniform(0, 1, (3, 14)), patch)


def random_curves(seed, size=128):
    """Powers, one for each channel: (3, `size`)."""
    exponents = np.random.default_rng(seed).uniform(0.6, 3.0, (3, 1))
    return np.linspace(0.0, 1.0, size) ** exponents
