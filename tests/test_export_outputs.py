"""All files of one photo, or none of them."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from facecrf_ocio.errors import LutError, OutputError
from facecrf_ocio.lut.formats import clf
from facecrf_ocio.record.calibration_record import read_record
from facecrf_ocio.record.outputs import (
    output_paths,
    require_distinct_names,
    require_outputs_free,
    write_outputs,
)
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Confidence, Estimate, InverseCRF, Outcome, Photo, Verdict

CODES = np.linspace(0.0, 1.0, 4096)


def photo(name: str = "a.jpg") -> Photo:
    return Photo(np.zeros((2, 3, 3), np.float32), path=Path("photos") / name, sha256="12" * 32)


def estimate(gamma: float = 2.2) -> Estimate:
    return Estimate(
        Outcome.CALIBRATED,
        "face",
        "found",
        found=InverseCRF(CODES, np.stack([CODES**gamma] * 3)),
        confidence=Confidence(np.zeros((3, 4096)), np.ones((3, 4096)), Verdict.RELIABLE, ()),
    )


def write(
    folder: Path, name: str = "a.jpg", gamma: float = 2.2, **options: Any
) -> tuple[Path, ...]:
    return write_outputs(photo(name), estimate(gamma), Settings(), folder, **options)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_luts_and_record_are_named_after_the_photo(tmp_path: Path) -> None:
    written = write(tmp_path / "new" / "folder", "IMG.0001.jpg")
    names = [f"IMG.0001.jpg.{ending}" for ending in ("spi1d", "cube", "clf", "crf.json")]
    assert [path.name for path in written] == names
    assert all(path.is_file() for path in written)
    assert read_record(written[-1]).luts == tuple(names[:-1])


def test_only_the_formats_asked_for_are_written_and_each_once(tmp_path: Path) -> None:
    written = write(tmp_path, formats=["clf", "clf"])
    assert [path.name for path in written] == ["a.jpg.clf", "a.jpg.crf.json"]


def test_luts_tell_where_they_come_from(tmp_path: Path) -> None:
    write(tmp_path, formats=["spi1d", "clf"])
    for name in ("a.jpg.spi1d", "a.jpg.clf"):
        text = (tmp_path / name).read_text("utf-8")
        for told in ("a.jpg", "12" * 32, "calibrated (face)", "reliable", "facecrf_ocio "):
            assert told in text


def test_without_a_curve_there_is_only_the_record(tmp_path: Path) -> None:
    nothing = Estimate(Outcome.NOT_CALIBRATED, "face", "no face", "give a photo with a face")
    written = write_outputs(photo(), nothing, Settings(), tmp_path)
    assert [path.name for path in written] == ["a.jpg.crf.json"]
    assert read_record(written[0]).estimate.reason == "no face"


@pytest.mark.parametrize("existing", ["a.jpg.spi1d", "a.jpg.cube", "a.jpg.clf", "a.jpg.crf.json"])
def test_nothing_is_written_where_one_file_exists(existing: str, tmp_path: Path) -> None:
    (tmp_path / existing).write_bytes(b"mine")
    with pytest.raises(OutputError, match=rf"{existing}: exists already; pass overwrite=True"):
        write(tmp_path)
    assert contents(tmp_path) == {existing: b"mine"}


def test_overwriting_replaces_all(tmp_path: Path) -> None:
    write(tmp_path, gamma=2.0)
    before = contents(tmp_path)
    write(tmp_path, gamma=3.0, overwrite=True)
    after = contents(tmp_path)
    assert after.keys() == before.keys()
    assert all(after[name] != before[name] for name in before)


def test_photos_that_differ_in_their_suffix_stand_side_by_side(tmp_path: Path) -> None:
    first = write(tmp_path, "a.jpg", 2.0)
    second = write(tmp_path, "a.dng", 3.0)
    assert not set(first) & set(second)
    assert [read_record(made[-1]).source.name for made in (first, second)] == ["a.jpg", "a.dng"]


@pytest.mark.parametrize("overwrite", [False, True])
def test_a_second_photo_of_the_same_name_never_takes_the_firsts_place(
    overwrite: bool, tmp_path: Path
) -> None:
    write(tmp_path, "a.jpg", 2.0)
    before = contents(tmp_path)
    with pytest.raises(OutputError, match=r"a\.jpg\.crf\.json: belongs to a\.jpg, not to a\.png"):
        write_outputs(
            photo("a.png"), estimate(), Settings(), tmp_path, overwrite=overwrite, name="a.jpg"
        )
    assert contents(tmp_path) == before


def test_one_lut_that_fails_takes_the_others_with_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, gamma=2.0)
    before = contents(tmp_path)
    monkeypatch.setattr(clf, "clf_text", lambda *_: "not a LUT")
    with pytest.raises(LutError, match=r"a\.jpg\.clf: OpenColorIO cannot read it back"):
        write(tmp_path, gamma=3.0, overwrite=True)
    assert contents(tmp_path) == before
    with pytest.raises(LutError, match=r"b\.jpg\.clf"):
        write(tmp_path, "b.jpg")
    assert contents(tmp_path) == before


def test_unknown_formats_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(LutError, match="unknown LUT format '3dl'; use one of spi1d, cube, clf"):
        write(tmp_path / "out", formats=["spi1d", "3dl"])
    assert not list(tmp_path.iterdir())


def test_a_photo_in_memory_needs_a_name(tmp_path: Path) -> None:
    nameless = replace(photo(), path=None)
    with pytest.raises(OutputError, match="no name"):
        write_outputs(nameless, estimate(), Settings(), tmp_path)


def test_a_file_for_a_folder_is_told(tmp_path: Path) -> None:
    (tmp_path / "out").write_bytes(b"")
    with pytest.raises(OutputError, match=r"out.*; choose"):
        write(tmp_path / "out")
    with pytest.raises(OutputError, match=r"the folder cannot be made: .*; choose"):
        write(tmp_path / "out" / "deeper")


def test_conflicts_are_told_before_a_photo_is_calibrated(tmp_path: Path) -> None:
    source = Path("photos/a.jpg")
    assert require_outputs_free(source, tmp_path, ["clf"], overwrite=False) == output_paths(
        source, tmp_path, ["clf"]
    )
    (tmp_path / "a.jpg.clf").write_bytes(b"")
    with pytest.raises(OutputError, match=r"a\.jpg\.clf: exists already"):
        require_outputs_free(source, tmp_path, ["clf"], overwrite=False)
    require_outputs_free(source, tmp_path, ["clf"], overwrite=True)


def test_photos_of_one_run_must_differ_in_name() -> None:
    require_distinct_names([Path("a.jpg"), Path("a.png"), Path("c/d.jpg")])
    with pytest.raises(OutputError, match=r"y/a\.jpg: would write the same files as x/a\.jpg"):
        require_distinct_names([Path("x/a.jpg"), Path("b.jpg"), Path("y/a.jpg")])


@pytest.mark.parametrize("name", ["-rf.jpg", "a b.jpg", "$HOME.jpg", "Zoë.jpg", "'q\".jpg", ".jpg"])
def test_any_name_of_a_photo_will_do(name: str, tmp_path: Path) -> None:
    written = write(tmp_path / name, name)
    assert sorted((tmp_path / name).iterdir()) == sorted(written)
    assert read_record(written[-1]).source.name == name


def test_exporting_needs_no_image_or_optimization_library() -> None:
    code = (
        "import sys, facecrf_ocio.record.outputs\n"
        "print(*sorted(m for m in sys.modules if '.' not in m))"
    )
    listed = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    )
    assert not {"cv2", "scipy", "OpenImageIO", "rawpy", "PIL"} & set(listed.stdout.split())
