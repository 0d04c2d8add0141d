"""Every file of the cases kept beside the project gets what their table calls right.

They are photos, LUTs, configs and records that stopped an earlier version, and are not shipped.
"""

from __future__ import annotations

import csv
import os
import shutil
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from command_line import CommandLine
from config_spaces import lost, read
from lut_files import through_ocio

from facecrf_ocio.errors import LutError
from facecrf_ocio.lut.lint import lint
from facecrf_ocio.record.calibration_record import read_record

pytestmark = pytest.mark.slow
CLEAN, WRONG, UNUSABLE = 0, 6, 7  # exit codes of `lint`
UNREADABLE = 3
FAILED = {"err_not_utf8.exr": "begins as OpenEXR", "float16.dng": "decodes zeros alone"}
LINEAR = {"lin16_crop.dng", "pix16.jxl"}
ENDS = {
    "bigsize.cube": UNUSABLE,
    "csp_endless.csp": UNUSABLE,
    "redos_20k.spi1d": UNUSABLE,
    "tagbomb.icc": UNUSABLE,
    "c33_values_255.cube": WRONG,
    "h03_nan_at_2.clf": WRONG,
    "h04_falls_above_1.clf": WRONG,
}
ENCODES = {"own_profile.icm"}  # a config is of LUTs that linearize
SPACES = {"curve_then_ap1.clf": "lin_ap1_scene", "own_profile.icm": "lin_ciexyzd65_scene"}


@pytest.fixture(scope="module")
def cases() -> Path:
    default = Path(__file__).resolve().parents[2] / "shared" / "cases"
    folder = Path(os.environ.get("FACECRF_CASES", default))
    if not folder.is_dir():
        pytest.skip(f"cases are not in {folder}; set FACECRF_CASES")
    return folder


def luts(cases: Path) -> list[Path]:
    found = (path for path in sorted((cases / "luts").rglob("*")) if path.is_file())
    return [path for path in found if path.suffix != ".exr"]


def test_a_batch_goes_through_all_photos(cases: Path, facecrf: CommandLine, tmp_path: Path) -> None:
    """By an estimator that looks at no face: what is tested is reading, and writing EXRs."""
    output, listed = tmp_path / "out", tmp_path / "list.csv"
    how = ("--estimator", "mean", "--formats", "spi1d", "--exr", "--csv", listed)
    assert facecrf("batch", cases / "photos", "-o", output, *how).code == UNREADABLE
    photos = {path.name for path in (cases / "photos").iterdir()}
    text = listed.read_text(encoding="utf-8").splitlines()
    rows = {row["name"]: row for row in csv.DictReader(text)}
    assert set(rows) == photos
    for name, row in rows.items():
        if name in FAILED or "install" in row["remedy"]:  # as it says of HEIC without the extra
            assert row["outcome"] == "failed", name
            assert FAILED.get(name, "") in row["reason"]
            continue
        assert row["outcome"] == ("already linear" if name in LINEAR else "fallback"), name
        exr = oiio.ImageBuf(str(output / f"{name}.exr"))
        assert np.isfinite(exr.get_pixels(oiio.FLOAT)).all(), name
        chromaticities = exr.spec().getattribute("chromaticities")
        assert chromaticities is None or np.isfinite(chromaticities).all(), name
    assert facecrf("verify", output).code == 0


def test_each_photo_ends_alone_as_in_a_batch(
    cases: Path, facecrf: CommandLine, tmp_path: Path
) -> None:
    for path in sorted((cases / "photos").iterdir()):
        out, exr = tmp_path / path.name, tmp_path / f"{path.name}.exr"
        how = ("--estimator", "mean", "--formats", "spi1d")
        ended = facecrf("calibrate", path, "-o", out, *how)
        lines = [line for line in ended.err.splitlines() if line.startswith("facecrf: ")]
        refused = path.name in FAILED or "install" in ended.err
        assert ended.code == (UNREADABLE if refused else 0), path.name
        assert len(lines) == refused, path.name
        assert FAILED.get(path.name, "") in ended.err
        if path.name not in LINEAR:  # which need no curve
            assert out.exists() == (not refused), path.name
        how = ("--estimator", "srgb", "-o", exr)
        assert facecrf("linearize", path, *how).code == ended.code, path.name
        assert exr.exists() == (not refused), path.name


def test_each_lut_ends_as_the_table_says(cases: Path, facecrf: CommandLine, tmp_path: Path) -> None:
    photo = cases / "photos" / "base_face.jpg"
    for path in luts(cases):
        expected = UNUSABLE if path.parent.name == "unreadable" else ENDS.get(path.name, CLEAN)
        assert facecrf("lint", path).code == expected, path
        exr = tmp_path / f"{path.name}.exr"
        ended = facecrf("apply", photo, "--lut", path, "-o", exr)
        refused = expected == UNUSABLE or path.name == "h03_nan_at_2.clf"
        assert ended.code == (UNREADABLE if refused else 0), path
        assert exr.exists() == (not refused)
        if refused:
            assert len(ended.err.splitlines()) == 1
        else:
            space = oiio.ImageBuf(str(exr)).spec().getattribute("oiio:ColorSpace")
            assert space == SPACES.get(path.name, "unknown"), path
        config = tmp_path / f"{path.name}.ocio"
        ended = facecrf("ocio-config", path, "-o", config)
        mixes = path.name == "log_then_matrix.clf"  # and does not say where it leads
        refused = refused or mixes or path.name in ENCODES
        assert ended.code == (UNREADABLE if refused else 0), path
        assert config.exists() == (not refused)


def test_opencolorios_reason_is_told_whole(cases: Path) -> None:
    for path in sorted((cases / "luts" / "unreadable").iterdir()):
        finding = lint(path)[-1]
        assert finding.unusable, path
        assert f"'{path.name}' could not be loaded" in finding.problem
        assert "gave the error" in finding.problem
        assert "…" not in finding.problem


def test_tables_infinite_where_no_photo_goes_are_applied_as_by_opencolorio(
    cases: Path, facecrf: CommandLine, tmp_path: Path
) -> None:
    lut, bright = cases / "luts" / "log_then_matrix.clf", cases / "luts" / "one_bright_pixel.exr"
    assert facecrf("apply", bright, "--lut", lut, "-o", tmp_path / "a.exr").code == 0
    before = oiio.ImageBuf(str(bright)).get_pixels(oiio.FLOAT)[..., :3]
    after = oiio.ImageBuf(str(tmp_path / "a.exr")).get_pixels(oiio.FLOAT)
    expected = through_ocio(lut, before)
    calm = np.isfinite(expected).all(axis=2) & (np.abs(expected) < 60000).all(axis=2)
    assert np.isfinite(after).all()
    assert 0 < calm.sum() < calm.size
    assert np.allclose(after[calm], expected[calm], rtol=1e-3, atol=1e-4)  # half floats


def test_a_studios_config_keeps_its_luts(cases: Path, facecrf: CommandLine, tmp_path: Path) -> None:
    folder = tmp_path / "studio"
    shutil.copytree(cases / "configs" / "merge_no_search_path", folder)
    studio = folder / "studio.ocio"
    for target in (folder / "own.ocio", tmp_path / "other.ocio"):
        how = ("--merge", studio, "-o", target)
        assert facecrf("ocio-config", folder / "photo.spi1d", *how).code == 0
        count, unlike = lost(read(studio), read(target))
        assert (unlike, count > 0) == ([], True)


def test_a_record_of_absurd_numbers_is_refused(cases: Path) -> None:
    with pytest.raises(LutError, match=r"coeff_bigint\.crf\.json"):
        read_record(cases / "archive" / "coeff_bigint.crf.json")
