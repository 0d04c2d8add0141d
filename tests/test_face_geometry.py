"""Normals against closed forms and rendered truth; the mask against features and true skin."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from face_photos import grace_hopper, rendered_heads
from matplotlib.path import Path as Polygon

from facecrf_ocio.face import regions
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.geometry import face_geometry
from facecrf_ocio.face.networks import MODELS
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Face

RADII = np.array([150.0, 200.0, 90.0])  # [px] of the ellipsoid that wears the mesh
CENTER = np.array([160.0, 210.0, 300.0])
STUBBLED = "dev_10"  # its truth counts the stubble on chin and jaw as not skin


def with_landmarks(points):
    """A face with these 468 mesh vertices; the irises do not matter."""
    return Face(np.array([0.0, 0.0, 1.0, 1.0]), np.vstack([points, np.zeros((10, 3))]), 1.0)


def on_ellipsoid():
    """The mesh spread over the front of an ellipsoid by its texture coordinates, free of folds."""
    with np.load(MODELS / "canonical_face_mesh.npz") as mesh:
        uv, vertices = mesh["uv"].astype(float), mesh["vertices_cm"]
    down = np.sign(np.corrcoef(uv[:, 1], -vertices[:, 1])[0, 1])
    xy = 1.6 * (uv - 0.5) * (1.0, down) * RADII[:2]
    z = -RADII[2] * np.sqrt(1.0 - (xy**2 / RADII[:2] ** 2).sum(axis=1))
    return with_landmarks(np.column_stack([xy, z]) + CENTER)


@pytest.fixture(scope="module")
def portrait():
    (face,) = find_faces(grace_hopper(), Settings()).faces
    return face


def angles(a, b):
    cosine = (a * b).sum(axis=-1) / np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1)
    return np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))


def test_normals_of_an_ellipsoid():
    geometry = face_geometry(on_ellipsoid(), (420, 320))
    inside = np.isfinite(geometry.normals[..., 0])
    rows, columns = np.nonzero(inside)
    x, y = columns + 0.5 - CENTER[0], rows + 0.5 - CENTER[1]
    z = RADII[2] * np.sqrt(1.0 - (x / RADII[0]) ** 2 - (y / RADII[1]) ** 2)  # toward the camera
    truth = np.column_stack([x, -y, z]) / RADII**2
    error = angles(geometry.normals[inside], truth)
    assert inside.sum() > 30000
    assert error.mean() < 1.0
    assert np.quantile(error, 0.99) < 5.0


def test_normals_are_unit_and_nan_outside(portrait):
    geometry = face_geometry(portrait, grace_hopper().shape[:2])
    length = np.linalg.norm(geometry.normals, axis=2)
    inside = np.isfinite(length)
    assert np.allclose(length[inside], 1.0, atol=1e-5)
    assert np.array_equal(inside, np.isfinite(geometry.normals).any(axis=2))
    assert not geometry.bare_skin[~inside].any()


def test_normals_follow_the_sides_of_a_face(portrait):
    """The subject's right cheek looks to the left of the photo, and the chin down."""
    geometry = face_geometry(portrait, grace_hopper().shape[:2])

    def normal_at(vertex):
        column, row = np.floor(portrait.landmarks_xyz[vertex, :2]).astype(int)
        return geometry.normals[row, column]

    right_cheek, left_cheek, forehead, chin = 50, 280, 151, 175
    assert normal_at(right_cheek)[0] < -0.2
    assert normal_at(left_cheek)[0] > 0.2
    assert normal_at(left_cheek)[2] > 0.5
    assert normal_at(forehead)[2] > 0.8
    assert normal_at(chin)[1] < normal_at(forehead)[1]


def test_grid_is_a_window_onto_the_photo(portrait):
    whole = face_geometry(portrait, grace_hopper().shape[:2])
    cut = face_geometry(portrait, (250, 220), origin=(170.0, 110.0))
    window = (slice(110, 360), slice(170, 390))
    assert np.allclose(cut.normals, whole.normals[window], atol=1e-5, equal_nan=True)
    # The mask of a cut knows nothing beyond it, but what matters here lies inside.
    assert (cut.bare_skin == whole.bare_skin[window]).mean() > 0.999


def test_normals_do_not_depend_on_the_scale(portrait):
    fine = face_geometry(portrait, (500, 440), origin=(170.0, 110.0), scale=2.0).normals
    coarse = face_geometry(portrait, (250, 220), origin=(170.0, 110.0)).normals
    averaged = cv2.resize(fine, (220, 250), interpolation=cv2.INTER_AREA)
    both = np.isfinite(averaged[..., 0]) & np.isfinite(coarse[..., 0])
    assert angles(averaged[both], coarse[both]).mean() < 0.5


def test_vertices_are_on_the_grid(portrait):
    geometry = face_geometry(portrait, (125, 110), origin=(170.0, 110.0), scale=0.5)
    back = geometry.vertices / 0.5 + (170.0, 110.0, 0.0)
    assert np.allclose(back, portrait.landmarks_xyz[:468])
    assert geometry.triangles.shape == (898, 3)


def test_a_face_outside_of_the_grid_covers_nothing(portrait):
    geometry = face_geometry(portrait, (50, 60), origin=(-5000.0, 0.0))
    assert not geometry.bare_skin.any()
    assert np.isnan(geometry.normals).all()


FEATURES = ("RIGHT_EYE", "LEFT_EYE", "RIGHT_BROW", "LEFT_BROW", "LIPS", "RIGHT_NOSTRIL")


@pytest.mark.parametrize("name", FEATURES)
def test_bare_skin_keeps_its_distance_from_features(portrait, name):
    geometry = face_geometry(portrait, (500, 440), origin=(170.0, 110.0), scale=2.0)
    outline = Polygon(geometry.vertices[list(getattr(regions, name)), :2])
    rows, columns = np.nonzero(geometry.bare_skin)
    centers = np.column_stack([columns, rows]) + 0.5
    margin = 0.008 * 2.0 * 170.0
    inside = outline.contains_points(centers, radius=margin)
    inside |= outline.contains_points(centers, radius=-margin)  # its sign follows the winding
    assert not inside.any()


def test_bare_skin_is_most_of_the_face(portrait):
    geometry = face_geometry(portrait, grace_hopper().shape[:2])
    share = geometry.bare_skin.sum() / np.isfinite(geometry.normals[..., 0]).sum()
    assert 0.5 < share < 0.85
    assert (geometry.normals[geometry.bare_skin][:, 2] > np.cos(np.radians(75.0))).all()


@pytest.mark.slow
def test_rendered_heads(development_data):
    """Normals within the measured 9.3 degrees on average, and what is called skin is skin."""
    errors = {}
    for head in rendered_heads(development_data):
        (face,) = find_faces(head.encoded, Settings()).faces
        geometry = face_geometry(face, head.encoded.shape[:2])
        bare, skin = geometry.bare_skin, head.skin > 0.5
        if head.name == STUBBLED:
            above_the_mouth = np.arange(len(bare)) < face.landmarks_xyz[2, 1]
            bare = bare & above_the_mouth[:, None]
        assert skin[bare].mean() > 0.98, head.name
        known = bare & skin & (np.linalg.norm(head.normals, axis=2) > 0.9)
        errors[head.name] = angles(geometry.normals[known], head.normals[known]).mean()
    assert len(errors) == 12
    assert np.mean(list(errors.values())) < 9.6
    assert max(errors.values()) < 12.5
