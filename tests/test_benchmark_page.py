"""The page of results says what the benches' folders hold."""

from __future__ import annotations

import json

from click.testing import CliRunner

from facecrf_ocio.cli_bench import bench

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
    said = "2 images, a.exr to b.exr, through 3 responses of dorf.mat; bits 8; seed 3; code 0123"
    assert said in text
    assert (page.parent / "results" / "fig4_skin.png").read_bytes() == b"a picture"
    before = page.read_bytes()
    assert run(figures, tables, "-o", page, "--findings", tmp_path / "findings.md").exit_code == 0
    assert page.read_bytes() == before


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
    assert "## Real cameras (Table 2)\n\n| joint" in text
    assert "Measured on 1 pairs of exposures; code 0123456789ab." in text
