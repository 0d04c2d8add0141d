"""What a worker on another machine says is believed only as far as it can be true."""

from __future__ import annotations

from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest

from facecrf_ocio.archive.place import Place
from facecrf_ocio.archive.task import (
    FAILED,
    GATHER,
    Gathered,
    Output,
    Recipe,
    Result,
    Task,
    Timing,
)
from facecrf_ocio.archive.work.delivered import accepted
from facecrf_ocio.archive.work.parcel import Delivery
from facecrf_ocio.archive.work.worker_answer import checked
from facecrf_ocio.files.plain_text import LONGEST
from facecrf_ocio.photo.shot import Shot

LUT, RECORD = b"a LUT", b"a record"
REFUSED = "none of its kind|was not asked for|no result"
HUGE = 10**400  # no float holds it


def output(name: str, content: bytes) -> Output:
    return Output(name, len(content), sha256(content).hexdigest(), 7)


OUTPUTS = (output("sub/a.jpg.spi1d", LUT), output("sub/a.jpg.crf.json", RECORD))
GOOD = Result("calibrated", "weak", "joint", "why", sha256="ab" * 32, outputs=OUTPUTS)
EVIDENCE = Result("", sha256="ab" * 32, gathered=Gathered("{}"))


@pytest.fixture
def task(tmp_path: Path) -> Task:
    folder = tmp_path / "outputs"
    folder.mkdir()
    recipe = Recipe("joint", formats=("spi1d",))
    return Task(tmp_path / "a.jpg", "sub/a.jpg", Place.of(folder), recipe)


def test_what_can_be_is_taken_as_it_is(task: Task) -> None:
    assert checked(task, GOOD) == GOOD
    assert checked(replace(task, step=GATHER), EVIDENCE) == EVIDENCE


@pytest.mark.parametrize(
    "said",
    [
        *(None, "calibrated", {"outcome": "calibrated"}, Delivery()),
        *(replace(GOOD, outcome=odd) for odd in ("done", "", None, ["calibrated"], HUGE)),
        *(replace(GOOD, verdict=odd) for odd in ("sure", None, {})),
        *(replace(GOOD, sha256=odd) for odd in ("ab", "AB" * 32, b"ab" * 32, None, "é" * 64)),
        *(replace(GOOD, camera=odd) for odd in (None, 4, "four", ("a",), ("a",) * 5)),
        *(replace(GOOD, timing=odd) for odd in (None, Timing(read=float("nan")), Timing(HUGE))),
        *(replace(GOOD, timing=odd) for odd in (Timing("1"), Timing(write=None))),  # type: ignore[arg-type]
        *(replace(GOOD, shot=odd) for odd in (None, Shot("", float("inf")), Shot("", HUGE))),
        *(replace(GOOD, lasting=odd) for odd in (None, 1, "no")),
        replace(GOOD, gathered=Gathered("{}")),
        EVIDENCE,  # nobody asked for it
    ],
)
def test_other_kinds_and_numbers_that_are_none_are_refused(task: Task, said: Any) -> None:
    with pytest.raises(ValueError, match=REFUSED):
        checked(task, said)


@pytest.mark.parametrize(
    "gathered",
    [
        *(None, "{}", Gathered(None), Gathered("{}", 5), Gathered("{}", "", "text")),  # type: ignore[arg-type]
        Gathered("x" * (1 << 26)),
    ],
)
def test_evidence_of_another_kind_or_without_end_is_refused(task: Task, gathered: Any) -> None:
    with pytest.raises(ValueError, match=REFUSED):
        checked(replace(task, step=GATHER), replace(EVIDENCE, gathered=gathered))


@pytest.mark.parametrize(
    "odd",
    [
        *(output(name, LUT) for name in ("/etc/passwd", "../a.jpg.spi1d", "sub/../../x", "")),
        *(output(name, LUT) for name in ("sub/b.jpg.spi1d", "sub/a.jpg.spi1d\0", "sub/a.jpg")),
        *(replace(OUTPUTS[0], name=odd) for odd in (None, b"sub/a.jpg.spi1d", ["a"])),
        *(replace(OUTPUTS[0], size=odd) for odd in (-1, 1 << 63, HUGE, 5.0, None)),
        *(replace(OUTPUTS[0], written_ns=odd) for odd in (-1, 1 << 63, None)),
        *(replace(OUTPUTS[0], sha256=odd) for odd in ("", None, "zz" * 32)),
        *(None, "sub/a.jpg.spi1d", OUTPUTS[1]),  # the last one twice
    ],
)
def test_outputs_that_were_not_asked_for_are_refused(task: Task, odd: Any) -> None:
    with pytest.raises(ValueError, match=REFUSED):
        checked(task, replace(GOOD, outputs=(odd, OUTPUTS[1])))


@pytest.mark.parametrize("odd", [None, [], "sub/a.jpg.spi1d", {"a": 1}])
def test_outputs_that_are_no_row_are_refused(task: Task, odd: Any) -> None:
    with pytest.raises(ValueError, match=REFUSED):
        checked(task, replace(GOOD, outputs=odd))


def test_text_becomes_plain_and_short(task: Task) -> None:
    said = replace(GOOD, reason="a\x1b[2J\udce9" + "x" * 99_999, camera=("A\0", b"\xe9", None, 5))  # type: ignore[arg-type]
    found = checked(task, said)
    assert found.reason.startswith("a [2Jéx")
    assert len(found.reason) <= LONGEST
    assert found.camera[:2] == ("A", "é")
    assert all(isinstance(text, str) for text in found.camera)


def test_sent_files_are_written_where_they_belong(task: Task) -> None:
    assert accepted(task, Delivery(GOOD, (LUT, RECORD)), shipped=True) == GOOD
    assert (task.place.folder / "sub" / "a.jpg.spi1d").read_bytes() == LUT


@pytest.mark.parametrize(
    ("contents", "shipped"),
    [
        *((odd, True) for odd in ((), (LUT,), (LUT, b"other"), (RECORD, LUT), [LUT, RECORD])),
        *((odd, True) for odd in (None, "text", ("a LUT", "a record"), (LUT, RECORD, b""))),
        *((odd, False) for odd in ((LUT, RECORD), (LUT,), [LUT, RECORD], "text", None)),
    ],
)
def test_files_that_are_not_what_the_answer_says_are_not_written(
    task: Task, contents: Any, shipped: bool
) -> None:
    result = accepted(task, Delivery(GOOD, contents), shipped=shipped)
    assert (result.outcome, result.lasting) == (FAILED, False)
    assert result.reason.startswith("a worker gave an answer that cannot be: ")
    assert list(task.place.folder.iterdir()) == []


def test_a_folder_that_became_a_link_is_not_written_through(task: Task, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (task.place.folder / "sub").symlink_to(elsewhere)
    result = accepted(task, Delivery(GOOD, (LUT, RECORD)), shipped=True)
    assert result.outcome == FAILED
    assert list(elsewhere.iterdir()) == []
