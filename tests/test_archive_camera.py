"""One camera, one curve: whose photos give it, who gets it, and what happens when others join."""

from __future__ import annotations

import json
import os

import numpy as np
import pytest
from archive_photos import (
    GAMMA,
    ONE,
    everything,
    files,
    linear_face,
    table,
    write_face,
    write_picture,
)
from maker_note_files import SHORT, exif_with
from photo_files import app1, with_segments

from facecrf_ocio import Photo, read_photo
from facecrf_ocio.archive.cameras import camera_group
from facecrf_ocio.archive.task import Recipe
from facecrf_ocio.joint import conclude, gather
from facecrf_ocio.record.calibration_record import read_record
from facecrf_ocio.synthetic import encode, gamma_curve
from facecrf_ocio.together import MISFIT_LIMIT, calibrate_together

pytestmark = pytest.mark.slow


UNREADABLE = 3  # the exit code of `batch` where a photo failed


@pytest.fixture
def pooled(facecrf):
    def run(source, output, *more, code=0):
        options = ("--pool", "camera", "--formats", "spi1d", "--jobs", "2", *more)
        ended = facecrf("batch", source, "-o", output, *options)
        assert ended.code == code, ended.err
        return ended

    return run


@pytest.fixture
def archive(tmp_path):
    """Two faces and a faceless photo of one camera, another camera, another style, and no EXIF."""
    source = tmp_path / "photos"
    write_face(source / "a.jpg", 1, **ONE)
    write_face(source / "sub" / "b.jpg", 2, **ONE)
    noise = np.random.default_rng(1).random((60, 80, 3)).astype(np.float32)
    write_picture(source / "none.jpg", noise, **ONE)
    write_face(source / "style.jpg", 1, **ONE, Exif__Saturation=2)
    write_face(source / "two.jpg", 3, Make="Acme", Model="Two")
    write_face(source / "bare.jpg", 3)
    return source


def curve_of(folder, name):
    return read_record(folder / f"{name}.crf.json").estimate.found.linear


def test_the_photos_of_a_camera_get_the_curve_that_they_give_together(archive, tmp_path, pooled):
    output = tmp_path / "luts"
    pooled(archive, output)
    names = ("a.jpg", "none.jpg", "sub/b.jpg")
    together = calibrate_together(read_photo(archive / name) for name in names)
    for name in names:
        assert np.array_equal(curve_of(output, name), together.estimate.curve.linear)
    told = dict(table(output, "SELECT name, misfit FROM photos WHERE camera LIKE '%One%'"))
    fits = dict(zip(names, together.misfits, strict=True))
    assert {n: told[n] for n in ("a.jpg", "sub/b.jpg")} == {
        n: pytest.approx(fits[n], rel=1e-6) for n in ("a.jpg", "sub/b.jpg")
    }
    assert told["none.jpg"] == -1
    outcomes = dict(table(output, "SELECT name, outcome FROM photos"))
    assert outcomes["none.jpg"] == "from its camera"
    assert {outcomes[n] for n in names if n != "none.jpg"} == {"calibrated"}
    record = read_record(output / "none.jpg.crf.json").estimate
    assert "no face" in record.reason
    assert not record.faces
    assert len(read_record(output / "a.jpg.crf.json").estimate.faces) == 1


def test_cameras_and_picture_settings_stay_apart(archive, tmp_path, pooled, facecrf):
    output, alone = tmp_path / "luts", tmp_path / "alone"
    pooled(archive, output)
    keys = {json.loads(key)[1]: key for (key,) in table(output, "SELECT key FROM cameras")}
    assert len(table(output, "SELECT key FROM cameras")) == 3
    assert set(keys) == {"One", "Two"}
    facecrf("batch", archive, "-o", alone, "--formats", "spi1d")
    for name in ("style.jpg", "two.jpg", "bare.jpg"):  # nobody to share with: as without --pool
        assert files(output)[f"{name}.spi1d"] == files(alone)[f"{name}.spi1d"]
        assert files(output)[f"{name}.crf.json"] == files(alone)[f"{name}.crf.json"]
    assert curve_of(output, "a.jpg").tolist() != curve_of(alone, "a.jpg").tolist()


def test_photos_of_bent_curves_stay_apart_from_others_and_are_never_reliable(tmp_path, pooled):
    source, output = tmp_path / "photos", tmp_path / "luts"
    for number, active in enumerate((0, 0, 0xFFFF, 0xFFFF)):
        path = source / f"{number}.jpg"
        write_face(path, number)
        exif = app1(exif_with("NIKON CORPORATION", {0x22: (SHORT, (active,))}, "Two"))
        path.write_bytes(with_segments(path.read_bytes(), exif))
    pooled(source, output)
    styles = {json.loads(key)[4] for (key,) in table(output, "SELECT key FROM cameras")}
    assert styles == {"", "Active D-Lighting (Auto)"}
    doubts = [read_record(output / f"{n}.jpg.crf.json").estimate.confidence.doubts for n in "0123"]
    assert ["bent it to the scene" in " ".join(one) for one in doubts] == [False, False, True, True]
    assert curve_of(output, "0.jpg").tolist() == curve_of(output, "1.jpg").tolist()
    assert curve_of(output, "2.jpg").tolist() != curve_of(output, "0.jpg").tolist()


def test_a_photo_that_does_not_fit_is_told_and_keeps_its_own_curve(tmp_path, pooled, facecrf):
    source, output, alone = (tmp_path / name for name in ("photos", "luts", "alone"))
    for number in range(4):
        write_face(source / f"{number}.jpg", number, **ONE)
    write_face(source / "edited.jpg", 3, gamma_curve(0.35), **ONE)
    pooled(source, output)
    facecrf("batch", source, "-o", alone, "--formats", "spi1d")
    told = dict(table(output, "SELECT name, misfit FROM photos"))
    assert {name for name, far in told.items() if far > MISFIT_LIMIT} == {"edited.jpg"}
    assert table(output, "SELECT misfits FROM cameras") == [(1,)]
    assert files(output)["edited.jpg.spi1d"] == files(alone)["edited.jpg.spi1d"]
    assert np.array_equal(curve_of(output, "0.jpg"), curve_of(output, "1.jpg"))


def test_a_photo_that_tells_of_an_edit_neither_gives_nor_gets_its_cameras_curve(
    tmp_path, pooled, facecrf
):
    source, output, alone = (tmp_path / name for name in ("photos", "luts", "alone"))
    names = ("0.jpg", "1.jpg")
    for number, name in enumerate(names):
        write_face(source / name, number, **ONE)
        write_face(source / f"edit {name}", number, **ONE, Software="Adobe Photoshop 25.0")
    pooled(source, output)
    facecrf("batch", source, "-o", alone, "--formats", "spi1d")
    assert table(output, "SELECT members, software FROM cameras") == [(2, "")]
    for name in names:
        assert files(output)[f"edit {name}.spi1d"] == files(alone)[f"edit {name}.spi1d"]
        reason = dict(table(output, "SELECT name, reason FROM photos"))[f"edit {name}"]
        assert reason.endswith(
            "apart from its camera's other photos: it was edited (Adobe Photoshop 25.0)"
        )
    assert np.array_equal(curve_of(output, "0.jpg"), curve_of(output, "1.jpg"))
    together = calibrate_together(read_photo(source / name) for name in names)
    assert np.array_equal(curve_of(output, "0.jpg"), together.estimate.curve.linear)


def test_photos_whose_names_look_alike_both_count(monkeypatch):
    names = (r"caf\xe9.jpg", os.fsdecode(b"caf\xe9.jpg"))
    photos = (Photo(encode(linear_face(seed), GAMMA)) for seed in (1, 2))
    evidence = dict(zip(names, map(gather, photos), strict=True))
    monkeypatch.setattr(camera_group, "different_photos", lambda *_: iter(evidence))
    monkeypatch.setattr(camera_group, "evidence_of", lambda _, name: evidence[name])
    told = camera_group.conclude_camera(None, "", "", Recipe())
    assert told.used == 2
    both = conclude(list(evidence.values()))
    assert np.array_equal(told.estimate.curve.linear, both.curve.linear)


def test_photos_that_join_later_give_all_members_a_new_curve(archive, tmp_path, pooled):
    output, whole = tmp_path / "luts", tmp_path / "whole"
    late = (archive / "sub" / "b.jpg").rename(tmp_path / "b.jpg")
    pooled(archive, output)
    marks = {path: path.stat().st_mtime_ns for path in output.rglob("*.spi1d")}
    before = files(output)
    late.rename(archive / "sub" / "b.jpg")
    pooled(archive, output)
    pooled(archive, whole)
    after = files(output)
    again = {path.name for path, mark in marks.items() if path.stat().st_mtime_ns != mark}
    assert again == {"a.jpg.spi1d", "none.jpg.spi1d"}
    assert after["a.jpg.crf.json"] != before["a.jpg.crf.json"]
    assert after == files(whole)
    assert everything(output) == everything(whole)


def test_a_second_run_writes_nothing(archive, tmp_path, pooled):
    output = tmp_path / "luts"
    pooled(archive, output)
    marks = {path: path.stat().st_mtime_ns for path in output.rglob("*.jpg.*")}
    ended = pooled(archive, output)
    assert "6 done before" in ended.err
    assert {path: path.stat().st_mtime_ns for path in output.rglob("*.jpg.*")} == marks


def test_a_member_that_leaves_its_camera_takes_its_evidence_along(archive, tmp_path, pooled):
    output, whole = tmp_path / "luts", tmp_path / "whole"
    pooled(archive, output)
    (archive / "sub" / "b.jpg").write_bytes(b"no photo any more")
    pooled(archive, output, code=UNREADABLE)
    pooled(archive, whole, code=UNREADABLE)
    assert files(output) == files(whole)
    assert everything(output) == everything(whole)


def test_pooling_takes_the_estimator_that_can(archive, tmp_path, facecrf):
    ended = facecrf(
        "batch", archive, "-o", tmp_path / "o", "--pool", "camera", "--estimator", "edge"
    )
    assert ended.code == 2
    assert "takes the estimator auto or joint" in ended.err
