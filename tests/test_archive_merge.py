"""`batch --merge`: each bracket of an archive becomes one image, once, beside its curve."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import ONE, everything, exposed, files, table, write_picture
from command_line import CommandLine
from photo_files import pixels_of

from facecrf_ocio.archive.place import Place
from facecrf_ocio.archive.task import MERGE, Recipe, Series, Task
from facecrf_ocio.archive.work.one_bracket import merged
from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.image.apply import BEYOND_HALF
from facecrf_ocio.pair.code_samples import COLUMNS, ROWS
from facecrf_ocio.photo.read import read_photo

HOW = ("--pool", "camera", "--merge", "--formats", "spi1d", "--jobs", "1")
STOPS = (-2, -1, 0, 1, 2)


def scene():
    """(384, 512, 3) patches of one color each, over eight stops, in no order."""
    ramp = np.geomspace(0.004, 1.0, ROWS * COLUMNS)
    light = np.random.default_rng(2).permutation(ramp).reshape(ROWS, COLUMNS, 1)
    patches = light * np.array([1.0, 0.9, 0.8])
    return np.repeat(np.repeat(patches, 16, axis=0), 16, axis=1).astype(np.float32)


def write_bracket(folder, stops=STOPS, name="ramp", first=0):
    for number, stop in enumerate(stops):
        light = scene() * np.float32(2.0**stop)
        path = folder / f"{name}{number}.jpg"
        write_picture(path, light, **ONE, **exposed(first + number, stop))


def merges(output):
    rows = table(output, "SELECT name, outcome, reason, file, exposures FROM merges")
    return [(*told, json.loads(exposures)) for *told, exposures in rows]


def test_merging_treats_no_photo_otherwise():
    assert Recipe(merge=True).sha256("1") == Recipe().sha256("1")
    assert Recipe.from_json(Recipe(merge=True).to_json()).merge


def test_only_exrs_of_photos_are_treated_otherwise_for_their_compression():
    small, plain = Recipe(exr=True, compression="dwaa"), Recipe(exr=True)
    assert small.sha256("1") != plain.sha256("1")
    merged = replace(small, exr=False, merge=True)
    assert merged.sha256("1") == Recipe().sha256("1")
    before = {k: v for k, v in json.loads(plain.to_json()).items() if k != "compression"}
    assert Recipe.from_json(json.dumps(before)) == plain


def test_without_pooling_there_are_no_brackets_to_merge(capfd, tmp_path):
    ended = CommandLine(capfd)("batch", tmp_path, "-o", tmp_path / "luts", "--merge")
    assert ended.code == 2
    assert "pass both" in ended.err


@pytest.mark.slow
def test_a_bracket_becomes_one_image_with_the_light_of_the_scene(capfd, tmp_path):
    source, output = tmp_path / "photos", tmp_path / "luts"
    write_bracket(source)
    write_bracket(source, (0, 0.5), name="twice", first=30)
    ended = CommandLine(capfd)("batch", source, "-o", output, *HOW)
    assert ended.code == 0, ended.err
    assert "brackets: 1 merged, 1 not merged" in ended.err
    merged, twice = merges(output)
    assert merged[:2] + merged[3:4] == ("ramp0.jpg", "merged", "ramp0.jpg.hdr.exr")
    assert BEYOND_HALF not in merged[2]
    assert "0.5 stops, fewer than 1" in twice[2]
    names, _, stops, moved = zip(*merged[4], strict=True)
    assert names == tuple(f"ramp{n}.jpg" for n in range(5))
    assert np.diff(stops) == pytest.approx(1.0, abs=0.05)
    assert max(moved) < 0.01
    linear = pixels_of(output / "ramp0.jpg.hdr.exr")
    off = np.log2(np.maximum(linear, 1e-6) / scene()).mean(axis=2)[8::16, 8::16]
    assert np.std(off) < 0.05  # eight stops come back, of which no photo shows all
    spec = oiio.ImageBuf(str(output / "ramp0.jpg.hdr.exr")).spec()
    assert spec["facecrf:estimator"] == "bracket"
    assert "ramp4.jpg" in spec["facecrf:bracket"]
    assert CommandLine(capfd)("verify", output).code == 0


def test_light_that_half_floats_do_not_hold_is_told(tmp_path, monkeypatch):
    write_bracket(tmp_path, (-2, 0, 2))
    paths = tuple(sorted(tmp_path.glob("*.jpg")))
    photos = [read_photo(path) for path in paths]
    series = Series(paths, tuple(photo.sha256 for photo in photos), (-2.0, 0.0, 2.0), False)
    (tmp_path / "luts").mkdir()
    place = Place.of(tmp_path / "luts")
    srgb = calibrate(photos[1], estimator="srgb")
    task = Task(paths[0], paths[0].name, place, Recipe(), step=MERGE, estimate=srgb, series=series)
    assert BEYOND_HALF not in merged(task)[0].reason
    monkeypatch.setattr("facecrf_ocio.image.apply.HALF_MAX", 0.5)
    result, _ = merged(replace(task, overwrite=True))
    assert result.reason.endswith(f"; {BEYOND_HALF}")


@pytest.mark.slow
def test_merging_goes_on_where_it_was_broken_off_and_again_where_something_changed(capfd, tmp_path):
    source, output, run = tmp_path / "photos", tmp_path / "luts", CommandLine(capfd)
    write_bracket(source)
    without = [part for part in HOW if part != "--merge"]
    assert run("batch", source, "-o", output, *without).code == 0
    assert merges(output) == []
    before = files(output)
    assert run("batch", source, "-o", output, *HOW).code == 0
    file = output / "ramp0.jpg.hdr.exr"
    done, content = everything(output), file.read_bytes()
    assert {**before, file.name: content} == files(output)  # nothing else was written again
    written = file.stat().st_mtime_ns
    assert run("batch", source, "-o", output, *HOW).code == 0
    assert file.stat().st_mtime_ns == written
    assert everything(output) == done
    file.unlink()
    assert run("verify", output).code == 1
    assert run("verify", output, "--repair").code == 0
    assert (file.read_bytes(), everything(output)) == (content, done)
    write_picture(source / "ramp4.jpg", scene()[:, ::-1], **ONE, **exposed(4, 2))
    assert run("batch", source, "-o", output, *HOW).code == 0
    ((*_, exposures),) = merges(output)
    assert len(exposures) == 4  # what shows something else is none of them
    assert file.read_bytes() != content


@pytest.mark.slow
def test_an_image_of_what_is_no_bracket_any_more_is_taken_away(capfd, tmp_path):
    source, output, run = tmp_path / "photos", tmp_path / "luts", CommandLine(capfd)
    write_bracket(source, (-2, 0, 2))
    assert run("batch", source, "-o", output, *HOW).code == 0
    assert (output / "ramp0.jpg.hdr.exr").exists()
    for number in (1, 2):
        other = np.roll(scene(), 64 * number, axis=1)
        write_picture(source / f"ramp{number}.jpg", other, **ONE, **exposed(number, 0))
    assert run("batch", source, "-o", output, *HOW).code == 0
    assert not (output / "ramp0.jpg.hdr.exr").exists()
    assert merges(output) == []
    assert run("verify", output).code == 0


@pytest.mark.slow
def test_what_is_in_the_way_is_not_replaced(capfd, tmp_path):
    source, output, run = tmp_path / "photos", tmp_path / "luts", CommandLine(capfd)
    write_bracket(source, (-2, 0, 2))
    output.mkdir()
    (output / "ramp0.jpg.hdr.exr").write_bytes(b"mine")
    ended = run("batch", source, "-o", output, *HOW)
    assert ended.code == 3
    assert "ramp0.jpg.hdr.exr: exists already; pass --overwrite" in ended.err
    assert (output / "ramp0.jpg.hdr.exr").read_bytes() == b"mine"
    assert run("batch", source, "-o", output, *HOW, "--overwrite").code == 0
    assert (output / "ramp0.jpg.hdr.exr").stat().st_size > 1000


@pytest.mark.slow
def test_a_real_bracket_is_found_and_merged(capfd, tmp_path, development_data):
    corridor = development_data / "stacks" / "canon_5d_corridor"
    if not corridor.is_dir():
        pytest.skip("the public bracket of a corridor is not there")
    source, output = tmp_path / "photos", tmp_path / "luts"
    source.mkdir()
    for number in (2, 8, 14, 20):
        shutil.copy(corridor / f"00{number:02d}.jpg", source)
    ended = CommandLine(capfd)("batch", source, "-o", output, *HOW)
    assert ended.code == 0, ended.err
    ((name, outcome, *_, exposures),) = merges(output)
    assert (name, outcome) == ("0002.jpg", "merged")
    stops, moved = np.transpose([told[2:] for told in exposures])
    assert stops == pytest.approx([0.0, -2.0, -4.0, -6.0], abs=0.1)
    assert max(moved) < 0.01
    assert pixels_of(output / "0002.jpg.hdr.exr").max() > 16.0  # the lamp, six stops above white
