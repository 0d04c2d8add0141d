"""Photos with faces for the tests of `facecrf_ocio.face`."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import OpenImageIO as oiio  # noqa: N813
from matplotlib import cbook
from matplotlib.image import imread


@cache
def grace_hopper():
    """(600, 512, 3) float32: the public-domain portrait that matplotlib ships."""
    with cbook.get_sample_data("grace_hopper.jpg") as file:
        photo = imread(file, "jpg").astype(np.float32) / 255.0
    photo.flags.writeable = False
    return photo


def shrink(photo, scale):
    return cv2.resize(photo, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)


def linear_light(encoded):
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def eight_bit(values):
    return (np.rint(np.clip(values, 0.0, 1.0) * 255.0) / 255.0).astype(np.float32)


def turn(photo, degrees):
    """Turn about the center on a canvas that holds all; also the (2, 3) map of points to it."""
    height, width = photo.shape[:2]
    matrix = cv2.getRotationMatrix2D((width / 2, height / 2), degrees, 1.0)
    cosine, sine = abs(matrix[0, 0]), abs(matrix[0, 1])
    size = (round(width * cosine + height * sine), round(width * sine + height * cosine))
    matrix[:, 2] += np.array(size) / 2 - (width / 2, height / 2)
    for_centers = matrix.copy()
    for_centers[:, 2] += matrix[:, :2] @ (0.5, 0.5) - 0.5
    return cv2.warpAffine(photo, for_centers, size, borderMode=cv2.BORDER_REPLICATE), matrix


@dataclass(frozen=True)
class Head:
    """A rendered head and what is known of it."""

    name: str
    encoded: np.ndarray
    normals: np.ndarray
    skin: np.ndarray
    box_xy: np.ndarray


def read_channels(path: Path):
    image = oiio.ImageBuf(str(path))
    return dict(
        zip(image.spec().channelnames, np.moveaxis(image.get_pixels(oiio.FLOAT), 2, 0), strict=True)
    )


def rendered_heads(data: Path):
    """Yield the development heads, their linear light encoded as sRGB."""
    folder = data / "faces" / "rendered"
    with (folder / "index.tsv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file, delimiter="\t"):
            image = read_channels(folder / row["file_clean"])
            truth = read_channels(folder / row["file_aux"])
            linear = np.clip(np.stack([image[c] for c in "RGB"], axis=2), 0.0, 1.0)
            encoded = np.where(
                linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055
            )
            yield Head(
                name=Path(row["file_aux"]).name.removesuffix("_aux.exr"),
                encoded=encoded.astype(np.float32),
                normals=np.stack([truth[c] for c in ("N.X", "N.Y", "N.Z")], axis=2),
                skin=truth["skin"],
                box_xy=np.array([float(v) for v in row["face_box_xywh(yunet)"].split(",")]),
            )
