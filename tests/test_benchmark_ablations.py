"""`facecrf bench ablations`: true answers help where they should, and a run can be continued."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from drawn_curves import write_drawn_curves

from facecrf_ocio.benchmark import ablations
from facecrf_ocio.benchmark.ablation import ABLATIONS, Ablated, Ablation, ablate
from facecrf_ocio.benchmark.truth import onto, synthetic_face, unit
from facecrf_ocio.cli.bench_command import bench
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.view import cut_face
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import encode, gamma_curve
from facecrf_ocio.values import Photo

GRID = np.linspace(0.0, 1.0, 1024)
TRUTH = np.tile(GRID**2.2, (3, 1))


@pytest.fixture(scope="module")
def known():
    return synthetic_face(1)


@pytest.fixture(scope="module")
def photo(known):
    return Photo(encode(known.linear, gamma_curve(2.2), 16), bit_depth=16)


def measured(ablation, known, photo):
    result = ablate(ablation, known, photo, TRUTH, dorf_model(), Settings())
    assert isinstance(result, Ablated)
    return result


def test_truth_is_carried_to_the_grid_of_the_view(known, photo):
    view = cut_face(photo, find_faces(photo.encoded, Settings()).faces[0], Settings())
    assert np.abs(onto(view, photo.encoded) - view.encoded).max() < 1e-5


def test_normals_have_length_one():
    normals = unit(np.array([[0.0, 3.0, 4.0], [0.0, 0.0, 0.0]]))
    assert np.allclose(normals, [[0.0, 0.6, 0.8], [0.0, 0.0, 1.0]])


def test_with_every_step_true_the_true_curve_has_almost_no_pigment_energy(known, photo):
    everything = next(a for a in ABLATIONS if a.name == "all four true")
    _, truth, identity, mean = measured(everything, known, photo).pigment_energy
    assert truth < 0.2 * identity
    assert truth < mean


def test_true_shading_tells_the_true_curve_from_the_identity(known, photo):
    def contrast(ablation):
        _, truth, identity, _ = measured(ablation, known, photo).pigment_energy
        return truth / identity

    pairs = Ablation("", mask=True, normals=True, pigments=True)
    assert contrast(replace(pairs, shading=True)) < 0.5 * contrast(pairs)


def test_without_a_face_the_reason_is_told(known):
    noise = np.random.default_rng(0).random((100, 100, 3), np.float32)
    result = ablate(Ablation(""), known, Photo(noise), TRUTH, dorf_model(), Settings())
    assert result == "no face found"


@pytest.fixture(scope="module")
def curves(tmp_path_factory):
    return write_drawn_curves(tmp_path_factory.mktemp("curves") / "curves.npz")


@pytest.mark.slow
def test_command_writes_its_table_and_goes_on_where_it_was(curves, tmp_path, monkeypatch):
    command = ["ablations", "--synthetic", "1", "--curves", str(curves), "--limit-curves", "1"]
    first = CliRunner().invoke(bench, [*command, "-o", str(tmp_path)])
    assert first.exit_code == 0, first.output
    table = (tmp_path / "ablations.md").read_bytes()
    record = json.loads((tmp_path / "ablations.json").read_text())
    assert [case["ablation"] for case in record["cases"]] == [a.name for a in ABLATIONS]

    lines = (tmp_path / "ablations.jsonl").read_text().splitlines(keepends=True)
    (tmp_path / "ablations.jsonl").write_text("".join(lines[:-2]) + lines[-2][:30])
    calls = []
    measure = ablations._measure
    monkeypatch.setattr(
        ablations, "_measure", lambda *given: calls.append(given[1].name) or measure(*given)
    )
    again = CliRunner().invoke(bench, [*command, "-o", str(tmp_path)])
    assert again.exit_code == 0, again.output
    assert calls == [a.name for a in ABLATIONS[-2:]]
    assert (tmp_path / "ablations.md").read_bytes() == table


def test_faces_are_needed(curves, tmp_path):
    result = CliRunner().invoke(bench, ["ablations", "--curves", str(curves), "-o", str(tmp_path)])
    assert result.exit_code == 2
    assert "no faces" in result.output
