"""Thumbnails that a batch keeps: a report takes them, and makes anew what is not the photo's."""

from __future__ import annotations

import json
import shutil
import sqlite3
from dataclasses import replace
from io import BytesIO

import cv2
import numpy as np
import pytest
from PIL import Image
from test_archive_report import change, page_of, smooth_photo

from facecrf_ocio.archive.job import Job
from facecrf_ocio.archive.manifest.connection import FILE
from facecrf_ocio.archive.place import Place
from facecrf_ocio.archive.report import look_again
from facecrf_ocio.archive.run import run
from facecrf_ocio.archive.task import Recipe, Result, Task, Thumbnail
from facecrf_ocio.archive.thumbnail import thumbnail_of
from facecrf_ocio.archive.walk import photos_under
from facecrf_ocio.archive.work.worker_answer import checked
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.values import Photo

NAMES = ("film.jpg", "turned.jpg", "wide.png")


def batch(place, recipe=None):
    job = Job(place / "photos", place / "luts", recipe or Recipe("mean", formats=("spi1d",)))
    run(job, photos_under(job.source), lambda _: None)
    return job.folder


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    place = tmp_path_factory.mktemp("kept")
    (place / "photos").mkdir()
    smooth_photo(place / "photos" / "film.jpg", 1, (360, 240))
    smooth_photo(place / "photos" / "wide.png", 2, (480, 90))
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.open(smooth_photo(place / "photos" / "turned.jpg", 3, (300, 200))).save(
        place / "photos" / "turned.jpg", exif=exif
    )
    batch(place)
    return place


def own_copy(made, folder):
    """The outputs of a copy of an archive, which a test may change."""
    place = folder / "archive"
    shutil.copytree(made, place)
    change(
        place / "luts", ("UPDATE about SET value = ? WHERE key = 'source'", str(place / "photos"))
    )
    return place / "luts"


@pytest.fixture
def archive(made, tmp_path):
    return own_copy(made, tmp_path)


@pytest.fixture
def opened(monkeypatch):
    """Names of the photos that a report opens."""
    names, read = [], look_again._read

    def watched(path, side, *, linear):
        names.append(path.name)
        return read(path, side, linear=linear)

    monkeypatch.setattr(look_again, "_read", watched)
    return names


def rows(folder):
    base = sqlite3.connect(folder / FILE)
    found = base.execute("SELECT photo, before, after FROM thumbnails ORDER BY photo").fetchall()
    base.close()
    return found


def test_a_report_opens_no_photo_of_which_a_thumbnail_is_kept(archive, opened):
    kept = page_of(archive, large=0)
    assert opened == []
    change(archive, ("DELETE FROM thumbnails",))
    fresh = page_of(archive, large=0)
    assert sorted(opened) == sorted(NAMES)
    for name in NAMES:
        for one, other in zip(kept.pictures(name), fresh.pictures(name), strict=True):
            assert one.shape == other.shape
            assert np.abs(one - other).mean() < 0.02
    assert kept.pictures("turned.jpg")[0].shape == (64, 96, 3)


def test_large_pictures_are_made_of_the_photo(archive, opened):
    page_of(archive, large=1)
    assert len(opened) == 1


@pytest.mark.parametrize(
    "damage",
    [
        "UPDATE thumbnails SET before = substr(before, 1, 90) WHERE photo = 'film.jpg'",
        "UPDATE thumbnails SET after = before WHERE photo = 'film.jpg'",
        "UPDATE thumbnails SET before = 'text', after = 3 WHERE photo = 'film.jpg'",
        "UPDATE thumbnails SET (sha256, before, after) = (SELECT sha256, before, after "
        "FROM thumbnails WHERE photo = 'wide.png') WHERE photo = 'film.jpg'",
        "DELETE FROM thumbnails WHERE photo = 'film.jpg'",
    ],
    ids=["cut", "swapped", "no picture", "another photo's", "none"],
)
def test_one_that_is_damaged_or_another_photos_is_made_anew(archive, opened, damage):
    sound = page_of(archive, large=0).pictures("film.jpg")
    change(archive, (damage,))
    page = page_of(archive, large=0)
    assert opened == ["film.jpg"]
    # Each errs by 0.012 of its own.
    assert np.abs(page.pictures("film.jpg")[0] - sound[0]).mean() < 0.015


def test_a_manifest_without_the_table_is_read_and_its_photos_opened(archive, opened):
    former = "UPDATE about SET value = 4 WHERE key = 'schema'"
    change(archive, ("DROP TABLE thumbnails",), (former,))
    assert page_of(archive, large=0).pictures("film.jpg")[0].shape == (96, 64, 3)
    assert sorted(opened) == sorted(NAMES)


def test_a_photo_whose_record_is_lost_is_shown_without_its_light(archive, opened):
    (archive / "film.jpg.crf.json").unlink()
    page = page_of(archive, large=0)
    assert opened == []
    assert page.word("missing", page.row("film.jpg")).startswith("The record")
    at = page.data["columns"]["picture"][page.row("film.jpg")]
    before, after = json.loads(page.texts["pictures-0"])[at]
    assert before
    assert after == ""


def test_a_changed_photo_gets_another_and_a_resumed_run_keeps_the_rest(archive):
    former = {name: rest for name, *rest in rows(archive)}
    assert sorted(former) == sorted(NAMES)
    smooth_photo(archive.parent / "photos" / "film.jpg", 11, (360, 240))
    batch(archive.parent)
    now = {name: rest for name, *rest in rows(archive)}
    assert {name for name in NAMES if now[name] != former[name]} == {"film.jpg"}


def test_a_camera_s_photos_get_theirs_with_the_curve_that_is_written(tmp_path, opened):
    (tmp_path / "photos").mkdir()
    exif = Image.Exif()
    exif[0x010F], exif[0x0110] = "Acme", "One"
    for seed in (1, 2):
        path = smooth_photo(tmp_path / "photos" / f"{seed}.jpg", seed, (360, 240))
        Image.open(path).save(path, exif=exif)
    output = batch(tmp_path, Recipe("auto", fallback="mean", formats=("spi1d",), pool=True))
    page = page_of(output, large=0)
    assert opened == []
    for seed in (1, 2):
        assert page.pictures(f"{seed}.jpg")[0].shape == (96, 64, 3)


@pytest.mark.parametrize("size", [(1999, 2601), (4000, 31), (1, 5000), (5000, 1)])
@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_a_large_photo_is_averaged_over_all_of_it(size, dtype):
    ramp = np.linspace(0, 1, size[0])[:, None, None] * np.ones((*size, 3))
    encoded = np.rint(255 * ramp).astype(np.uint8) if dtype is np.uint8 else ramp.astype(np.float32)
    photo = Photo.of_codes(encoded) if dtype is np.uint8 else Photo(encoded)
    with Image.open(BytesIO(thumbnail_of(photo, None).before)) as image:
        shown = np.asarray(image.convert("RGB")) / 255
    assert max(shown.shape) == min(96, max(size))
    truth = cv2.resize(ramp, image.size, interpolation=cv2.INTER_AREA)
    assert np.abs(shown - truth).mean() < 0.02


def test_what_cannot_be_shrunk_costs_no_photo(archive, monkeypatch):
    def refuses(*_):
        raise RuntimeError

    photo = read_photo(archive.parent / "photos" / "film.jpg")
    assert thumbnail_of(photo, None).before[:4] == b"RIFF"
    monkeypatch.setattr("facecrf_ocio.archive.thumbnail.shrunk", refuses)
    assert thumbnail_of(photo, None) == Thumbnail(b"")


def test_a_worker_s_thumbnail_is_small_bytes(archive):
    task = Task(archive.parent / "photos" / "film.jpg", "film.jpg", Place.of(archive), Recipe())
    result = Result("calibrated", "weak", thumbnail=Thumbnail(b"RIFF", b"RIFF"))
    assert checked(task, result).thumbnail == result.thumbnail
    for odd in (Thumbnail(b"x" * 70_000), Thumbnail("text"), "thumbnail"):
        with pytest.raises(ValueError, match="none of its kind"):
            checked(task, replace(result, thumbnail=odd))
