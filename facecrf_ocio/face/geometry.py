"""From landmarks to what each pixel of the face is: its normal, and whether it is bare skin."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.face import regions
from facecrf_ocio.face.networks import model_file
from facecrf_ocio.face.rasterize import interpolate, rasterize, vertex_normals
from facecrf_ocio.values import Bool, Face, Float, frozen

_MESH_VERTICES = 468  # the landmarks after these are the irises, which the mesh does not have

# Cut away around each feature's convex hull, as parts of the head's width. Landmarks are off by
# about 1 %, and brows grow beyond the landmarks that trace them. What lies between brow and eye
# goes too: it is thin, folded, shaded by lashes, and often painted.
_FEATURE_MARGINS = (
    (regions.RIGHT_LIDS + regions.RIGHT_BROW, 0.015),
    (regions.LEFT_LIDS + regions.LEFT_BROW, 0.015),
    (regions.RIGHT_BROW, 0.045),
    (regions.LEFT_BROW, 0.045),
    (regions.LIPS, 0.025),
    (regions.RIGHT_NOSTRIL, 0.01),
    (regions.LEFT_NOSTRIL, 0.01),
)
_OUTLINE_MARGIN = 0.03  # hair falls over the forehead, and the jaw's edge is uncertain
# Cosine of the steepest normal that counts as skin in view.
_STEEPEST = float(np.cos(np.radians(75.0)))


@dataclass(frozen=True, slots=True, eq=False)
class FaceGeometry:
    """The mesh of one face, rasterized onto an image grid of (H, W) pixels.

    Attributes
    ----------
    vertices
        (V, 3) in pixels of that grid; x right, y down, z away from the camera.
    triangles
        (F, 3) vertex indices.
    normals
        (H, W, 3) unit normals, x right, y up, z toward the camera; NaN outside of the mesh.
    bare_skin
        (H, W) inside the mesh, without eyes, brows, lips and nostrils.
    """

    vertices: Float
    triangles: npt.NDArray[np.int32]
    normals: npt.NDArray[np.float32]
    bare_skin: Bool


def face_geometry(
    face: Face,
    size: tuple[int, int],
    *,
    origin: tuple[float, float] = (0.0, 0.0),
    scale: float = 1.0,
) -> FaceGeometry:
    """Lay the mesh of a face over an image grid.

    The depth is the landmarks' own (weak perspective): on rendered heads other depth scales,
    smoothing, and blending with the posed canonical mesh gave worse normals.

    Parameters
    ----------
    face
        With landmarks in pixels of the photo; the photo spans x from 0 to its width.
    size
        Height and width of the grid in its own pixels.
    origin
        x and y of the grid's upper left corner in pixels of the photo.
    scale
        Pixels of the grid per pixel of the photo.
    """
    height, width = size
    vertices = face.landmarks_xyz[:_MESH_VERTICES] - [*origin, 0.0]
    vertices = frozen(vertices * scale)
    triangles = mesh_triangles()
    raster = rasterize(vertices, triangles, height, width)
    normals = interpolate(raster, triangles, vertex_normals(vertices, triangles))
    x, y, z = (normals[..., axis] for axis in range(3))
    normals /= np.sqrt(x * x + y * y + z * z)[..., None]
    covered = raster.triangle >= 0
    bare_skin = covered & _away_from_edges(vertices, covered)
    with np.errstate(invalid="ignore"):
        bare_skin &= normals[..., 2] > _STEEPEST
    return FaceGeometry(vertices, triangles, frozen(normals, np.float32), frozen(bare_skin, bool))


@cache
def mesh_triangles() -> npt.NDArray[np.int32]:
    """(898, 3) vertex indices of the face mesh, counterclockwise seen from outside, read-only."""
    with model_file("canonical_face_mesh.npz") as path, np.load(path) as mesh:
        return frozen(mesh["triangles"], np.int32)


def _away_from_edges(vertices: Float, covered: Bool) -> Bool:
    """(H, W) True at a distance from the mesh's outline and from every feature."""
    right, left = vertices[list(regions.CHEEK_EDGES)]
    head_width = float(np.linalg.norm(left - right))
    away: Bool = _distance_to(~covered) > _OUTLINE_MARGIN * head_width
    for outline, margin in _FEATURE_MARGINS:
        _clear(away, vertices[list(outline), :2], margin * head_width)
    return away


def _clear(away: Bool, points: Float, margin: float) -> None:
    """Take what is no farther than a margin [px] from the points' hull from (H, W) `away`."""
    feature = _fill_hull(points, away.shape)
    # Nothing farther is near the hull, and no way from what is near leads out of this part.
    reach = int(margin) + 2
    low = np.maximum(np.floor(points.min(axis=0)).astype(int) - reach, 0)
    high = np.maximum(np.ceil(points.max(axis=0)).astype(int) + reach, 0)
    part = slice(low[1], high[1]), slice(low[0], high[0])
    if feature[part].size:
        away[part] &= _distance_to(feature[part]) > margin


def _fill_hull(points: Float, shape: tuple[int, ...]) -> Bool:
    mask = np.zeros(shape, np.uint8)
    # OpenCV wants sixteenths of a pixel, counted from the center of the first one.
    hull = cv2.convexHull(np.rint((points - 0.5) * 16.0).astype(np.int32))
    cv2.fillConvexPoly(mask, hull, 1, shift=4)
    return mask > 0


def _distance_to(mask: Bool) -> npt.NDArray[np.float32]:
    """(H, W) distance in pixels to the nearest True; infinite where there is none."""
    if not mask.any():
        return np.full(mask.shape, np.inf, np.float32)
    distance = cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
    return np.asarray(distance, dtype=np.float32)
