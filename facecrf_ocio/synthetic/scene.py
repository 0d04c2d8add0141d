"""The head posed before the camera, and what the camera sees at each pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from facecrf_ocio.face.rasterize import interpolate, rasterize, vertex_normals
from facecrf_ocio.synthetic.head import CENTER, Mesh, bust, face_head, hair_and_ears, merge
from facecrf_ocio.synthetic.spec import Image, SyntheticSpec
from facecrf_ocio.values import Bool, Float, Index

FRONTAL_WIDTH_CM = 15.5  # of the mesh, by which a face is scaled to its width in pixels
FACE_VERTICES = 468  # of the landmarks' mesh, without irises


@dataclass(frozen=True, slots=True, eq=False)
class SeenSurface:
    """What each pixel of the image sees.

    Attributes
    ----------
    material
        (H, W) see `head.Material`; 0 is the background.
    normals
        (H, W, 3) unit normals, x right, y up, z toward the camera; NaN in the background.
    positions
        (H, W, 3) cm, same axes; NaN in the background.
    uv
        (H, W, 2) texture coordinates; NaN in the background.
    """

    material: npt.NDArray[np.uint8]
    normals: Image
    positions: Image
    uv: Image


def pose_head(spec: SyntheticSpec, rng: np.random.Generator) -> Mesh:
    """Shape and turn the head and set it on its shoulders; coordinates in cm, camera axes."""
    head = merge([face_head(), hair_and_ears()])
    turned = (_reshape(head.vertices, rng) - CENTER) @ _rotation(spec).T + CENTER
    return merge([Mesh(turned, head.uv, head.triangles, head.material), bust()])


def to_pixels(vertices: Float, spec: SyntheticSpec) -> Float:
    """Weak perspective: (V, 3) cm in camera axes to pixels with x right, y down, z away."""
    scale = spec.face_width / FRONTAL_WIDTH_CM
    center = np.array([0.5 * spec.width, 0.51 * spec.height, 0.0])
    pixels: Float = center + vertices * [scale, -scale, -scale]
    return pixels


def see(mesh: Mesh, spec: SyntheticSpec) -> SeenSurface:
    """Rasterize the posed mesh."""
    pixels = to_pixels(mesh.vertices, spec)
    normals = vertex_normals(pixels, mesh.triangles)
    front = _faces_camera(pixels, mesh.triangles)
    triangles, material = mesh.triangles[front], mesh.material[front]
    raster = rasterize(pixels, triangles, spec.height, spec.width)
    values = interpolate(raster, triangles, np.hstack([normals, mesh.vertices, mesh.uv]))
    length = np.linalg.norm(values[..., :3], axis=2, keepdims=True)
    return SeenSurface(
        np.where(raster.triangle >= 0, material[raster.triangle], 0).astype(np.uint8),
        values[..., :3] / length,
        values[..., 3:6],
        values[..., 6:],
    )


def _faces_camera(pixels: Float, triangles: Index) -> Bool:
    """(F,) True for triangles that turn their outside to the camera; the others are hidden."""
    a, b, c = (pixels[corner] for corner in triangles.T)
    front: Bool = (b - a)[:, 0] * (c - a)[:, 1] < (c - a)[:, 0] * (b - a)[:, 1]
    return front


def _reshape(vertices: Float, rng: np.random.Generator) -> Float:
    """Vary width, height, jaw and nose of vertices (V, 3) [cm] a little."""
    width, height, jaw, nose = rng.normal(0, (0.03, 0.03, 0.05, 0.25))
    x, y, z = vertices.T
    below_eyes = np.clip((2.0 - y) / 11.0, 0, 1)
    near_nose = np.exp(-(x**2 + (y + 1.0) ** 2) / 6.0) * np.clip(z - 4.0, 0, None)
    return np.stack(
        [x * (1 + width) * (1 + jaw * below_eyes**2), y * (1 + height), z + nose * near_nose],
        axis=1,
    )


def _rotation(spec: SyntheticSpec) -> Float:
    """(3, 3) turns by yaw, then pitch, then roll; see `SyntheticSpec` for the signs."""
    (cy, cp, cr), (sy, sp, sr) = (
        function(np.deg2rad([spec.yaw, spec.pitch, spec.roll])) for function in (np.cos, np.sin)
    )
    yaw = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    pitch = np.array([[1, 0, 0], [0, cp, sp], [0, -sp, cp]])
    roll = np.array([[cr, sr, 0], [-sr, cr, 0], [0, 0, 1]])
    rotation: Float = roll @ pitch @ yaw
    return rotation
