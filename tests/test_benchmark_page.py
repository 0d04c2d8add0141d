"""The page of results says what the benches' folders hold."""

from __future__ import annotations

import json

from click.testing import CliRunner

from facecrf_ocio.benchmark.tables import LEGEND
from facecrf_ocio.cli.bench_command import bench

RUN = {
    "images": {"a.exr": "0", "b.exr": "1"},
    "responses": {"file": "dorf.mat", "rows": [0, 5, 9]},
    "encoding": {"bits": 8, "jpeg": None},
    "seed": 3,
    "code": "0123456789abcdef",
}


def run(*arguments):
    return CliRunner().invoke(bench, ["report", *map(str, arguments)])


def test_tables_findings_and_pictures_are_assembled(tmp_path):
    tables, figures = tmp_path / "tables", tmp_path / "figures"
    tables.mkdir()
    figures.mkdir()
    (tables / "table.md").write_text("| face | 1.0 |")
    (tables / "results.json").write_text(json.dumps({"run": RUN}))
    (figures / "fig4_skin.png").write_bytes(b"a picture")
    (tmp_path / "findings.md").write_text("What was found.")
    page = tmp_path / "out" / "RESULTS.md"
    result = run(figures, tables, "-o", page, "--findings", tmp_path / "findings.md")
    assert result.exit_code == 0, result.output
    text = page.read_text()
    assert text.index("What was found.") < text.index("fig4_skin.png") < text.index("| face |")
    assert "2 images, a.exr to b.exr, through 3 responses of dorf.mat (rows 0, 5 to 9)" in text
    assert "Measured with bits 8; seed 3; prior auto; code 0123456789ab." in text
    assert (page.parent / "results" / "fig4_skin.png").read_bytes() == b"a picture"
    before = page.read_bytes()
    assert run(figures, tables, "-o", page, "--findings", tmp_path / "findings.md").exit_code == 0
    assert page.read_bytes() == before


def test_what_the_columns_mean_is_told_once(tmp_path):
    folders = [tmp_path / name for name in "ab"]
    for folder in folders:
        folder.mkdir()
        (folder / "table.md").write_text(f"| face | 1.0 |\n\n{LEGEND}\n\n| dark | 2.0 |\n")
        (folder / "results.json").write_text(json.dumps({"run": RUN}))
    page = tmp_path / "RESULTS.md"
    assert run(*folders, "-o", page).exit_code == 0
    text = page.read_text()
    assert text.count(LEGEND) == 1
    assert text.count("| dark |") == text.count("| face |") == 2


def test_a_folder_without_results_is_refused(tmp_path):
    result = run(tmp_path, "-o", tmp_path / "RESULTS.md")
    assert result.exit_code == 3
    assert "holds no results of a bench" in result.stderr
    assert not (tmp_path / "RESULTS.md").exists()


def test_pairs_of_real_cameras_stand_under_their_own_heading(tmp_path):
    (tmp_path / "table.md").write_text("| joint | 3.7 |")
    run_record = {"pairs": [["a.dng", "a.jpg"]], "code": "0123456789abcdef"}
    (tmp_path / "results.json").write_text(json.dumps({"run": run_record}))
    assert run(tmp_path, "-o", tmp_path / "RESULTS.md").exit_code == 0
    text = (tmp_path / "RESULTS.md").read_text()
    assert "## Real cameras (Table 2): pairs of exposures, 1 in all\n\n| joint" in text
    assert "Code 0123456789ab." in text


def test_what_photos_go_through_and_real_photos_have_their_own_headings(tmp_path):
    run_of = {
        "stress": {key: RUN[key] for key in ("images", "responses", "seed", "code")},
        "consistency": {"photos": 18, "code": "0123456789abcdef"},
    }
    for name, said in run_of.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / f"{name}.md").write_text(f"| {name} | 0.07 |")
        (tmp_path / name / f"{name}.json").write_text(json.dumps({"run": said}))
    page = tmp_path / "RESULTS.md"
    assert run(tmp_path / "stress", tmp_path / "consistency", "-o", page).exit_code == 0
    text = page.read_text()
    assert "## What photos go through: 2 images, a.exr to b.exr, through 3 responses of" in text
    assert "Seed 3; code 0123456789ab." in text
    assert "## Real photos, without a truth: 18 photos\n\n| consistency" in text
