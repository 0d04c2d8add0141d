"""`facecrf bench synthetic` on two small synthetic faces and three curves."""

from __future__ import annotations

import csv
import json
from dataclasses import replace

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from click.testing import CliRunner
from drawn_curves import write_drawn_curves

from facecrf_ocio.benchmark import bench_processes, workbench
from facecrf_ocio.benchmark.cases import Case, PhotoCases, Plan, choose_estimators
from facecrf_ocio.benchmark.folds import training_rows
from facecrf_ocio.benchmark.images import find_linear_images
from facecrf_ocio.benchmark.responses import read_responses, spread_rows
from facecrf_ocio.benchmark.store import Store
from facecrf_ocio.benchmark.table1 import run_synthetic
from facecrf_ocio.benchmark.tables import summarize
from facecrf_ocio.benchmark.virtual_camera import CameraEncoding
from facecrf_ocio.benchmark.workbench import CaseResult, Workbench
from facecrf_ocio.cli.bench_command import bench
from facecrf_ocio.errors import FaceCRFError
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import SyntheticSpec, render_face

COMPARED = ("table.md", "table.csv", "cases.csv", "results.json")
SMALL = SyntheticSpec(height=300, width=250, face_width=150.0)


def write_exr(path, linear):
    height, width, _ = linear.shape
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), oiio.ImageSpec(width, height, 3, "float"))
    assert file.write_image(np.ascontiguousarray(linear, dtype=np.float32))
    file.close()


@pytest.fixture(scope="module")
def faces(tmp_path_factory):
    folder = tmp_path_factory.mktemp("faces")
    for seed in (1, 2):
        write_exr(folder / f"face_{seed}.exr", render_face(replace(SMALL, seed=seed)).linear)
    return folder


@pytest.fixture(scope="module")
def curves(tmp_path_factory):
    return write_drawn_curves(tmp_path_factory.mktemp("curves") / "curves.npz")


@pytest.fixture
def plan(faces, curves):
    responses = read_responses(curves)
    return Plan(
        images=find_linear_images(faces).images,
        responses=responses,
        rows=spread_rows(len(responses.inverse), limit=3),
        estimators=choose_estimators("face"),
        folds=3,
    )


def command(faces, curves, output, *options):
    given = ("--faces", faces, "--curves", curves, "-o", output, "--limit-curves", 3, "--folds", 3)
    return CliRunner().invoke(bench, ["synthetic", *map(str, (*given, *options))])


def made(folder):
    return {name: (folder / name).read_bytes() for name in COMPARED}


@pytest.fixture(scope="module")
def whole(faces, curves, tmp_path_factory):
    """The output of a run that nothing interrupted."""
    output = tmp_path_factory.mktemp("whole")
    result = command(faces, curves, output, "--estimators", "mean,srgb,face")
    assert result.exit_code == 0, result.output
    return output, result


def read_csv(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
def test_held_out_is_printed_first_and_every_estimator_has_a_row(whole):
    _, result = whole
    text = result.stdout
    assert text.index("Held-out protocol") < text.index("Paper protocol")
    for name in ("face", "mean", "srgb", "gamma22", "identity"):
        assert text.count(f"| {name} ") == 7  # two tables, two of percentiles each, and the times


@pytest.mark.slow
def test_csv_and_json_hold_the_same_cases(whole):
    folder, _ = whole
    cases = read_csv(folder / "cases.csv")
    record = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert len(cases) == len(record["cases"]) == 2 * 5 * 2 * 3
    for from_csv, from_json in zip(cases, record["cases"], strict=True):
        assert float(from_csv["rmse"]) == from_json["rmse"]
        assert from_csv["estimator"] == from_json["estimator"]
        assert "seconds" not in from_csv
    for from_csv, from_json in zip(read_csv(folder / "table.csv"), record["table"], strict=True):
        rmse = [
            float(case["rmse"])
            for case in cases
            if (case["protocol"], case["estimator"])
            == (from_csv["protocol"], from_csv["estimator"])
        ]
        assert float(from_csv["rmse_median"]) == from_json["rmse_median"] == np.median(rmse)
        assert float(from_csv["rmse_std"]) == pytest.approx(np.std(rmse))


@pytest.mark.slow
def test_everything_needed_to_repeat_it_is_told(whole, faces, curves):
    run = json.loads((whole[0] / "results.json").read_text(encoding="utf-8"))["run"]
    assert run["seed"] == 0
    assert run["settings"]["face_width"] == Settings().face_width
    assert run["encoding"] == {"bits": 8, "jpeg": None, "iso": None}
    assert run["images"] == {i.name: i.sha256 for i in find_linear_images(faces).images}
    assert run["responses"]["sha256"] == read_responses(curves).sha256
    assert run["responses"]["rows"] == [0, 20, 40]
    assert run["held_out"]["fold_of_row"] == [0] * 20 + [1] * 20 + [2] * 20
    assert run["versions"]["numpy"] == np.__version__


@pytest.mark.slow
def test_interrupted_and_resumed_by_two_processes_gives_the_same_bytes(whole, plan, tmp_path):
    def stop_after_20(done, total):
        if done >= 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_synthetic(plan, tmp_path, progress=stop_after_20)
    assert not (tmp_path / "table.csv").exists()
    stored = (tmp_path / "cases.jsonl").read_bytes()
    assert 20 <= stored.count(b"\n") < 60
    (tmp_path / "cases.jsonl").write_bytes(stored + stored[:100])  # killed while writing

    seen = []
    run_synthetic(plan, tmp_path, jobs=2, progress=lambda done, total: seen.append(done))
    assert seen[0] == stored.count(b"\n")  # nothing was measured twice
    assert (tmp_path / "cases.jsonl").read_bytes().startswith(stored)
    assert made(tmp_path) == made(whole[0])


@pytest.mark.slow
def test_a_package_edited_meanwhile_stores_nothing(plan, tmp_path, monkeypatch):
    monkeypatch.setattr(bench_processes, "code_digest", lambda: "as it was when the run began")
    with pytest.raises(FaceCRFError, match="the package was changed"):
        run_synthetic(plan, tmp_path)
    assert not (tmp_path / "cases.jsonl").exists()


@pytest.mark.slow
def test_a_finished_bench_measures_nothing_again(whole, faces, curves, monkeypatch):
    folder, _ = whole
    before = made(folder)
    monkeypatch.setattr(bench_processes, "ProcessPoolExecutor", None)
    assert command(faces, curves, folder, "--estimators", "face").exit_code == 0
    assert made(folder) == before


def test_error_of_the_mean_curve_is_that_computed_directly(plan):
    """Under the held-out protocol the mean is that of the curves that may be seen."""
    table = Workbench(plan)
    row = plan.rows[1]
    seen = training_rows(plan.responses, plan.fold_of(), 1)
    assert not set(range(20, 40)) & set(seen.tolist())
    means = {
        "paper": dorf_model().mean,
        "held-out": plan.responses.inverse[seen, 0].mean(axis=0),
    }
    for protocol, mean in means.items():
        (result,) = table.measure(PhotoCases(0, row, (Case(protocol, "mean", 0, row),)))
        direct = np.sqrt(((mean - plan.responses.inverse[row, 0]) ** 2).mean())
        assert result.rmse == pytest.approx(direct, abs=1e-5)
        assert result.fold == (1 if protocol == "held-out" else None)


def test_a_refusal_counts_as_one_and_is_scored_as_the_mean_curve(plan, tmp_path):
    write_exr(tmp_path / "flat.exr", np.full((120, 100, 3), 0.2))
    without_face = replace(plan, images=find_linear_images(tmp_path).images)
    cases = tuple(Case("paper", name, 0, 0) for name in ("face", "mean"))
    face, mean = Workbench(without_face).measure(PhotoCases(0, 0, cases))
    assert not face.answered
    assert mean.answered
    assert face.outcome == "not calibrated"
    assert face.rmse == mean.rmse
    (row, _) = summarize([face, mean])
    assert (row.refused, row.failed, row.answered_mean) == (1.0, 0.0, None)


def test_an_estimator_that_breaks_down_does_not_end_the_run(plan, monkeypatch):
    usual = workbench.calibrate

    def broken(photo, *, estimator, **others):
        if estimator == "face":
            raise ZeroDivisionError("no skin")
        return usual(photo, estimator=estimator, **others)

    monkeypatch.setattr(workbench, "calibrate", broken)
    (result,) = Workbench(plan).measure(PhotoCases(0, 0, (Case("paper", "face", 0, 0),)))
    assert result.outcome == "failed"
    assert result.reason == "ZeroDivisionError: no skin"
    assert summarize([result])[0].failed == 1.0


def test_noise_is_the_same_for_the_same_seed_only(plan):
    noisy = replace(plan, encoding=CameraEncoding(iso=800), seed=3)
    first, again = (Workbench(noisy).photograph(1, 20).encoded for _ in range(2))
    np.testing.assert_array_equal(first, again)
    assert (Workbench(replace(noisy, seed=4)).photograph(1, 20).encoded != first).any()


def test_keys_change_with_whatever_a_result_depends_on(plan):
    keys = plan.keys()
    assert len(set(keys.values())) == len(keys) == 2 * 5 * 2 * 3
    others = (
        replace(plan, seed=1),
        replace(plan, encoding=CameraEncoding(jpeg=92)),
        replace(plan, settings=Settings(face_width=200)),
        replace(plan, responses=replace(plan.responses, sha256="1" * 64)),
        replace(plan, images=tuple(replace(i, sha256="2" * 64) for i in plan.images)),
    )
    for other in others:
        assert not set(other.keys().values()) & set(keys.values())
    refolded = replace(plan, folds=4).keys()
    assert all((refolded[case] == key) == (case.protocol == "paper") for case, key in keys.items())


def test_the_store_forgets_only_what_is_damaged(tmp_path):
    result = CaseResult("paper", "mean", "a.exr", 0, "row 0", "", "", None, "fallback", "", True,
                    "", 0.1, 0.2, None, 0.0, 0.1, 0.1, 0.1, 0.1, 1 / 3, 0.9, None, None, None,
                    0.01)  # fmt: skip
    path = tmp_path / "new" / "cases.jsonl"
    store = Store(path, CaseResult)
    store.append({"a": result, "b": result})
    content = path.read_bytes()
    path.write_bytes(content.replace(b'{"key": "a"', b"{damaged") + b'{"key": "c", "proto')
    again = Store(path, CaseResult)
    assert again.results == {"b": result}
    again.append({"d": result})
    assert Store(path, CaseResult).results == {"b": result, "d": result}


@pytest.mark.parametrize(
    ("options", "code", "message"),
    [
        (("--estimators", "wrong"), 2, "no estimator wrong"),
        (("--jpeg", "90", "--bits", "16"), 2, "a JPEG has 8 bits"),
        (("--set", "wrong=1"), 2, "no setting 'wrong'"),
        (("--set", "face_width=wide"), 2, "'wide' is no value of face_width"),
        (("--curves", "missing.npz"), 3, "missing.npz: no such file"),
        (("--groups", "missing.tsv", "tone"), 3, "missing.tsv: no such file"),
        (("--faces", "missing"), 3, "missing: holds no images"),
    ],
)
def test_wrong_usage_is_told_in_one_line(faces, curves, tmp_path, options, code, message):
    result = command(faces, curves, tmp_path / "out", *options)
    assert result.exit_code == code
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()
