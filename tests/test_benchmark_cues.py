"""`facecrf bench cues`: cues left out, asked alone, and photos of one camera put together."""

from __future__ import annotations

import csv
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from photo_files import write

from facecrf_ocio.benchmark import joint_folds
from facecrf_ocio.benchmark.cases import PAPER, Plan
from facecrf_ocio.benchmark.cue_shares import run_cues
from facecrf_ocio.benchmark.images import find_linear_images
from facecrf_ocio.benchmark.joint_folds import CHARTS, DORF, FOLDS, MODERN, STACKS, joint_model
from facecrf_ocio.benchmark.metrics import score
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.benchmark.workbench import Workbench
from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.cli.bench_command import bench
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.joint import shipped_joint
from facecrf_ocio.joint.statistics import CUES
from facecrf_ocio.synthetic import SyntheticSpec, render_face

SMALL = SyntheticSpec(height=300, width=250, face_width=150.0)
GRID = np.linspace(0.0, 1.0, 1024)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("linear")
    for seed in (1, 2):
        write(made / f"{seed}.exr", render_face(replace(SMALL, seed=seed)).linear, "float")
    np.savez(made / "curves.npz", inverse=np.stack([GRID**2.0, GRID**2.4]))
    return made


@pytest.fixture(scope="module")
def measured(folder, tmp_path_factory):
    images = find_linear_images(folder, "*.exr").images
    plan = Plan(images, read_responses(folder / "curves.npz"), (0, 1), ("joint",), (PAPER,))
    text, files = run_cues(plan, tmp_path_factory.mktemp("cues"))
    with next(f for f in files if f.suffix == ".csv").open() as stream:
        return plan, text, list(csv.DictReader(stream))


def test_every_photo_is_judged_whole_and_with_each_cue_alone_and_left_out(measured):
    _, text, cases = measured
    for image in ("1.exr", "2.exr"):
        for row in ("0", "1"):
            of_photo = [c for c in cases if (c["image"], c["row"]) == (image, row)]
            assert sum(c["use"] == "all" for c in of_photo) == 1
            for use in ("alone", "without"):
                assert [c["cue"] for c in of_photo if c["use"] == use] == list(CUES)
    assert all(f"| {cue}" in text for cue in CUES)


def test_all_cues_are_what_calibrate_says(measured):
    plan, _, cases = measured
    photo = Workbench(plan).photograph(1, 0)
    curve = calibrate(photo, estimator="joint").curve
    counts = np.zeros((3, 256), dtype=np.int64)
    expected = score(curve, None, plan.responses.inverse[0], counts)
    found = next(c for c in cases if (c["use"], c["image"], c["row"]) == ("all", "2.exr", "0"))
    assert np.isclose(float(found["mid"]), expected.mid, rtol=1e-6)
    assert np.isclose(float(found["rmse"]), expected.rmse, rtol=1e-6)


def test_photos_of_one_response_are_judged_together(measured):
    _, text, cases = measured
    assert [c["row"] for c in cases if c["use"] == "together"] == ["0", "1"]
    assert "2 photos together, 2 responses: mean error in stops" in text


def test_the_command_writes_its_tables(folder, tmp_path):
    given = ["--faces", folder, "--pattern", "1.exr", "--curves", folder / "curves.npz"]
    options = ["--protocol", "paper", "--prior", "modern", "-o", tmp_path / "out"]
    result = CliRunner().invoke(bench, ["cues", *map(str, (*given, *options))])
    assert result.exit_code == 0, result.output
    assert {"cues.md", "cues.csv", "cues.json"} <= {p.name for p in (tmp_path / "out").iterdir()}


@pytest.mark.usefixtures("held_out_weights")
def test_what_was_trained_with_is_held_out_by_weights_without_it(folder):
    strange = read_responses(folder / "curves.npz")
    assert joint_model(strange, 1) is shipped_joint()
    for sha256 in (DORF, MODERN, STACKS, CHARTS):
        known = replace(strange, sha256=sha256)
        models = [joint_model(known, fold) for fold in range(FOLDS)]
        assert len({id(model) for model in (shipped_joint(), *models)}) == FOLDS + 1
        with pytest.raises(SettingsError, match="no weights without this fold"):
            joint_model(known, FOLDS)


def test_weights_that_are_not_here_are_missed_in_one_line(folder, tmp_path, monkeypatch):
    monkeypatch.setattr(joint_folds, "HELD_OUT", tmp_path / "none.npz")
    known = replace(read_responses(folder / "curves.npz"), sha256=STACKS)
    with pytest.raises(SettingsError, match="come with a checkout of the project"):
        joint_model(known, 0)
