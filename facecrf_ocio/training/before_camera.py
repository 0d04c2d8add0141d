"""What is before the camera: rendered heads under other light, and surroundings of many kinds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import OpenImageIO

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.joint.second_differences import SECOND_DIFFERENCE
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.response.robust import robust_deviation
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Face, Float

Light = npt.NDArray[np.float32]
# Absorbance of melanin and hemoglobin in red, green and blue, relative to green: rough means over
# the cameras of the renders.
_MELANIN, _BLOOD = np.array([[0.55, 1.0, 1.6], [0.2, 1.0, 0.8]], np.float32)
_GRAY = np.full((1, 3), 1.0 / 3.0, np.float32)  # the mean of the channels
_TILE = 1024  # [px] side of a tile of texture, from which a part is cut for each window
_OCTAVES = (0.0, 0.7, 1.5, 3.0, 7.0)  # px
_CANVAS = 900  # [px] a square that covers a window several times over
_LEAVES = 2500  # shapes, enough to leave little of the canvas bare; chosen by judgment


@dataclass(frozen=True, slots=True, eq=False)
class Head:
    """A linear picture of a face and what is known of it.

    Attributes
    ----------
    name
        Of the file.
    linear, clean
        (H, W, 3) as stored, and with its own noise removed.
    face
        Found in it.
    normals, pigments
        (H, W, 3) and (H, W, 2) melanin and hemoglobin, zero beside the skin; None if unknown.
    """

    name: str
    linear: Light
    clean: Light
    face: Face
    normals: Light | None
    pigments: Light | None


def read_head(path: Path, *, noisy: bool) -> Head:
    """Read a linear picture, and beside it `../aux/NAME_aux.exr` if there is one.

    Raises
    ------
    PhotoError
        If no face is found.
    """
    linear = np.clip(read_photo(path).encoded, 0.0, 1.0)
    linear *= np.float32(1.0 / max(1.0, float(np.quantile(linear, 0.9999))))
    inverse = fixed_curve("srgb", np.linspace(0.0, 1.0, 1024), dorf_model())
    bright = np.clip(linear * (0.2 / max(float(linear.mean()), 1e-3)), 0.0, 1.0)
    seen = np.interp(bright, inverse, np.linspace(0.0, 1.0, 1024)).astype(np.float32)
    found = find_faces(seen, Settings())
    if not found.faces:
        raise PhotoError(path, "shows no face", "leave it out of the training")
    face = max(found.faces, key=lambda candidate: float(candidate.box_xy[2]))
    normals, pigments = _auxiliary(path)
    clean = _denoised(linear) if noisy else linear
    return Head(path.name, linear, clean, face, normals, pigments)


def _auxiliary(path: Path) -> tuple[Light | None, Light | None]:
    name = path.name.replace("_noisy", "").replace("_clean", "").replace(".exr", "_aux.exr")
    file = path.parent.parent / "aux" / name
    if path.suffix != ".exr" or not file.is_file():
        return None, None
    picture = OpenImageIO.ImageBuf(str(file))
    names = picture.spec().channelnames
    values = np.asarray(picture.get_pixels(OpenImageIO.FLOAT))
    normals = values[..., [names.index(f"N.{axis}") for axis in "XYZ"]]
    pigments = values[..., [names.index("mel"), names.index("haem")]]
    pigments = pigments * values[..., names.index("skin"), None]
    return np.ascontiguousarray(normals), np.ascontiguousarray(pigments)


def _denoised(linear: Light) -> Light:
    """Its own noise removed, which would be coarse when enlarged; the root makes noise even."""
    codes = np.rint(np.sqrt(linear) * 65535.0).astype(np.uint16)
    planes = []
    for plane in cv2.split(codes):
        values = plane.astype(np.float32)
        second = cv2.sepFilter2D(values, -1, SECOND_DIFFERENCE, SECOND_DIFFERENCE)
        noise = robust_deviation(np.asarray(second, np.float32)) / 6.0
        planes.append(cv2.fastNlMeansDenoising(plane, [1.1 * noise], None, 5, 15, cv2.NORM_L1))
    return np.asarray((cv2.merge(planes).astype(np.float32) / 65535.0) ** 2, np.float32)


def stage(head: Head, generator: np.random.Generator) -> Light:
    """The head with other skin, make-up and light, at the size of its picture."""
    light = head.clean
    if head.pigments is not None and generator.random() < 0.5:
        strength = generator.normal(0.0, 0.5, 2).clip(-0.9, 1.5).astype(np.float32)
        amount = head.pigments * strength
        light = light * np.exp(-amount[..., :1] * _MELANIN - amount[..., 1:] * _BLOOD)
    if generator.random() < 0.25:
        light = _even(light, generator.uniform(0.0, 0.9), generator.uniform(4.0, 16.0))
    if head.normals is not None and generator.random() < 0.4:
        light = light * _relit(head.normals, generator)
    if generator.random() < 0.4:
        light = light * _uneven_light(light.shape[:2], generator)
    if generator.random() < 0.45:
        light = saturate(light, generator.uniform(0.15, 1.5))
    elif generator.random() < 0.7:
        light = saturate(light, np.exp(generator.normal(0.0, 0.3)))
    return np.asarray(np.maximum(light, 0.0), np.float32)


def saturate(light: Light, factor: float) -> Light:
    """Other primaries, roughly: every color moved from, or toward, its gray."""
    gray = gray_of(light)
    return np.asarray(np.maximum(gray + np.float32(factor) * (light - gray), 0.0), np.float32)


def gray_of(light: Light) -> Light:
    """(H, W, 1) mean of the channels."""
    return np.asarray(cv2.transform(light, _GRAY), np.float32)[..., None]


def _even(light: Light, contrast: float, radius: float) -> Light:
    """Make-up: colors nearer to those of their surroundings, shading as it was."""
    gray = gray_of(light) + np.float32(1e-4)
    color = light / gray
    around = cv2.GaussianBlur(color, (0, 0), radius)
    return np.asarray(gray * (around + np.float32(contrast) * (color - around)), np.float32)


def _relit(normals: Light, generator: np.random.Generator) -> Light:
    """A stronger light from some side, sometimes colored: factors (H, W, 3) of the light there."""
    side = generator.uniform(-np.pi, np.pi)
    tilt = generator.uniform(0.2, 1.3)
    direction = [np.sin(tilt) * np.cos(side), np.sin(tilt) * np.sin(side), np.cos(tilt)]
    known = (np.abs(normals).sum(axis=2) > 0.5).astype(np.float32)
    falloff = np.maximum(normals @ np.array(direction, np.float32), 0.0) * known
    # The holes of eyes and brows, and what is beside the head, take after their surroundings.
    weight = cv2.GaussianBlur(known, (0, 0), 6.0) + np.float32(1e-3)
    around = (cv2.GaussianBlur(falloff, (0, 0), 6.0) + np.float32(5e-4)) / weight
    falloff = np.where(known > 0.0, falloff, around)[..., None]
    ambient = np.float32(np.exp(generator.uniform(np.log(0.08), np.log(1.5))))
    tint = np.ones(3, np.float32)
    if generator.random() < 0.5:
        tint = np.exp(generator.normal(0.0, 0.15, 3)).astype(np.float32)
    factor = (ambient + falloff * tint) / (ambient + np.float32(0.6))
    return np.asarray(factor, np.float32)


def _uneven_light(shape: tuple[int, int], generator: np.random.Generator) -> Light:
    """A smooth field of light (H, W, 3), a little of it colored: a second, mixed illuminant."""
    coarse = generator.normal(0.0, 0.25, (3, 3, 1)) + generator.normal(0.0, 0.06, (3, 3, 3))
    field = cv2.resize(np.exp(coarse), shape[::-1], interpolation=cv2.INTER_CUBIC)
    return np.asarray(field, dtype=np.float32)


@cache
def _octaves() -> tuple[Light, ...]:
    """Tiles (1024, 1024) of blurred noise with unit deviation."""
    generator = np.random.default_rng(77)
    tiles = []
    for radius in _OCTAVES:
        tile = generator.standard_normal((_TILE, _TILE), dtype=np.float32)
        if radius:
            tile = np.asarray(cv2.GaussianBlur(tile, (0, 0), radius), np.float32)
        tiles.append(np.asarray(tile / tile.std(), np.float32))
    return tuple(tiles)


@dataclass(frozen=True, slots=True)
class Texture:
    """Fine texture that an enlarged picture lacks: pores, hair, cloth.

    Attributes
    ----------
    strength
        Deviation of the logarithm of light in each octave.
    """

    strength: tuple[float, ...]

    @staticmethod
    def draw(generator: np.random.Generator) -> Texture:
        """None at all in one of five."""
        if generator.random() < 0.2:
            return Texture(())
        level = np.exp(generator.normal(np.log(0.012), 0.9))
        return Texture(tuple(level * generator.dirichlet(np.full(len(_OCTAVES), 0.6))))

    def over(self, light: Light, generator: np.random.Generator) -> Light:
        """Light (H, W, 3), at most 1024 a side, with texture."""
        height, width = light.shape[:2]
        total = np.zeros((height, width), np.float32)
        for strength, tile in zip(self.strength, _octaves(), strict=False):
            if strength > 5e-4:
                top, left = (
                    generator.integers(_TILE - height + 1),
                    generator.integers(_TILE - width + 1),
                )
                total += np.float32(strength) * tile[top : top + height, left : left + width]
        return np.asarray(light * np.exp(total)[..., None], np.float32) if self.strength else light


def read_surroundings(paths: Sequence[Path], count: int, seed: int) -> tuple[Light, ...]:
    """Real linear pictures, so much smaller that they are sharp and clean, and heaps of leaves."""
    found = []
    for path in paths:
        linear = np.clip(read_photo(path).encoded, 0.0, 1.0)
        longest = max(linear.shape[:2])
        size = max(0.3, min(0.6, 900.0 / longest))
        small = cv2.resize(linear, None, fx=size, fy=size, interpolation=cv2.INTER_AREA)
        gains = small.reshape(-1, 3).mean(axis=0)
        small = small / (gains / gains.mean())  # not balanced as stored
        found.append(np.asarray(small * (0.18 / max(float(small.mean()), 1e-4)), np.float32))
    generator = np.random.default_rng(seed)
    return (*found, *(dead_leaves(generator) for _ in range(count)))


def dead_leaves(generator: np.random.Generator) -> Light:
    """Overlapping shapes of all sizes and shades (900, 900, 3): edges as pictures have them.

    After Lee, Mumford, Huang (IJCV 2001), with sizes from a power law.
    """
    canvas = np.full((_CANVAS, _CANVAS, 3), 0.18, np.float32)
    shades = np.exp(generator.normal(np.log(0.15), 1.0, _LEAVES))
    colors = shades[:, None] * np.exp(generator.normal(0.0, 0.25, (_LEAVES, 3)))
    sizes = 250.0 / (1.0 + 60.0 * generator.random(_LEAVES))
    places = generator.uniform(0, _CANVAS, (_LEAVES, 2))
    for color, size, place in zip(colors, sizes, places, strict=True):
        tint = tuple(float(c) for c in color)
        axes = np.maximum(1, size * generator.uniform(0.3, 1.0, 2)).astype(int)
        center = tuple(int(p) for p in place)
        angle = float(generator.uniform(0.0, 180.0))
        if generator.random() < 0.5:
            cv2.ellipse(canvas, center, tuple(axes.tolist()), angle, 0, 360, tint, -1, cv2.LINE_8)
        else:
            box = cv2.boxPoints((place.tolist(), (2.0 * axes).tolist(), angle))
            cv2.fillConvexPoly(canvas, box.astype(np.int32), tint, cv2.LINE_8)
    shading = _uneven_light(canvas.shape[:2], generator)
    # Hard steps have no pixels between: those of a lens have.
    return np.asarray(cv2.GaussianBlur(canvas * shading, (0, 0), 0.6), np.float32)


def scaled_face(face: Face, scale: float, offset: Float) -> Face:
    """The same face in other pixels: first `scale`, then `offset` (x, y)."""
    shift = np.array([offset[0], offset[1], 0.0])
    box = face.box_xy * scale + np.array([offset[0], offset[1], 0.0, 0.0])
    return Face(box, face.landmarks_xyz * scale + shift, face.score)
