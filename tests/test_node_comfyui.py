"""ComfyUI's nodes through the interface that it publishes: tensors in, tensors out, messages."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import linear_face

from facecrf_ocio import write_lut
from facecrf_ocio.synthetic import encode, gamma_curve

torch = pytest.importorskip("torch")
FOLDER = Path(__file__).parents[1] / "nodes" / "comfyui"
CURVE = gamma_curve(2.2)


@pytest.fixture(scope="module")
def nodes():
    """The folder, imported as ComfyUI imports custom nodes: by path, as a package."""
    spec = importlib.util.spec_from_file_location("comfy_facecrf", FOLDER / "__init__.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["comfy_facecrf"] = module
    spec.loader.exec_module(module)
    return module.NODE_CLASS_MAPPINGS


def run(node, **inputs):
    one = node()
    return getattr(one, node.FUNCTION)(**inputs)


def batch(*arrays):
    return torch.from_numpy(np.stack(arrays).astype(np.float32))


def test_every_node_has_what_comfyui_asks_for(nodes):
    for node in nodes.values():
        assert set(node.INPUT_TYPES()) <= {"required", "optional", "hidden"}
        assert callable(getattr(node, node.FUNCTION))
        assert isinstance(node.RETURN_TYPES, tuple)
        assert node.CATEGORY


def test_the_workflow_links_nodes_by_types_that_fit(nodes):
    workflow = json.loads((FOLDER / "linearize_photo.json").read_text())
    known = {"LoadImage": ("IMAGE", "MASK"), "PreviewImage": ()}
    for one in workflow.values():
        if one["class_type"] in known:
            continue
        wanted = nodes[one["class_type"]].INPUT_TYPES()["required"]
        assert set(one["inputs"]) == set(wanted)
        for name, value in one["inputs"].items():
            if isinstance(value, list):
                source = workflow[value[0]]["class_type"]
                types = known.get(source) or nodes[source].RETURN_TYPES
                assert types[value[1]] == wanted[name][0]


def test_values_above_one_reach_the_exr(nodes, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    linear = batch(np.full((8, 6, 3), 3.5), np.full((8, 6, 3), 0.25))
    told = run(nodes["FaceCRFSaveEXR"], linear=linear, name="a")
    again = run(nodes["FaceCRFSaveEXR"], linear=linear[:1], name="a")
    names = [Path(p).name for p in told["ui"]["text"] + again["ui"]["text"]]
    assert names == ["a.0001.exr", "a.0002.exr", "a.0003.exr"]
    assert oiio.ImageBuf(str(tmp_path / "a.0001.exr")).get_pixels().max() == 3.5


def test_encode_is_the_way_back_for_every_image_of_a_batch(nodes):
    codes = np.random.default_rng(0).random((2, 5, 4, 3)).astype(np.float32)
    linear = batch(*CURVE.linearize(codes))
    (back,) = run(nodes["FaceCRFEncode"], linear=linear, curve=CURVE)
    assert back.shape == (2, 5, 4, 3)
    assert back.dtype == torch.float32
    assert np.abs(back.numpy() - codes).max() < 1e-4


def test_a_lut_file_is_applied(nodes, tmp_path):
    write_lut(CURVE, tmp_path / "a.spi1d")
    image = batch(np.full((4, 4, 3), 0.5))
    (linear,) = run(nodes["FaceCRFApplyLUT"], image=image, lut=str(tmp_path / "a.spi1d"))
    assert linear.numpy() == pytest.approx(0.5**2.2, abs=1e-4)
    with pytest.raises(Exception, match=r"none\.spi1d"):
        run(nodes["FaceCRFApplyLUT"], image=image, lut=str(tmp_path / "none.spi1d"))


def test_an_image_without_a_face_is_told_in_a_sentence(nodes):
    flat = batch(np.full((64, 64, 3), 0.5))
    with pytest.raises(Exception, match=r"color|face"):
        run(nodes["FaceCRFLinearizePhoto"], image=flat)
    with pytest.raises(Exception, match="linear already"):
        run(nodes["FaceCRFLinearizePhoto"], image=4.0 * flat)


@pytest.mark.slow
def test_a_photo_is_linearized_with_its_curve_and_what_to_expect(nodes):
    codes = np.rint(encode(np.clip(linear_face(1), 0, 1), CURVE) * 255) / 255
    linear, curve, expected, says = run(nodes["FaceCRFLinearizePhoto"], image=batch(codes))
    assert np.abs(linear.numpy()[0] - curve.linearize(codes)).max() < 1e-5
    assert 0.0 < expected < 2.0
    assert says.startswith("calibrated")
