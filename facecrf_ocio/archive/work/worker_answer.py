"""Whether what a worker on another machine says can be true, before anything is done by it."""

from __future__ import annotations

import re
from dataclasses import replace

from facecrf_ocio.archive.task import (
    FAILED,
    GATHER,
    Gathered,
    Output,
    Result,
    Task,
    Thumbnail,
    Timing,
)
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.photo.shot import Shot
from facecrf_ocio.values import Outcome, Verdict

_OUTCOMES = frozenset((FAILED, *map(str, Outcome)))
_VERDICTS = frozenset(("", *map(str, Verdict)))
_SHA256 = re.compile("[0-9a-f]{64}")
_MOST = float(1 << 63)  # the manifest's whole numbers are below
_LONGEST = 1 << 26  # [byte] evidence of a photo; real one takes less than 200 kB

_LARGEST = 1 << 16  # [byte] a thumbnail; 96 pixels of noise take less than 10 kB
_WORDIEST = 1 << 16  # characters of a summary; real ones have some 2,000


def checked(task: Task, said: object) -> Result:
    """The result that a worker gave of a task, its texts made plain.

    Raises
    ------
    ValueError
        If it cannot be one: an output that was not asked for, a number that is none.
    """
    if not isinstance(said, Result):
        raise ValueError("it is no result")
    _require(isinstance(said.outcome, str) and isinstance(said.verdict, str))
    _require(said.outcome in _OUTCOMES or (said.outcome == "" and _is_evidence(task, said)))
    _require(said.outcome == "" or said.gathered is None)
    _require(said.verdict in _VERDICTS)
    _require(said.sha256 == "" or _is_hash(said.sha256))
    _require(isinstance(said.timing, Timing) and isinstance(said.shot, Shot))
    _require(isinstance(said.lasting, bool))
    _require(isinstance(said.camera, tuple) and len(said.camera) == 4)
    shot = said.shot
    for number in (*_timing(said.timing), shot.taken, shot.exposure_s, shot.aperture, shot.iso):
        _require(_is_number(number))
    _require_outputs(task, said.outputs)
    _require(said.thumbnail is None or _is_thumbnail(said.thumbnail))
    _require(isinstance(said.summary, str) and len(said.summary) < _WORDIEST)
    make, model, serial, software = map(plain_text, said.camera)
    return replace(
        said,
        estimator=plain_text(said.estimator),
        reason=plain_text(said.reason),
        remedy=plain_text(said.remedy),
        stop=plain_text(said.stop),
        camera=(make, model, serial, software),
        shot=replace(shot, style=plain_text(shot.style)),
    )


def _timing(timing: Timing) -> tuple[float, float, float]:
    return timing.read, timing.estimate, timing.write


def _is_evidence(task: Task, said: Result) -> bool:
    gathered = said.gathered
    if task.step != GATHER or not isinstance(gathered, Gathered) or said.outputs:
        return False
    texts = isinstance(gathered.evidence, str) and isinstance(gathered.face, str)
    if not texts or not isinstance(gathered.samples, bytes):
        return False
    return len(gathered.evidence) + len(gathered.face) + len(gathered.samples) < _LONGEST


def _is_thumbnail(said: object) -> bool:
    return isinstance(said, Thumbnail) and all(
        isinstance(webp, bytes) and len(webp) < _LARGEST for webp in (said.before, said.after)
    )


def _require_outputs(task: Task, outputs: object) -> None:
    _require(isinstance(outputs, tuple))
    assert isinstance(outputs, tuple)  # noqa: S101 - just asked
    names = []
    for output in outputs:
        _require(isinstance(output, Output))
        _require(isinstance(output.name, str) and _is_hash(output.sha256))
        _require(isinstance(output.size, int) and 0 <= output.size < _MOST)
        _require(isinstance(output.written_ns, int) and 0 <= output.written_ns < _MOST)
        names.append(output.name)
    unasked = set(names) - set(task.planned)
    if unasked or len(set(names)) != len(names):
        raise ValueError(f"it names {plain_text(min(unasked or names))}, which was not asked for")


def _is_number(number: object) -> bool:
    """Finite, and small enough for the manifest; a whole one may be too large for a float."""
    return isinstance(number, float | int) and -_MOST < number < _MOST


def _is_hash(text: object) -> bool:
    return isinstance(text, str) and _SHA256.fullmatch(text) is not None


def _require(holds: bool) -> None:
    if not holds:
        raise ValueError("a field of it is none of its kind")
