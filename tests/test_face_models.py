"""The vendored models are the ones their README names, and their licenses are with them."""

from __future__ import annotations

import re
from importlib import metadata
from itertools import pairwise

import numpy as np
import pytest

from facecrf_ocio.errors import FaceCRFError
from facecrf_ocio.face import networks, regions
from facecrf_ocio.face.geometry import mesh_triangles
from facecrf_ocio.face.networks import MODELS, load_network, model_file
from facecrf_ocio.files.content import sha256_of

SUMS = dict(
    reversed(line.split())
    for line in (MODELS / "SHA256SUMS").read_text(encoding="ascii").splitlines()
)
WEIGHTS = sorted(
    p.name.removesuffix(".halves")
    for p in MODELS.iterdir()
    if p.suffix in {".onnx", ".halves", ".npz"}
)


def test_every_model_is_listed():
    assert sorted(SUMS) == WEIGHTS
    readme = (MODELS / "README.md").read_text(encoding="utf-8")
    assert all(f"`{name}`" in readme for name in WEIGHTS)


@pytest.mark.parametrize("name", WEIGHTS)
def test_digest_holds(name):
    with model_file(name) as path:
        assert path.name == name
        assert sha256_of(path) == SUMS[name]


def test_a_model_that_is_not_the_one_that_ships_is_not_loaded(tmp_path, monkeypatch):
    for file in MODELS.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    name = "face_landmarks_detector.tflite"
    stored = tmp_path / f"{name}.halves"
    content = bytearray(stored.read_bytes())
    content[len(content) // 2] ^= 1
    stored.write_bytes(content)
    monkeypatch.setattr(networks, "MODELS", tmp_path)
    said = re.escape(f"{tmp_path / name}: is not the model that ships; install facecrf-ocio again")
    with pytest.raises(FaceCRFError, match=said):
        networks.Network(name, "Identity")
    with pytest.raises(FaceCRFError, match="not the model"), model_file("unlisted.onnx"):
        pass


def test_licenses_are_shipped():
    mit = (MODELS / "LICENSE.YuNet").read_text(encoding="utf-8")
    assert "Shenzhen Institute of Artificial Intelligence and Robotics for Society" in mit
    root = MODELS.parents[2] / "LICENSE"
    installed = metadata.distribution("facecrf-ocio").read_text
    apache = root.read_text("utf-8") if root.is_file() else installed("licenses/LICENSE")
    assert apache is not None
    assert "Version 2.0, January 2004" in apache
    assert "END OF TERMS AND CONDITIONS" in apache


def test_a_network_is_loaded_once():
    names = ("face_landmarks_detector.tflite", "Identity", "Identity_1")
    assert load_network(*names) is load_network(*names)


def test_mesh_is_one_disk_that_faces_the_camera():
    triangles = mesh_triangles()
    edges = {(a, b) for t in triangles.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True)}
    assert len(edges) == 3 * len(triangles)  # no edge is walked twice the same way
    undirected = {frozenset(edge) for edge in edges}
    assert 468 - len(undirected) + len(triangles) == 1  # Euler characteristic of a disk
    with np.load(MODELS / "canonical_face_mesh.npz") as mesh:
        corners = mesh["vertices_cm"][triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0)
    assert area[2] > 10 * np.abs(area[:2]).max()


@pytest.mark.parametrize("region", ["EYE", "LIDS", "BROW", "NOSTRIL"])
def test_right_and_left_regions_mirror_each_other(region):
    with np.load(MODELS / "canonical_face_mesh.npz") as mesh:
        vertices = mesh["vertices_cm"]
    right, left = (vertices[list(getattr(regions, f"{s}_{region}"))] for s in ("RIGHT", "LEFT"))
    assert np.allclose(right * (-1.0, 1.0, 1.0), left, atol=0.02)
    assert (right[:, 0] < 0).all()


def test_features_are_in_their_order_from_brow_to_lips():
    with np.load(MODELS / "canonical_face_mesh.npz") as mesh:
        y = mesh["vertices_cm"][:, 1]
    names = ("RIGHT_BROW", "RIGHT_EYE", "RIGHT_NOSTRIL", "LIPS")
    heights = [y[list(getattr(regions, name))] for name in names]
    for above, below in pairwise(heights):
        assert above.min() > below.max()
