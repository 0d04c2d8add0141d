"""`facecrf bench pairs`: real pairs, whose truth is fitted, and every estimator beside it."""

from __future__ import annotations

import json

import cv2
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from click.testing import CliRunner

from facecrf_ocio.benchmark.table2 import find_pairs
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.synthetic import SyntheticSpec, gamma_curve, photograph, render_face


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A linear EXR of a face and what a camera of gamma 2.2 made of it."""
    place = tmp_path_factory.mktemp("pairs")
    face = render_face(SyntheticSpec(seed=5))
    codes = np.rint(photograph(face, gamma_curve(2.2)).encoded * 255.0).astype(np.uint8)
    assert cv2.imwrite(str(place / "a.png"), codes[..., ::-1])
    linear = np.ascontiguousarray(face.linear, dtype=np.float32)
    spec = oiio.ImageSpec(linear.shape[1], linear.shape[0], 3, "float")
    buffer = oiio.ImageBuf(spec)
    buffer.set_pixels(oiio.ROI(), linear)
    assert buffer.write(str(place / "a.exr"))
    return place


def run(folder, output):
    arguments = ["bench", "pairs", str(folder), "--estimators", "joint", "-o", str(output)]
    return CliRunner().invoke(main, arguments)


def test_a_folder_and_a_list_name_the_same_pairs(folder):
    (folder / "list.tsv").write_text("# linear\tencoded\na.exr\ta.png\n", encoding="utf-8")
    assert find_pairs(folder) == find_pairs(folder / "list.tsv")


def test_what_holds_no_pairs_is_refused(tmp_path):
    with pytest.raises(PhotoError, match="holds no pairs"):
        find_pairs(tmp_path)
    (tmp_path / "list.tsv").write_text("a.exr\n", encoding="utf-8")
    with pytest.raises(PhotoError, match="line 1 has 1 columns"):
        find_pairs(tmp_path / "list.tsv")


def test_every_estimator_is_compared_with_the_fitted_truth(folder, tmp_path):
    first = run(folder, tmp_path)
    assert first.exit_code == 0, first.output
    record = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    cases = {case["estimator"]: case for case in record["cases"]}
    assert cases["gamma22"]["rmse"] < 0.01  # it is the truth
    assert cases["identity"]["rmse"] > 0.2
    assert cases["joint"]["rmse"] < cases["identity"]["rmse"]
    table = (tmp_path / "table.md").read_bytes()
    assert run(folder, tmp_path).exit_code == 0
    assert (tmp_path / "table.md").read_bytes() == table


def test_a_pair_that_cannot_be_fitted_is_named(folder, tmp_path):
    (tmp_path / "list.tsv").write_text(
        f"{folder / 'a.exr'}\t{folder / 'a.png'}\nno.exr\tno.png\n", encoding="utf-8"
    )
    result = run(tmp_path / "list.tsv", tmp_path / "out")
    assert result.exit_code == 0
    assert "left out: " in result.output
    assert "no.exr" in result.output
