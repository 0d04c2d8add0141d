"""Faces of which every intermediate step is known: rendered heads with maps, or synthetic ones."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.face.view import FaceView
from facecrf_ocio.photo.decoding.picture import open_image
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.synthetic import SyntheticSpec, render_face
from facecrf_ocio.values import Float

Image = npt.NDArray[np.float32]
_DARKEST = 1e-4  # [1] of white: logarithms exist, and 13 stops are more than a photo shows


@dataclass(frozen=True, slots=True, eq=False)
class KnownFace:
    """A linear image and the truth behind it; all on one grid, 0 where there is no skin.

    Attributes
    ----------
    name, sha256
        Of the image and of its contents.
    linear
        (H, W, 3) relative linear light, [0, 1].
    normals
        (H, W, 3) x right, y up, z toward the camera.
    skin
        (H, W) share of bare skin.
    melanin, hemoglobin
        (H, W) densities.
    log_shading
        (H, W, 3) log of linear light over albedo.
    """

    name: str
    sha256: str
    linear: Image
    normals: Image
    skin: Image
    melanin: Image
    hemoglobin: Image
    log_shading: Image


def synthetic_face(seed: int) -> KnownFace:
    """A face of `facecrf_ocio.synthetic` on which the paper's model holds exactly."""
    face = render_face(SyntheticSpec(seed=seed, ideal=True))
    return KnownFace(
        f"synthetic {seed}",
        hashlib.sha256(np.ascontiguousarray(face.linear).tobytes()).hexdigest(),
        face.linear,
        np.nan_to_num(face.normals),
        face.skin.astype(np.float32),
        np.nan_to_num(face.melanin),
        np.nan_to_num(face.hemoglobin),
        np.asarray(np.log(np.maximum(face.shading, _DARKEST)), np.float32),
    )


def rendered_head(image: Path, maps: Path) -> KnownFace:
    """A rendered head and its maps in channels N.X N.Y N.Z skin mel haem albedo.R .G .B.

    Raises
    ------
    PhotoError
        If a file cannot be read or a channel is missing.
    """
    photo, channels = read_photo(image), _channels(maps)
    albedo = np.stack([channels[f"albedo.{c}"] for c in "RGB"], axis=2)
    light = np.clip(photo.encoded, _DARKEST, 1.0)
    return KnownFace(
        image.stem,
        photo.sha256 or "",
        np.clip(photo.encoded, 0.0, 1.0),
        np.stack([channels[f"N.{axis}"] for axis in "XYZ"], axis=2),
        channels["skin"],
        channels["mel"],
        channels["haem"],
        np.asarray(np.log(light / np.maximum(albedo, _DARKEST)), np.float32),
    )


def onto(view: FaceView, image: Image) -> Image:
    """Cut and scale an image of the photo's grid as `cut_face` did the photo."""
    points, margin = view.face.landmarks_xyz[:, :2], 0.05 * view.face.box_xy[2]
    left, top = np.maximum(np.floor(points.min(axis=0) - margin), 0).astype(int)
    right, bottom = np.ceil(points.max(axis=0) + margin).astype(int)
    height, width = view.encoded.shape[:2]
    cut = image[top : min(bottom, image.shape[0]), left : min(right, image.shape[1])]
    contiguous = np.ascontiguousarray(cut, dtype=np.float32)
    return np.asarray(
        cv2.resize(contiguous, (width, height), interpolation=cv2.INTER_AREA), np.float32
    )


def unit(vectors: Float) -> Image:
    """Vectors (..., 3) scaled to length 1; those of no length point to the camera."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    forward = np.array([0.0, 0.0, 1.0])
    return np.asarray(
        np.where(length > 1e-3, vectors / np.maximum(length, 1e-3), forward), np.float32
    )


_NEEDED = ("N.X", "N.Y", "N.Z", "skin", "mel", "haem", "albedo.R", "albedo.G", "albedo.B")


def _channels(path: Path) -> dict[str, Image]:
    source, why = open_image(path)
    if source is None:
        raise PhotoError(
            path, f"is not an image that can be read ({why})", "name the folder of the maps"
        )
    try:
        names = list(source.spec().channelnames)
        pixels = source.read_image("float")
    finally:
        source.close()
    missing = [name for name in _NEEDED if name not in names]
    if missing or pixels is None:
        raise PhotoError(path, f"lacks {', '.join(missing) or 'pixels'}", "render it again")
    planes = np.moveaxis(np.asarray(pixels, np.float32), 2, 0)
    return dict(zip(names, planes, strict=True))
