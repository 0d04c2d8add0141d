"""What a report tells of a photo's record, kept by a batch: reading 10,000 records takes minutes.

A record has all numbers of a curve, 100 kB of them; of these a page draws 33, and says the rest in
words.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from facecrf_ocio import __version__
from facecrf_ocio.archive.report.pictures import Pictures, told
from facecrf_ocio.archive.report.small_curves import DrawnCurve
from facecrf_ocio.record.calibration_record import Record
from facecrf_ocio.values import Estimate

_DAMAGE = (ValueError, TypeError, KeyError, RecursionError)


@dataclass(frozen=True, slots=True)
class Summary:
    """What is shown of a record, still without pictures, and the names of its LUTs."""

    shown: Pictures
    luts: tuple[str, ...]


def summary_of(estimate: Estimate, luts: tuple[str, ...]) -> str:
    """What a report will tell of an estimate, as text for a manifest."""
    shown = told(estimate)
    curve = shown.curve
    record = {
        "version": __version__,
        "curve": None if curve is None else [curve.text, curve.band],
        "faces": shown.faces,
        "expected": shown.expected,
        "line": shown.line,
        "steps": shown.steps,
        "luts": luts,
    }
    return json.dumps(record, ensure_ascii=False, separators=(",", ":"))


def summary_in(text: str) -> Summary | None:
    """What `summary_of` wrote; None if another version did, whose words may be others."""
    try:
        record = json.loads(text)
        if record["version"] != __version__:
            return None
        return Summary(_shown(record), tuple(map(str, record["luts"])))
    except _DAMAGE:
        return None


def summary_of_record(record: Record) -> Summary:
    """The same of a record that was read."""
    return Summary(told(record.estimate), record.luts)


def _shown(record: Any) -> Pictures:
    curve, expected = record["curve"], record["expected"]
    return Pictures(
        curve=None if curve is None else DrawnCurve(str(curve[0]), float(curve[1])),
        faces=int(record["faces"]),
        expected=None if expected is None else (float(expected[0]), float(expected[1])),
        line=str(record["line"]),
        steps=tuple(map(str, record["steps"])),
    )
