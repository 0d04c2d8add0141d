"""Light on a surface: Lambert shading, highlights and the shadows a head casts on itself."""

from __future__ import annotations

from itertools import product

import cv2
import numpy as np

from facecrf_ocio.face.rasterize import interpolate, rasterize
from facecrf_ocio.synthetic.spec import Color, Image, Light, rgb
from facecrf_ocio.values import Float, Index

TO_CAMERA = np.array([0.0, 0.0, 1.0])  # unit vector
SHININESS = 18.0  # exponent of the Blinn-Phong lobe: a soft sheen
SHADOW_PIXELS_PER_CM = 8.0  # of the map that sees the head from the light
SHADOW_BIAS_CM = 0.3  # that a surface may lie behind what shades it, or it would shade itself
SHADOW_SOFTNESS_CM = (-0.5, -0.17, 0.17, 0.5)  # offsets of the samples that blur a shadow's edge


def shade(
    normals: Image, lights: tuple[Light, ...], visible: list[Image], ambient: Color, skyward: float
) -> Image:
    """Irradiance by Lambert's law.

    Parameters
    ----------
    normals
        (H, W, 3) unit normals.
    lights
        Distant lights.
    visible
        For each light (H, W), the share of it that arrives, [0, 1].
    ambient, skyward
        See `SyntheticSpec`.

    Returns
    -------
    numpy.ndarray
        (H, W, 3) linear RGB.
    """
    sky = 1 + np.float32(skyward) * normals[..., 1]
    total = sky[..., None] * rgb(ambient)
    for light, share in zip(lights, visible, strict=True):
        total += (_cosine(normals, light) * share)[..., None] * rgb(light.color)
    return total


def reflect(
    normals: Image, lights: tuple[Light, ...], visible: list[Image], strength: float
) -> Image:
    """Blinn-Phong highlights seen from the front, (H, W, 3) linear RGB in the lights' colors.

    `strength` is their peak where the surface mirrors a light of color 1 that it faces.
    """
    total = np.zeros_like(normals)
    for light, share in zip(lights, visible, strict=True):
        halfway = light.unit() + TO_CAMERA
        halfway /= max(float(np.linalg.norm(halfway)), 1e-6)
        cosine = np.clip(normals @ halfway.astype(np.float32), 0, 1)
        lobe = cosine**SHININESS * _cosine(normals, light) * share
        total += (strength * lobe)[..., None] * rgb(light.color)
    return total.astype(np.float32)


def cast_shadow(
    light: Light, vertices: Float, triangles: Index, positions: Image, normals: Image
) -> Image:
    """Share of a light that arrives at surface points, by a shadow map.

    Parameters
    ----------
    light
        The light.
    vertices, triangles
        (V, 3) cm and (F, 3) of what casts the shadow; x right, y up, z toward the camera.
    positions, normals
        (H, W, 3) surface points in cm and their unit normals.

    Returns
    -------
    numpy.ndarray
        (H, W) in [0, 1], with soft borders.
    """
    axes = _light_axes(light)
    seen = vertices @ axes.T
    corner = seen[:, :2].min(axis=0) - 1.0
    width, height = np.ceil((np.ptp(seen[:, :2], axis=0) + 2.0) * SHADOW_PIXELS_PER_CM).astype(int)
    pixels = np.column_stack([(seen[:, :2] - corner) * SHADOW_PIXELS_PER_CM, -seen[:, 2]])
    raster = rasterize(pixels, triangles, int(height), int(width))
    nearest = np.nan_to_num(interpolate(raster, triangles, seen[:, 2:])[..., 0], nan=-1e3)

    here = positions @ axes.T.astype(np.float32)
    tilt = normals @ axes.T.astype(np.float32)
    x, y = ((here[..., k] - np.float32(corner[k])) * SHADOW_PIXELS_PER_CM - 0.5 for k in (0, 1))
    # Around a point the surface goes on as its tangent plane, which must not shadow itself.
    slope_x, slope_y = (np.clip(-tilt[..., k] / tilt[..., 2].clip(0.1), -4, 4) for k in (0, 1))
    lit = np.zeros(positions.shape[:2], dtype=np.float32)
    for dx, dy in product(SHADOW_SOFTNESS_CM, repeat=2):
        to_x, to_y = x + dx * SHADOW_PIXELS_PER_CM, y + dy * SHADOW_PIXELS_PER_CM
        blocker = cv2.remap(nearest, to_x, to_y, cv2.INTER_NEAREST, borderValue=-1e3)
        lit += blocker < here[..., 2] + slope_x * dx + slope_y * dy + SHADOW_BIAS_CM
    lit /= len(SHADOW_SOFTNESS_CM) ** 2
    soft = cv2.GaussianBlur(lit, (7, 7), 1.5)
    return np.asarray(soft, dtype=np.float32)


def _cosine(normals: Image, light: Light) -> Image:
    cosine: Image = np.maximum(normals @ light.unit().astype(np.float32), 0)
    return cosine


def _light_axes(light: Light) -> Float:
    """(3, 3) rows: two axes across the light's rays and the one toward it."""
    toward = light.unit()
    beside = (0.0, 1.0, 0.0) if abs(toward[1]) < 0.9 else (1.0, 0.0, 0.0)
    across = np.cross(beside, toward)
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(toward, across), toward])
