"""What a report tells of an archive, read from its manifest of any version."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from facecrf_ocio.archive.manifest.database import DONE
from facecrf_ocio.archive.manifest.read_only import reading
from facecrf_ocio.archive.work.task import FAILED

KINDS = ("reliable", "weak", "prior only", "no curve", "failed", "unfinished")


@dataclass(frozen=True, slots=True)
class Row:
    """One photo of the manifest; what an older manifest does not have is empty or 0.

    Attributes
    ----------
    name
        Key: path relative to the source.
    size, mtime_ns
        By what the photo is known to be the one that was calibrated.
    kind
        One of `KINDS`: the verdict, or why there is none.
    camera
        Make, model, serial number and software.
    seconds
        [s] What reading, estimating and writing took.
    curve
        Whose curve was written: `own`, `camera`, `bracket`; empty without outputs.
    misfit
        How far its evidence lies from the camera's curve, in standard deviations.
    """

    name: str
    size: int
    mtime_ns: int
    kind: str
    outcome: str
    estimator: str
    reason: str
    remedy: str
    camera: tuple[str, str, str, str]
    seconds: float
    duplicate_of: str
    curve: str
    group: str
    misfit: float
    bracket: str


@dataclass(frozen=True, slots=True)
class Group:
    """Photos that share one curve, of a run with pooling; `curve` is the manifest's JSON."""

    key: str
    camera: tuple[str, str, str, str]
    style: str
    members: int
    telling: int
    used: int
    misfits: int
    verdict: str
    reason: str
    curve: str


@dataclass(frozen=True, slots=True)
class Bracket:
    """A series of exposures of one scene; `curve` is the manifest's JSON."""

    name: str
    photos: int
    stops: float
    used: bool
    reason: str
    residual: float
    rmse: float
    curve: str


@dataclass(frozen=True, slots=True)
class Archive:
    """A whole manifest.

    Attributes
    ----------
    folder
        Root of the outputs.
    source
        Root of the photos; None if the manifest does not tell.
    rows
        In the order of names.
    misfits
        Names of the photos that do not fit their camera's curve.
    """

    folder: Path
    source: Path | None
    rows: tuple[Row, ...]
    groups: tuple[Group, ...]
    brackets: tuple[Bracket, ...]
    misfits: frozenset[str] = frozenset()


def gather(folder: Path) -> Archive:
    """Read a manifest without changing it, as it is at one moment even while a batch writes to it.

    Raises
    ------
    OutputError
        If there is no manifest, or it cannot be read.
    """
    with reading(folder) as base:
        base.row_factory = sqlite3.Row
        base.execute("BEGIN")
        source = _source(base)
        rows = tuple(_row(_Fields(record)) for record in _all(base, "photos", "name"))
        groups = tuple(_group(_Fields(record)) for record in _all(base, "cameras", "key"))
        brackets = tuple(_bracket(_Fields(record)) for record in _all(base, "brackets", "name"))
    return Archive(folder, source, rows, groups, brackets, _misfits(rows, groups))


def _all(base: sqlite3.Connection, table: str, key: str) -> Iterator[sqlite3.Row]:
    """Rows of a table that a manifest of another version may lack, in the order of their keys."""
    there = base.execute("SELECT 1 FROM sqlite_master WHERE name = ?", (table,)).fetchone()
    if there is not None:
        # Both names are ours.
        yield from base.execute(f"SELECT * FROM {table} ORDER BY {key}")  # noqa: S608


def _source(base: sqlite3.Connection) -> Path | None:
    row = base.execute("SELECT value FROM about WHERE key = 'source'").fetchone()
    return None if row is None else Path(row[0])


@dataclass(frozen=True, slots=True)
class _Fields:
    """Columns by name, empty where the manifest has none."""

    record: Mapping[str, Any] | sqlite3.Row

    def text(self, name: str) -> str:
        return str(self._get(name, ""))

    def number(self, name: str) -> float:
        return float(self._get(name, 0.0))

    def whole(self, name: str) -> int:
        return int(self._get(name, 0))

    def camera(self) -> tuple[str, str, str, str]:
        return self.text("make"), self.text("model"), self.text("serial"), self.text("software")

    def _get(self, name: str, default: Any) -> Any:
        value = self.record[name] if name in self.record.keys() else None  # noqa: SIM118
        return default if value is None else value


def _row(fields: _Fields) -> Row:
    return Row(
        name=fields.text("name"),
        size=fields.whole("size"),
        mtime_ns=fields.whole("mtime_ns"),
        kind=_kind(fields.text("state"), fields.text("outcome"), fields.text("verdict")),
        outcome=fields.text("outcome"),
        estimator=fields.text("estimator"),
        reason=fields.text("reason"),
        remedy=fields.text("remedy"),
        camera=fields.camera(),
        seconds=sum(fields.number(name) for name in ("read_s", "estimate_s", "write_s")),
        duplicate_of=fields.text("duplicate_of"),
        curve=fields.text("curve"),
        group=fields.text("camera"),
        misfit=fields.number("misfit"),
        bracket=fields.text("bracket"),
    )


def _misfits(rows: Sequence[Row], groups: Sequence[Group]) -> frozenset[str]:
    """The members that lie farthest from their camera's curve, as many as the camera counted."""
    counts = {group.key: group.misfits for group in groups if group.misfits}
    members: dict[str, list[Row]] = {}
    for row in rows:
        if row.group in counts:
            members.setdefault(row.group, []).append(row)
    far = (
        sorted(each, key=lambda row: -row.misfit)[: counts[key]] for key, each in members.items()
    )
    return frozenset(row.name for group in far for row in group)


def _kind(state: str, outcome: str, verdict: str) -> str:
    if state != DONE:
        return "unfinished"
    if outcome == FAILED:
        return "failed"
    return verdict if verdict in KINDS else "no curve"


def _group(fields: _Fields) -> Group:
    return Group(
        key=fields.text("key"),
        camera=fields.camera(),
        style=fields.text("style"),
        members=fields.whole("members"),
        telling=fields.whole("telling"),
        used=fields.whole("used"),
        misfits=fields.whole("misfits"),
        verdict=fields.text("verdict"),
        reason=fields.text("reason"),
        curve=fields.text("curve"),
    )


def _bracket(fields: _Fields) -> Bracket:
    return Bracket(
        name=fields.text("name"),
        photos=fields.whole("photos"),
        stops=fields.number("stops"),
        used=bool(fields.whole("used")),
        reason=fields.text("reason"),
        residual=fields.number("residual"),
        rmse=fields.number("rmse"),
        curve=fields.text("curve"),
    )
