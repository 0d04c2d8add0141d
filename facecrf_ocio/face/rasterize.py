"""From a triangle mesh to pixels: which triangle each pixel sees, and what the mesh says there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float, Index, frozen

# The mesh's pixel axes (x right, y down, z away) turned into those of normals (y up, z to camera).
TO_CAMERA_AXES = np.array([1.0, -1.0, -1.0])


@dataclass(frozen=True, slots=True, eq=False)
class Raster:
    """The triangle each pixel of an (H, W) image sees.

    The center of the pixel in row i, column j lies at x = j + 0.5, y = i + 0.5, so that an image
    W pixels wide spans x from 0 to W.

    Attributes
    ----------
    triangle
        (H, W) int32, index of the nearest triangle that covers the pixel's center; -1 where none
        does.
    barycentric
        (H, W, 3) float32, weights of that triangle's vertices, summing to 1; NaN outside.
    """

    triangle: npt.NDArray[np.int32]
    barycentric: npt.NDArray[np.float32]

    def __post_init__(self) -> None:
        object.__setattr__(self, "triangle", frozen(self.triangle, np.int32))
        object.__setattr__(self, "barycentric", frozen(self.barycentric, np.float32))


def rasterize(vertices: npt.ArrayLike, triangles: npt.ArrayLike, height: int, width: int) -> Raster:
    """Find the nearest triangle at each pixel's center.

    Both sides of a triangle count. A center on an edge that two triangles share belongs to exactly
    one of them. Triangles without area, or with a vertex that is not finite, cover nothing.

    Parameters
    ----------
    vertices
        (V, 3) pixels; x right, y down, z away from the camera (smaller is nearer).
    triangles
        (F, 3) vertex indices.
    height, width
        Size of the image in pixels.
    """
    corners = np.asarray(vertices, dtype=np.float64)[np.asarray(triangles, dtype=np.intp)]
    planes = _barycentric_planes(corners)
    usable = np.isfinite(planes).all(axis=(1, 2)) & np.isfinite(corners).all(axis=(1, 2))
    face, row = _covered_rows(corners, np.flatnonzero(usable), height)
    span, column = _covered_columns(corners, face, row, width)
    face, row = face[span], row[span]
    with np.errstate(invalid="ignore"):
        depth_planes = (planes * corners[:, :, 2, None]).sum(axis=1)
    pixel = row * width + column
    visible = _nearest(_evaluate(depth_planes, face, row, column), pixel)
    face, row, column, pixel = face[visible], row[visible], column[visible], pixel[visible]

    triangle = np.full(height * width, -1, dtype=np.int32)
    barycentric = np.full((height * width, 3), np.nan, dtype=np.float32)
    triangle[pixel] = face
    weights = [_evaluate(planes[:, corner], face, row, column) for corner in range(3)]
    barycentric[pixel] = np.stack(weights, axis=1)
    for array in (triangle, barycentric):
        array.flags.writeable = False  # or the raster would copy them
    return Raster(triangle.reshape(height, width), barycentric.reshape(height, width, 3))


def interpolate(
    raster: Raster, triangles: npt.ArrayLike, attributes: npt.ArrayLike
) -> npt.NDArray[np.float32]:
    """Interpolate vertex attributes linearly over the triangles.

    Parameters
    ----------
    raster
        As returned by `rasterize` for the same triangles.
    triangles
        (F, 3) vertex indices.
    attributes
        (V, C) values at the vertices.

    Returns
    -------
    numpy.ndarray
        (H, W, C) float32, NaN outside of the mesh. Interpolated normals are shorter than 1.
    """
    values = np.asarray(attributes, dtype=np.float32)[np.asarray(triangles, dtype=np.intp)]
    # Outside, where -1 takes the last triangle, its weights are NaN.
    first, second, third = (
        values[:, corner].take(raster.triangle, axis=0) * raster.barycentric[..., corner, None]
        for corner in range(3)
    )
    return np.asarray(first + second + third)


def vertex_normals(vertices: npt.ArrayLike, triangles: npt.ArrayLike) -> Float:
    """Unit normals at the vertices: the mean of the adjoining triangles, weighted by their area.

    Parameters
    ----------
    vertices
        (V, 3) pixels; x right, y down, z away from the camera.
    triangles
        (F, 3) vertex indices, counterclockwise where the viewer sees the outside.

    Returns
    -------
    numpy.ndarray
        (V, 3) x right, y up, z toward the camera; NaN at vertices without a triangle.
    """
    points = np.asarray(vertices, dtype=np.float64) * TO_CAMERA_AXES
    faces = np.asarray(triangles, dtype=np.intp)
    a, b, c = points[faces].transpose(1, 0, 2)
    area_vectors = np.cross(b - a, c - a)
    total = np.zeros_like(points)
    for corner in range(3):
        for axis in range(3):
            total[:, axis] += np.bincount(
                faces[:, corner], weights=area_vectors[:, axis], minlength=len(points)
            )
    length = np.linalg.norm(total, axis=1, keepdims=True)
    normals: Float = total / np.where(length > 0.0, length, np.nan)
    return normals


def _barycentric_planes(corners: Float) -> Float:
    """(F, 3, 3) coefficients (1, x, y) of each corner's weight; not finite without area."""
    x, y = corners[:, :, 0], corners[:, :, 1]
    x1, x2 = np.roll(x, -1, axis=1), np.roll(x, -2, axis=1)
    y1, y2 = np.roll(y, -1, axis=1), np.roll(y, -2, axis=1)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        double_area = (x1[:, 0] - x[:, 0]) * (y2[:, 0] - y[:, 0])
        double_area -= (x2[:, 0] - x[:, 0]) * (y1[:, 0] - y[:, 0])
        planes = np.stack([x1 * y2 - x2 * y1, y1 - y2, x2 - x1], axis=2)
        result: Float = planes / double_area[:, None, None]
    return result


def _evaluate(planes: Float, face: Index, row: Index, column: Index) -> Float:
    """Value of each face's plane, (F, 3) coefficients (1, x, y), at the pixels' centers."""
    constant, slope_x, slope_y = planes.T
    value: Float = constant[face] + slope_x[face] * (column + 0.5) + slope_y[face] * (row + 0.5)
    return value


def _covered_rows(corners: Float, faces: Index, height: int) -> tuple[Index, Index]:
    """All pairs (face, row), where the row's centers lie between the top and bottom of a face.

    `corners` (F, 3, 2) are in pixels; of them those of `faces` (N,) are asked.
    """
    y = corners[faces, :, 1]
    first, stop = _centers_between(y.min(axis=1), y.max(axis=1), height)
    item, row = _expand(first, stop)
    return faces[item], row


def _covered_columns(corners: Float, face: Index, row: Index, width: int) -> tuple[Index, Index]:
    """For N pairs (face, row) of (F, 3, 3) corners, all pairs (n, column) inside of the face."""
    order = np.argsort(corners[:, :, 1], axis=1, kind="stable")
    falling = np.take_along_axis(corners[:, :, :2], order[:, :, None], axis=1)
    top, middle, bottom = falling.take(face, axis=0).transpose(1, 0, 2)
    y = row + 0.5
    upper = (y < middle[:, 1])[:, None]
    # Edges are always followed downward, so that both neighbors of an edge cross it at the very
    # same number and leave neither gap nor overlap.
    long_edge = _crossing(top, bottom, y)
    short_edge = _crossing(np.where(upper, top, middle), np.where(upper, middle, bottom), y)
    first, stop = _centers_between(
        np.minimum(long_edge, short_edge), np.maximum(long_edge, short_edge), width
    )
    return _expand(first, stop)


def _crossing(start: Float, end: Float, y: Float) -> Float:
    x: Float = start[:, 0] + (y - start[:, 1]) * (
        (end[:, 0] - start[:, 0]) / (end[:, 1] - start[:, 1])
    )
    return x


def _centers_between(low: Float, high: Float, size: int) -> tuple[Index, Index]:
    """First and one past the last of `size` pixels whose center lies in [low, high), each (N,)."""
    first = np.clip(np.ceil(low - 0.5), 0, size).astype(np.intp)
    stop = np.clip(np.ceil(high - 0.5), 0, size).astype(np.intp)
    return first, stop


def _expand(first: Index, stop: Index) -> tuple[Index, Index]:
    """All pairs (n, k) with first[n] <= k < stop[n], n ascending."""
    count = np.maximum(stop - first, 0)
    item = np.repeat(np.arange(len(first)), count)
    offset = np.repeat(np.cumsum(count) - count - first, count)
    return item, np.arange(len(item)) - offset


def _nearest(depth: Float, pixel: Index) -> Index:
    """Indices of candidates (N,) that win their pixel: the smallest depth, then the last face."""
    buffer = np.full(int(pixel.max(initial=-1)) + 1, np.inf)
    np.minimum.at(buffer, pixel, depth)
    candidate = np.flatnonzero(depth == buffer[pixel])
    winner = np.full(len(buffer), -1, dtype=np.intp)
    winner[pixel[candidate]] = candidate
    return winner[winner >= 0]
