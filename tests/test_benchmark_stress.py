"""`facecrf bench stress`: which photos are taken, and what the table says of them."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from click.testing import CliRunner
from photo_files import write

from facecrf_ocio.benchmark.images import LinearImage
from facecrf_ocio.benchmark.responses import Responses
from facecrf_ocio.benchmark.stress import (
    StressBench,
    StressPlan,
    choose_cells,
    rows_of_kinds,
)
from facecrf_ocio.benchmark.stress_tables import stress_markdown
from facecrf_ocio.benchmark.workbench import CaseResult
from facecrf_ocio.cli.bench_command import bench
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.synthetic import SyntheticSpec, render_face

GRID = np.linspace(0.0, 1.0, 1024)
ONE = CaseResult("day", "auto", "a.exr", 0, "row 0", "Nikon", "camera_jpeg", 0, "calibrated",
             "reliable", True, "", 0.1, 0.2, 0.1, 0.02, 0.03, 0.03, 0.03, 0.03, 0.01, 0.9, 0.8,
             0.08, 0.2, 0.1)  # fmt: skip


def write_exr(path, linear):
    write(path, np.asarray(linear, np.float32), oiio.FLOAT)


def responses_of(tmp_path, kinds=("camera_jpeg", "phone_isp", "webcam")):
    exponents = np.linspace(1.8, 2.6, len(kinds))
    curves = GRID ** exponents[:, None, None] * np.ones((1, 3, 1))
    curves[:, 0] = GRID  # red is another
    makers = tuple(f"maker {number}" for number in range(len(kinds)))
    names = tuple(f"camera {number}" for number in range(len(kinds)))
    return Responses(curves, names, makers, tmp_path / "curves.npz", "0" * 64, tuple(kinds))


def plan_of(tmp_path, **changes):
    images = tuple(LinearImage(f"{n}.exr", tmp_path / f"{n}.exr", f"{n}" * 64) for n in range(4))
    plan = StressPlan("a title", images, responses_of(tmp_path), (0, 1, 2), choose_cells("all"))
    return replace(plan, count=8, **changes)


def test_all_cells_of_one_size_show_the_same_faces_through_the_same_responses(tmp_path):
    by_cell = {}
    for task in plan_of(tmp_path).tasks():
        by_cell.setdefault(task.cell, []).append((task.image, task.row))
    assert len(by_cell["day"]) == 24
    assert len(by_cell["12 MP"]) == 2
    assert by_cell["-3 EV"] == by_cell["JPEG 85 4:2:0"] == by_cell["as it is"]
    assert {image for image, _ in by_cell["as it is"]} == {0, 1, 2, 3}
    assert {row for _, row in by_cell["as it is"]} == {0, 1, 2}


def test_keys_tell_photos_apart_and_change_with_what_results_depend_on(tmp_path):
    plan = plan_of(tmp_path)
    keys = plan.keys()
    assert len(set(keys.values())) == len(keys)
    for other in (replace(plan, seed=1), replace(plan, green=True)):
        assert not set(other.keys().values()) & set(keys.values())
    fewer = replace(plan, cells=choose_cells("day, -1 EV")).keys()
    assert set(fewer.items()) <= set(keys.items())


def test_unknown_cells_and_kinds_are_told_with_the_known_ones(tmp_path):
    with pytest.raises(SettingsError, match="no cell night; known: all, day, as it is"):
        choose_cells("day,night")
    with pytest.raises(SettingsError, match="kind film; it has: camera_jpeg, phone_isp, webcam"):
        rows_of_kinds(responses_of(tmp_path), "film")
    assert rows_of_kinds(responses_of(tmp_path), "webcam, phone_isp") == (1, 2)


def test_noise_of_its_own_is_added_to_the_scene_without_any(tmp_path):
    for name, level in (("a_noisy", 0.2), ("a_clean", 0.4)):
        write_exr(tmp_path / f"{name}.exr", np.full((600, 600, 3), level, np.float32))
    image = LinearImage("a_noisy.exr", tmp_path / "a_noisy.exr", "0" * 64)
    plan = replace(plan_of(tmp_path), images=(image,), green=True)
    bench_of = StressBench(plan)
    photos = {
        task.cell: bench_of.photograph(task).encoded.mean()
        for task in plan.tasks()
        if task.cell in ("as it is", "0.3 MP") and task.row == 0
    }
    truth = plan.responses.inverse[0, 1]
    assert np.interp(photos["as it is"], GRID, truth) == pytest.approx(0.2, abs=0.01)
    assert np.interp(photos["0.3 MP"], GRID, truth) == pytest.approx(0.4, abs=0.01)


def test_cameras_and_phones_name_themselves_and_webcams_do_not(tmp_path):
    write_exr(tmp_path / "a.exr", np.full((600, 600, 3), 0.2, np.float32))
    image = LinearImage("a.exr", tmp_path / "a.exr", "0" * 64)
    plan = replace(plan_of(tmp_path), images=(image,), cells=choose_cells("as it is"))
    bench_of = StressBench(plan)
    makes = {task.row: bench_of.photograph(task).camera.make for task in plan.tasks()}
    assert makes == {0: "maker 0", 1: "samsung", 2: ""}


def lines_of(text):
    lines = [line for line in text.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_the_table_says_what_the_results_say():
    mids = np.linspace(0.02, 0.21, 20)
    ours = [
        replace(
            ONE, image=f"{n}.exr", mid=mid, rmse=mid / 2, verdict="reliable" if n < 15 else "weak"
        )
        for n, mid in enumerate(mids)
    ]
    srgb = [
        replace(r, estimator="srgb", verdict="", mid=0.125, band_stops=None, band_coverage=None)
        for r in ours
    ]
    text = stress_markdown("a title", [*ours, *srgb, *(replace(r, estimator="mean") for r in srgb)])
    lines = lines_of(text)
    day = dict(zip(lines[0], lines[2], strict=True))
    assert day["photos"] == "20"
    assert day["median"] == f"{np.median(mids):.3f}"
    assert day["mean"] == f"{mids.mean():.3f}"
    assert day["max"] == "0.210"
    assert day["< sRGB %"] == f"{100 * np.mean(mids < 0.125):.0f}"
    assert day["reliable %"] == "75"
    right = np.mean([mid <= 0.15 and mid < 0.125 for mid in mids[:15]])
    assert day["right %"] == f"{100 * right:.0f}"
    rmse = next(line for line in lines[6:] if line[0] == "day")
    assert rmse[2:4] == [f"{50 * np.median(mids):.1f}", f"{50 * mids.mean():.1f}"]
    assert [line[0] for line in lines if "day" in line[0]] == 2 * [
        *("day", "mean curve, day", "sRGB decoding, day")
    ]


@pytest.mark.slow
def test_the_command_writes_its_table_and_goes_on_where_it_was(tmp_path):
    face = render_face(SyntheticSpec(height=600, width=520, face_width=300.0, seed=1))
    (tmp_path / "faces").mkdir()
    write_exr(tmp_path / "faces" / "a.exr", face.linear)
    exponents = np.linspace(1.8, 2.6, 40)
    np.savez(tmp_path / "curves.npz", inverse=GRID ** exponents[:, None])
    given = ["stress", "--faces", str(tmp_path / "faces"), "--curves", str(tmp_path / "curves.npz"),
             "-o", str(tmp_path / "out"), "--count", "1"]  # fmt: skip
    first = CliRunner().invoke(bench, [*given, "--cells", "as it is"])
    assert first.exit_code == 0, first.output
    stored = (tmp_path / "out" / "stress.jsonl").read_bytes()
    more = CliRunner().invoke(bench, [*given, "--cells", "as it is,half size"])
    assert more.exit_code == 0, more.output
    assert (tmp_path / "out" / "stress.jsonl").read_bytes().startswith(stored)
    record = json.loads((tmp_path / "out" / "stress.json").read_text("utf-8"))
    assert [case["estimator"] for case in record["cases"]] == 2 * ["auto", "mean", "srgb"]
    assert (tmp_path / "out" / "stress.md").read_text("utf-8").strip() in more.stdout
    wrong = CliRunner().invoke(bench, [*given, "--kinds", "film"])
    assert wrong.exit_code == 2
    assert "no response of kind film" in wrong.output
