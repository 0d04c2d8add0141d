"""One face as the estimators look at it: cut out, scaled, with its mesh laid over it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face.area_means import area_means
from facecrf_ocio.face.geometry import FaceGeometry, face_geometry
from facecrf_ocio.files.threads import OtherThread
from facecrf_ocio.photo.raster.pixels import Pixels, code_values, in_8_bits
from facecrf_ocio.settings import FaceSettings
from facecrf_ocio.values import Bool, Face, Photo

_MANY_ROWS = 4  # of a photo for one at working size: from there on codes are summed first
MIN_SKIN_PIXELS = 400  # of a face 160 px wide, a square of 20 px; fewer tell of one spot


@dataclass(frozen=True, slots=True, eq=False)
class FaceView:
    """One face cut out of the photo and scaled to the working size.

    Attributes
    ----------
    face
        As detected, in photo pixels.
    encoded
        (H, W, 3) float32 in [0, 1].
    geometry
        The mesh on this grid.
    frame
        x and y of its upper left corner, and its width and height, in pixels of the photo.
    """

    face: Face
    encoded: npt.NDArray[np.float32]
    geometry: FaceGeometry
    frame: tuple[float, float, float, float]

    def within(self, part: Sequence[int]) -> Bool:
        """(H, W) the convex hull of some vertices, in whole pixels.

        The limits of parts were set so: hulls of sixteenths of a pixel, as the margins of the mesh
        are measured from, change what is said of 5 of 363 portraits, inverted, swapped or neither.
        """
        mask = np.zeros(self.encoded.shape[:2], np.uint8)
        points = np.rint(self.geometry.vertices[list(part), :2]).astype(np.int32)
        cv2.fillConvexPoly(mask, cv2.convexHull(points), 1)
        return mask > 0


def cut_face(
    photo: Photo,
    face: Face,
    settings: FaceSettings,
    *,
    to_8_bits: bool = False,
    other: OtherThread | None = None,
) -> FaceView:
    """Cut a face out, scale it down to the working size, and lay its mesh over it.

    With `to_8_bits` it is rounded to 8 bits before it is scaled. With another thread it is scaled
    there, while the mesh is laid here.
    """
    height, width, _ = photo.shape
    points = face.landmarks_xyz[:, :2]
    margin = 0.05 * face.box_xy[2]
    left, top = np.maximum(np.floor(points.min(axis=0) - margin), 0).astype(int)
    right, bottom = np.ceil(points.max(axis=0) + margin).astype(int)
    cut = photo.pixels[top : min(bottom, height), left : min(right, width)]
    face_width = float(np.ptp(points[:, 0]))
    scale = min(1.0, settings.face_width / face_width)
    size = (max(1, round(cut.shape[1] * scale)), max(1, round(cut.shape[0] * scale)))
    scaled = partial(_scaled, cut, size, to_8_bits=to_8_bits)
    ask_scaled = scaled if other is None else other.begin(scaled)
    geometry = face_geometry(
        face, (size[1], size[0]), origin=(float(left), float(top)), scale=scale
    )
    frame = (float(left), float(top), float(cut.shape[1]), float(cut.shape[0]))
    return FaceView(face, ask_scaled(), geometry, frame)


def _scaled(cut: Pixels, size: tuple[int, int], *, to_8_bits: bool) -> npt.NDArray[np.float32]:
    """(H, W, 3) encoded values of a face at working size, of which `size` is width and height."""
    if cut.dtype == np.uint8 and cut.shape[0] >= _MANY_ROWS * size[1]:
        return area_means(np.asarray(cut, np.uint8), size)
    # Channel by channel: a large face, rounded, would be a tenth of what a worker may take.
    planes = [_scaled_plane(cut[..., c], size, to_8_bits=to_8_bits) for c in range(3)]
    return np.asarray(cv2.merge(planes), np.float32)


def _scaled_plane(
    channel: Pixels, size: tuple[int, int], *, to_8_bits: bool
) -> npt.NDArray[np.float32]:
    channel = np.ascontiguousarray(channel)
    channel = in_8_bits(channel) if to_8_bits else code_values(channel, 8)
    if channel.shape == size[::-1]:
        return channel
    return np.asarray(cv2.resize(channel, size, interpolation=cv2.INTER_AREA), np.float32)
