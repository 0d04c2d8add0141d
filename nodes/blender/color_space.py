"""What the config in use calls linear light, and images whose code values stay as they are."""

from __future__ import annotations

import bpy
import numpy as np
from mathutils import Color

_PRIMARIES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
CODES_OF = "facecrf_codes_of"
SPACE = "lin_rec709"
"""What `facecrf` is asked for: Blender knows the way from there in any config."""


def from_rec709() -> np.ndarray:
    """Return the matrix from linear Rec.709 to what the config in use calls scene-linear."""
    columns = [Color(primary).from_rec709_linear_to_scene_linear() for primary in _PRIMARIES]
    return np.array(columns).T


def codes_of(image: bpy.types.Image) -> bpy.types.Image:
    """Return a copy of an image whose code values reach the nodes as they are.

    The image itself keeps its color space, since materials and other scenes may use it. The copy
    is found again by what it is a copy of.
    """
    if CODES_OF in image:
        return image
    for other in bpy.data.images:
        if other.get(CODES_OF) == image.name_full:
            return other
    copy = _copied(image)
    copy.name = f"{image.name} (codes)"
    copy[CODES_OF] = image.name_full
    copy.colorspace_settings.is_data = True
    return copy


def _copied(image):
    if image.source == "FILE" and not image.is_dirty:
        return image.copy()
    return painted_copy(image)


def painted_copy(image: bpy.types.Image) -> bpy.types.Image:
    """Return a packed copy of the 8-bit pixels that an image shows, as code values.

    Blender's own copy of an image is made anew of its file or color, without what was painted.
    """
    width, height = image.size
    copy = bpy.data.images.new(image.name, width, height, alpha=image.channels == 4, is_data=True)
    copy.pixels.foreach_set(_pixels(image))
    copy.pack()
    return copy


def _pixels(image):
    values = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(values)
    return values


def linear_image(image: bpy.types.Image, calibration) -> bpy.types.Image:
    """Return a new packed image of scene-linear light, made of an image's code values."""
    codes = codes_of(image)
    width, height = codes.size
    pixels = _pixels(codes).reshape(-1, codes.channels)
    rows = np.array(calibration.rows)
    matrix = from_rec709() @ np.array(calibration.matrix)
    if codes.channels < 3:
        pixels = np.repeat(pixels[:, :1], 3, axis=1)
    places = np.clip(pixels[:, :3], 0, 1) * (len(rows) - 1)
    light = [np.interp(places[:, i], np.arange(len(rows)), rows[:, i]) for i in range(3)]
    out = np.ones((len(pixels), 4), np.float32)
    out[:, :3] = np.stack(light, axis=1) @ matrix.T
    if codes.channels == 4:
        out[:, 3] = pixels[:, 3]
    made = bpy.data.images.new(
        f"{image.name} (linear)", width, height, alpha=codes.channels == 4, float_buffer=True
    )
    # A new float image is in the config's scene-linear space.
    made.pixels.foreach_set(out.ravel())
    made.update()
    made.pack()
    if codes.users == 0:
        bpy.data.images.remove(codes)
    return made
