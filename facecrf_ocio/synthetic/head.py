"""A head around the canonical face mesh: closed, smooth, with hair, ears, neck and clothes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from importlib import resources
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float, Index, frozen

CENTER = np.array([0.0, 0.5, -2.5])  # [cm] of the head, which turns about it
SUBDIVISIONS = 2  # of each triangle of the face, into four
RINGS = 6  # of vertices from the face's outline to the back of the skull
HAIR_FRINGE = 0.08  # of the face's height, that hair hangs below its line


class Material(IntEnum):
    """What a triangle is made of."""

    BACKGROUND = 0
    FACE = 1
    SKULL = 2
    OTHER_SKIN = 3
    HAIR = 4
    CLOTH = 5


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles with a texture.

    Attributes
    ----------
    vertices
        (V, 3) cm; x right, y up, z toward the camera.
    uv
        (V, 2) texture coordinates; the face lies in [0, 1], v down.
    triangles
        (F, 3) vertex indices, counterclockwise seen from outside.
    material
        (F,) what each triangle is made of, see `Material`.
    """

    vertices: Float
    uv: Float
    triangles: Index
    material: npt.NDArray[np.uint8]

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices))
        object.__setattr__(self, "uv", frozen(self.uv))
        object.__setattr__(self, "triangles", frozen(self.triangles, np.intp))
        object.__setattr__(self, "material", frozen(self.material, np.uint8))


@cache
def face_head() -> Mesh:
    """The face and the skull that continues it; its first 468 vertices are the face mesh's own."""
    with resources.as_file(resources.files("facecrf_ocio.face") / "models") as folder:
        canonical = np.load(folder / "canonical_face_mesh.npz")
    face = Mesh(
        canonical["vertices_cm"],
        canonical["uv"],
        canonical["triangles"],
        np.full(len(canonical["triangles"]), Material.FACE),
    )
    head = _close_behind(face)
    for _ in range(SUBDIVISIONS):
        head = _subdivide(head)
    return head


@cache
def hair_and_ears() -> Mesh:
    """What moves with the head and is not the face."""
    parts = [
        _ellipsoid((side * 7.4, 0.3, -3.4), (0.8, 2.7, 1.5), Material.OTHER_SKIN)
        for side in (-1.0, 1.0)
    ]
    return merge([_hair(), *parts])


@cache
def bust() -> Mesh:
    """Neck and clothed shoulders, which stay where they are when the head turns."""
    neck = _ellipsoid((0.0, -12.0, -4.5), (5.2, 16.0, 5.0), Material.OTHER_SKIN)
    shoulders = _ellipsoid((0.0, -25.0, -6.0), (22.0, 12.0, 10.5), Material.CLOTH)
    return merge([neck, shoulders])


def merge(meshes: list[Mesh]) -> Mesh:
    """Join meshes into one, vertices in the given order."""
    offsets = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.uv for mesh in meshes]),
        np.concatenate(
            [mesh.triangles + offset for mesh, offset in zip(meshes, offsets, strict=False)]
        ),
        np.concatenate([mesh.material for mesh in meshes]),
    )


def _close_behind(face: Mesh) -> Mesh:
    """Continue the face's border in rings around the skull to a pole at the back."""
    border = _border(face.triangles)
    start = face.vertices[border] - CENTER
    start_radius = np.linalg.norm(start, axis=1, keepdims=True)
    start = start / start_radius
    pole = np.array([0.0, 0.1, -1.0]) / np.hypot(0.1, 1.0)
    angle = np.arccos(start @ pole)[:, None]
    middle = face.uv.mean(axis=0)
    vertices, uv = [face.vertices], [face.uv]
    for ring in range(1, RINGS + 1):
        t = ring / (RINGS + 1)
        direction = (np.sin((1 - t) * angle) * start + np.sin(t * angle) * pole) / np.sin(angle)
        blend = np.sqrt(t)
        radius = (1 - blend) * start_radius + blend * _skull_radius(direction)
        vertices.append(CENTER + radius * direction)
        uv.append(middle + (face.uv[border] - middle) * (1 + 0.5 * t))
    vertices.append(CENTER + _skull_radius(pole[None]) * pole)
    uv.append(middle[None])
    return Mesh(np.concatenate(vertices), np.concatenate(uv), *_ring_triangles(face, border))


def _ring_triangles(face: Mesh, border: Index) -> tuple[Index, npt.NDArray[np.uint8]]:
    count = len(border)
    rings = [border, *(len(face.vertices) + count * k + np.arange(count) for k in range(RINGS))]
    pole = len(face.vertices) + count * RINGS
    new = []
    for a, b in pairwise(rings):
        next_a, next_b = np.roll(a, -1), np.roll(b, -1)
        new += [np.stack([a, b, next_a], axis=1), np.stack([next_a, b, next_b], axis=1)]
    last = rings[-1]
    new.append(np.stack([last, np.full(count, pole), np.roll(last, -1)], axis=1))
    added = np.concatenate(new)
    material = np.r_[face.material, np.full(len(added), Material.SKULL, dtype=np.uint8)]
    return np.concatenate([face.triangles, added]), material


def _skull_radius(direction: Float) -> Float:
    """(N, 1) distance from CENTER to the skull; below, the neck's root is nearer than the chin."""
    radii = np.where(
        direction[:, 1:2] > 0, np.array([[7.6, 11.0, 9.5]]), np.array([[7.6, 7.5, 9.5]])
    )
    radius: Float = 1.0 / np.linalg.norm(direction / radii, axis=1, keepdims=True)
    return radius


def _border(triangles: Index) -> Index:
    """(B,) vertices of the only border of triangles (F, 3), in the direction of these along it."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    present = {(int(a), int(b)) for a, b in edges}
    following = {a: b for a, b in present if (b, a) not in present}
    loop = [min(following)]
    while following[loop[-1]] != loop[0]:
        loop.append(following[loop[-1]])
    return np.array(loop, dtype=np.intp)


def _subdivide(mesh: Mesh) -> Mesh:
    """One step of Loop's subdivision (1987, with Warren's weights) of a closed mesh."""
    values = np.concatenate([mesh.vertices, mesh.uv], axis=1)
    faces = mesh.triangles
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    opposite = np.concatenate([faces[:, 2], faces[:, 0], faces[:, 1]])
    edges, edge_of_side = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    edge_of_side = edge_of_side.reshape(-1)

    middles = 3 / 8 * values[edges].sum(axis=1)
    np.add.at(middles, edge_of_side, values[opposite] / 8)
    neighbors = np.zeros_like(values)
    np.add.at(neighbors, edges[:, 0], values[edges[:, 1]])
    np.add.at(neighbors, edges[:, 1], values[edges[:, 0]])
    valence = np.bincount(edges.ravel())[:, None]
    weight = np.where(valence > 3, 3 / (8 * valence), 3 / 16)
    corners = (1 - valence * weight) * values + weight * neighbors

    ab, bc, ca = edge_of_side.reshape(3, -1) + len(values)
    a, b, c = faces.T
    quarters = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    refined = np.concatenate([corners, middles])
    return Mesh(
        refined[:, :3],
        refined[:, 3:],
        np.concatenate([np.stack(quarter, axis=1) for quarter in quarters]),
        np.tile(mesh.material, 4),
    )


def _ellipsoid(
    center: tuple[float, float, float],
    radii: tuple[float, float, float],
    material: Material,
    rows: int = 24,
    columns: int = 48,
) -> Mesh:
    """An ellipsoid with its poles above and below."""
    directions, uv, triangles = _sphere(rows, columns)
    vertices = np.asarray(center) + np.asarray(radii) * directions
    return Mesh(vertices, uv, triangles, np.full(len(triangles), material))


def _sphere(rows: int, columns: int) -> tuple[Float, Float, Index]:
    polar, azimuth = np.meshgrid(
        np.linspace(0, np.pi, rows), np.linspace(-np.pi, np.pi, columns + 1), indexing="ij"
    )
    directions = np.stack(
        [np.sin(polar) * np.sin(azimuth), np.cos(polar), np.sin(polar) * np.cos(azimuth)], axis=-1
    )
    uv = np.stack([azimuth / (2 * np.pi) + 0.5, polar / np.pi], axis=-1)
    i, j = (index.ravel() for index in np.mgrid[: rows - 1, :columns])
    a = i * (columns + 1) + j
    b = a + columns + 1
    triangles = np.concatenate(
        [np.stack([a, b, a + 1], axis=1), np.stack([a + 1, b, b + 1], axis=1)]
    )
    return directions.reshape(-1, 3), uv.reshape(-1, 2), triangles


def height_above_hairline(direction: Float) -> Float:
    """(...,) how far unit vectors from the head's center point above the hairline."""
    height: Float = direction @ np.array([0.0, 0.75, -0.66]) - 0.08
    return height


def _hair() -> Mesh:
    """A cap that rises from the skull above the hairline; it starts a little below."""
    directions, uv, triangles = _sphere(72, 144)
    rng = np.random.default_rng(7)
    wave = np.zeros(len(directions))
    for frequency in (3, 7, 17, 41):
        phase = rng.uniform(0, 2 * np.pi)
        wave += np.sin(2 * np.pi * frequency * uv[:, 0] + phase) / np.sqrt(frequency)
    above = height_above_hairline(directions)
    rise = np.clip((above + HAIR_FRINGE) / 0.35, 0, 1)
    thickness = (1.015 + rise * (0.10 + 0.015 * wave))[:, None]
    vertices = CENTER + directions * _skull_radius(directions) * thickness
    kept = (above > -HAIR_FRINGE)[triangles].all(axis=1)
    return Mesh(vertices, uv, triangles[kept], np.full(int(kept.sum()), Material.HAIR))
