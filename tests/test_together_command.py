"""`facecrf calibrate --together`: one curve of several photos, told once, written for each."""

from __future__ import annotations

import json

import pytest
from archive_photos import ONE, write_face


@pytest.fixture
def photos(tmp_path):
    return [
        write_face(tmp_path / name, seed, **ONE) for seed, name in enumerate(("a.jpg", "b.jpg"))
    ]


def together(facecrf, photos, tmp_path, *more):
    options = ("--together", "-o", tmp_path / "luts", "--formats", "spi1d")
    return facecrf("calibrate", *photos, *options, *more)


def test_the_curve_is_told_once_and_written_for_each_photo(facecrf, photos, tmp_path):
    ended = together(facecrf, photos, tmp_path)
    assert ended.code == 0
    first, *others = ended.out.splitlines()
    assert first.startswith("2 photos together: calibrated (")
    assert others == [
        line
        for photo in photos
        for line in (
            str(photo),
            f"  {tmp_path / 'luts' / photo.name}.spi1d",
            f"  {tmp_path / 'luts' / photo.name}.crf.json",
        )
    ]
    luts = [(tmp_path / "luts" / f"{photo.name}.spi1d").read_text() for photo in photos]
    tables = [text.partition("{")[2].partition("}")[0] for text in luts]
    assert tables[0] == tables[1] != ""


def test_json_tells_it_of_each_photo(facecrf, photos, tmp_path):
    told = together(facecrf, photos, tmp_path, "--json").out.splitlines()
    summaries = [json.loads(line)["summary"] for line in told]
    assert len(summaries) == 2
    assert summaries[0] == summaries[1]


def test_photos_that_name_two_cameras_are_told(facecrf, photos, tmp_path):
    other = write_face(tmp_path / "c.jpg", 2, Make="Acme", Model="Two")
    ended = together(facecrf, [*photos, other], tmp_path)
    assert (
        "the photos name 2 cameras, but one curve is of one camera: Acme One, Acme Two" in ended.out
    )
    assert "reliable" not in ended.out


def test_what_a_curve_rests_on_is_told_once(facecrf, photos, tmp_path):
    ended = together(facecrf, photos, tmp_path, "--verbose")
    assert ended.out.count("2 photos, ") == 1
    assert ended.out.count("expected error ") == 1


def test_a_copy_of_a_photo_makes_the_curve_no_surer(facecrf, photos, tmp_path):
    copy = tmp_path / "copy.jpg"
    copy.write_bytes(photos[0].read_bytes())
    alone, both = (
        json.loads(together(facecrf, given, tmp_path, "--json", "--overwrite").out.splitlines()[0])
        for given in (photos[:1], [photos[0], copy])
    )
    assert both["summary"] == alone["summary"]
    ended = together(facecrf, [photos[0], copy], tmp_path, "--overwrite")
    assert f"{copy}: says nothing: a photo before it has the same bytes" in ended.err
    assert (tmp_path / "luts" / "copy.jpg.spi1d").is_file()
