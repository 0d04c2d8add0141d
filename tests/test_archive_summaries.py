"""What a report tells of records: kept by a batch, and taken while a record is unchanged."""

from __future__ import annotations

import base64
import json
import os
from dataclasses import replace

import numpy as np
import pytest
from test_archive_report import change, page_of
from test_archive_thumbnails import NAMES, batch, made, own_copy  # noqa: F401 - a fixture

from facecrf_ocio.archive.place import Place
from facecrf_ocio.archive.report import look_again, record_summary
from facecrf_ocio.archive.task import Recipe, Result, Task
from facecrf_ocio.archive.work.worker_answer import checked

COLUMNS = ("faces", "stops", "shadows", "line", "steps", "files", "missing")


@pytest.fixture
def archive(made, tmp_path):  # noqa: F811
    return own_copy(made, tmp_path)


@pytest.fixture
def parsed(monkeypatch):
    """Names of the photos whose records a report reads."""
    names, read = [], look_again.read_record

    def watched(path):
        names.append(path.name.removesuffix(".crf.json"))
        return read(path)

    monkeypatch.setattr(look_again, "read_record", watched)
    return names


def said(page):
    """What a page tells of each photo, its words among it."""
    columns, words = page.data["columns"], page.data["words"]
    worded = ("line", "steps", "files", "missing")
    return {
        name: [words[n] for n in columns[name]] if name in worded else columns[name]
        for name in COLUMNS
    }


def curves(page):
    texts = json.loads(page.texts["curves"])
    drawn = [texts[place] for place in page.data["columns"]["curve"]]
    return np.array([np.frombuffer(base64.b64decode(text), "<u2") for text in drawn], np.int64)


def test_a_report_reads_no_record_that_is_as_it_was_written(archive, parsed):
    kept = page_of(archive, large=0)
    assert parsed == []
    change(archive, ("DELETE FROM summaries",))
    fresh = page_of(archive, large=0)
    assert sorted(parsed) == sorted(NAMES)
    assert said(kept) == said(fresh)
    assert any(said(kept)["line"])
    assert np.abs(curves(kept) - curves(fresh)).max() <= 1  # of 65,535: records thin their bands


def test_a_record_of_another_time_is_known_by_its_bytes(archive, parsed):
    os.utime(archive / "film.jpg.crf.json", ns=(0, 1))
    page_of(archive, large=0)
    assert parsed == []


def test_a_record_that_was_changed_is_read(archive, parsed):
    record = archive / "film.jpg.crf.json"
    content = record.read_text().replace("the mean curve", "the mean CURVE")
    assert content != record.read_text()
    record.write_text(content)
    page = page_of(archive, large=0)
    assert parsed == ["film.jpg"]
    assert "the mean CURVE" in page.word("line", page.row("film.jpg"))


def test_a_record_that_is_lost_is_missing_whatever_was_kept_of_it(archive, parsed):
    (archive / "film.jpg.crf.json").unlink()
    page = page_of(archive, large=0)
    assert parsed == ["film.jpg"]
    assert page.word("missing", page.row("film.jpg")) == look_again.NO_RECORD


@pytest.mark.parametrize(
    "damage",
    [
        "UPDATE summaries SET text = replace(text, 'the mean curve', 'a curve')",
        "UPDATE summaries SET text = 3",
        "UPDATE summaries SET sha256 = ''",
        "DELETE FROM summaries",
        "DROP TABLE summaries",
        "UPDATE outputs SET sha256 = 'f' || substr(sha256, 2)",
    ],
    ids=["other words", "no text", "no hash", "none", "no table", "another record"],
)
def test_one_that_is_damaged_is_not_believed(archive, parsed, damage):
    sound = said(page_of(archive, large=0))
    change(archive, (damage,))
    assert said(page_of(archive, large=0)) == sound
    assert sorted(parsed) == sorted(NAMES)


def test_words_of_another_version_are_made_anew(archive, parsed, monkeypatch):
    monkeypatch.setattr(record_summary, "__version__", "0.0.1")
    page_of(archive, large=0)
    assert sorted(parsed) == sorted(NAMES)


@pytest.mark.parametrize("text", ["", "[]", "3", '{"version": 1}', "[" * 100_000])
def test_what_is_no_summary_is_none(text):
    assert record_summary.summary_in(text) is None


def test_a_summary_is_of_one_curve_after_another(archive, parsed):
    batch(archive.parent, Recipe("srgb", formats=("spi1d",)))
    page = page_of(archive, large=0)
    assert parsed == []
    assert "srgb" in page.word("line", page.row("film.jpg"))


def test_a_worker_s_summary_is_a_short_text(archive):
    task = Task(archive.parent / "photos" / "film.jpg", "film.jpg", Place.of(archive), Recipe())
    result = Result("calibrated", "weak", summary="{}")
    assert checked(task, result).summary == "{}"
    for odd in ("x" * 70_000, b"{}", None):
        with pytest.raises(ValueError, match="none of its kind"):
            checked(task, replace(result, summary=odd))
