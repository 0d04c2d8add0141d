"""The rasterizer against brute force, closed forms and its own promises."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from facecrf_ocio.face.rasterize import interpolate, rasterize, vertex_normals

SQUARE = np.array([[1.0, 2.0, 0.0], [9.0, 2.0, 0.0], [9.0, 7.0, 0.0], [1.0, 7.0, 0.0]])
TWO_TRIANGLES = np.array([[0, 2, 1], [0, 3, 2]])


def brute_force(vertices, triangles, height, width):
    """Test every pixel against every triangle by solving for its barycentric coordinates."""
    covered = np.zeros((height, width), bool)
    depth = np.full((height, width), np.inf)
    y, x = np.mgrid[:height, :width] + 0.5
    points = np.stack([x, y, np.ones_like(x)])
    for corners in vertices[triangles]:
        matrix = np.vstack([corners[:, :2].T, np.ones(3)])
        weights = np.linalg.solve(matrix, points.reshape(3, -1)).reshape(3, height, width)
        z = np.tensordot(corners[:, 2], weights, 1)
        nearer = (weights >= 0).all(axis=0) & (z < depth)
        covered |= nearer
        depth[nearer] = z[nearer]
    return covered, depth


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 30))
def test_agrees_with_brute_force_on_random_triangles(seed, count):
    rng = np.random.default_rng(seed)
    vertices = rng.uniform(-8.0, 40.0, (20, 3))
    triangles = np.array([rng.choice(20, 3, replace=False) for _ in range(count)])
    raster = rasterize(vertices, triangles, 31, 27)
    covered, depth = brute_force(vertices, triangles, 31, 27)
    assert np.array_equal(raster.triangle >= 0, covered)
    z = interpolate(raster, triangles, vertices[:, 2:])[..., 0]
    assert np.allclose(z[covered], depth[covered], rtol=1e-5, atol=1e-3)


def test_pixel_centers_lie_at_one_half():
    raster = rasterize(SQUARE, TWO_TRIANGLES, 10, 12)
    covered = np.zeros((10, 12), bool)
    covered[2:7, 1:9] = True
    assert np.array_equal(raster.triangle >= 0, covered)
    position = interpolate(raster, TWO_TRIANGLES, SQUARE)
    assert np.allclose(position[4, 3, :2], (3.5, 4.5), atol=1e-5)


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 2**32 - 1))
def test_shared_edges_leave_no_gap_and_no_overlap(seed):
    """A fan of triangles around pixel centers covers each center of its square exactly once."""
    rng = np.random.default_rng(seed)
    hub = rng.integers(3, 17, 2) + 0.5
    rim = np.array([[0, 0], [7, 0], [20, 0], [20, 11], [20, 20], [4, 20], [0, 20], [0, 13]])
    vertices = np.column_stack([np.vstack([rim, hub]), np.zeros(9)])
    fan = [np.array([[8, k, (k + 1) % 8]]) for k in range(8)]
    times = sum((rasterize(vertices, one, 20, 20).triangle >= 0).astype(int) for one in fan)
    assert (times == 1).all()


def test_the_nearer_triangle_hides_the_farther_in_any_order():
    near = SQUARE - (0, 0, 1)
    vertices = np.vstack([SQUARE, near])
    back_first = np.vstack([TWO_TRIANGLES, TWO_TRIANGLES + 4])
    front_first = np.vstack([TWO_TRIANGLES + 4, TWO_TRIANGLES])
    for triangles in (back_first, front_first):
        raster = rasterize(vertices, triangles, 10, 12)
        z = interpolate(raster, triangles, vertices[:, 2:])
        assert np.array_equal(np.unique(z[np.isfinite(z)]), [-1.0])


def test_interpolation_is_exact_for_linear_functions_and_nan_outside():
    rng = np.random.default_rng(0)
    vertices = np.column_stack([rng.uniform(0, 50, (30, 2)), np.zeros(30)])
    triangles = np.arange(30).reshape(10, 3)
    function = vertices[:, :2] @ rng.normal(size=(2, 4)) + rng.normal(size=4)
    raster = rasterize(vertices, triangles, 50, 50)
    values = interpolate(raster, triangles, np.column_stack([vertices[:, :2], function]))
    outside = raster.triangle < 0
    assert outside.any()
    assert (~outside).any()
    assert np.isnan(values[outside]).all()
    assert np.isnan(raster.barycentric[outside]).all()
    rows, columns = np.nonzero(~outside)
    centers = np.column_stack([columns, rows]) + 0.5
    assert np.allclose(values[~outside][:, :2], centers, atol=1e-3)
    assert np.allclose(raster.barycentric[~outside].sum(axis=1), 1.0, atol=1e-5)


def test_triangles_without_area_or_with_undefined_vertices_cover_nothing():
    line = np.array([[0, 0, 0], [5, 5, 0], [10, 10, 0.0]])
    undefined = np.array([[0, 0, 0], [9, np.nan, 0], [0, 9, 0]])
    no_depth = np.array([[0, 0, 0], [9, 0, np.inf], [0, 9, 0]])
    for vertices in (line, undefined, no_depth):
        assert (rasterize(vertices, [[0, 1, 2]], 10, 10).triangle == -1).all()
    assert (rasterize(line, np.empty((0, 3), int), 10, 10).triangle == -1).all()


def test_a_triangle_far_larger_than_the_image_covers_it_all():
    vertices = np.array([[-1e7, -1e7, 3], [3e7, -1e7, 3], [-1e7, 3e7, 3.0]])
    assert (rasterize(vertices, [[0, 1, 2]], 8, 9).triangle == 0).all()


def uv_sphere(rows: int = 24, columns: int = 48):
    polar, azimuth = np.meshgrid(
        np.linspace(0.1, np.pi - 0.1, rows), np.arange(columns) * 2 * np.pi / columns, indexing="ij"
    )
    xyz = np.stack(
        [np.sin(polar) * np.cos(azimuth), np.cos(polar), np.sin(polar) * np.sin(azimuth)], -1
    ).reshape(-1, 3)
    i, j = (k.ravel() for k in np.mgrid[: rows - 1, :columns])
    a, b = i * columns + j, i * columns + (j + 1) % columns
    triangles = np.vstack(
        [np.column_stack([a, b, b + columns]), np.column_stack([a, b + columns, a + columns])]
    )
    return xyz, triangles


def test_normals_of_a_sphere_point_outward_in_camera_axes():
    outward, triangles = uv_sphere()
    pixels = 50.0 + 30.0 * outward * (1, -1, -1)
    normals = vertex_normals(pixels, triangles)
    inner = np.abs(outward[:, 1]) < 0.98
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0)
    assert ((normals * outward).sum(axis=1)[inner] > np.cos(np.deg2rad(1.0))).all()


def test_a_square_facing_the_camera_has_normal_plus_z():
    assert np.allclose(vertex_normals(SQUARE, TWO_TRIANGLES), (0.0, 0.0, 1.0))


def test_normals_are_weighted_by_area():
    """A corner of a large wall (3 times the area) and a small floor leans to the wall."""
    vertices = np.array([[0, 0, 0], [0, -3, 0], [2, 0, 0], [0, 0, -1.0]])
    wall, floor = [0, 2, 1], [0, 3, 2]
    normal = vertex_normals(vertices, [wall, floor])[0]
    assert normal == pytest.approx(np.array([0.0, 1.0, 3.0]) / np.sqrt(10.0))


def test_a_vertex_without_triangle_has_no_normal():
    normals = vertex_normals(np.vstack([SQUARE, [[0, 0, 0]]]), TWO_TRIANGLES)
    assert np.isnan(normals[4]).all()
    assert np.isfinite(normals[:4]).all()
