"""What a report tells of an archive, read from its manifest of any version."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.archive.manifest.database import DONE
from facecrf_ocio.archive.manifest.read_only import Fields, reading
from facecrf_ocio.archive.task import FAILED
from facecrf_ocio.errors import in_options
from facecrf_ocio.settings import VERDICTS

KINDS = (*reversed(VERDICTS), "no curve", "failed", "unfinished")


@dataclass(frozen=True, slots=True)
class PhotoRow:
    """One photo of the manifest; what an older manifest does not have is empty or 0.

    Attributes
    ----------
    name
        Key: path relative to the source.
    size, mtime_ns
        By what the photo is known to be the one that was calibrated.
    sha256
        Of the photo's bytes; empty if they could not be read.
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
    sha256: str
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
    """A series of exposures of one scene.

    `curve` is the manifest's JSON; `merged` a file, and `merge_reason` what is told of it, or why
    there is none.
    """

    name: str
    photos: int
    stops: float
    used: bool
    reason: str
    residual: float
    rmse: float
    curve: str
    merged: str = ""
    merge_reason: str = ""


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
    rows: tuple[PhotoRow, ...]
    groups: tuple[Group, ...]
    brackets: tuple[Bracket, ...]
    misfits: frozenset[str] = frozenset()


def read_archive(folder: Path) -> Archive:
    """Read a manifest without changing it, as it is at one moment even while a batch writes to it.

    Raises
    ------
    OutputError
        If there is no manifest, or it cannot be read.
    """
    with reading(folder) as manifest:
        told = manifest.about("source")
        rows = tuple(sorted(map(_row, manifest.photos()), key=lambda row: in_order(row.name)))
        groups = tuple(map(_group, manifest.cameras()))
        merged = {
            fields.name("name"): (fields.name("file"), fields.text("reason"))
            for fields in manifest.merges()
        }
        found = (_bracket(fields, merged) for fields in manifest.brackets())
        brackets = tuple(sorted(found, key=lambda bracket: in_order(bracket.name)))
    source = None if told is None else Path(told)
    return Archive(folder, source, rows, groups, brackets, _misfits(rows, groups))


def in_order(name: str) -> tuple[tuple[str | int, ...], ...]:
    """Key by which names come in the order of their numbers, folder by folder: 2.jpg, 10.jpg."""
    return (*map(_parts, name.casefold().split("/")), (name,))


def _parts(text: str) -> tuple[str | int, ...]:
    # Texts at even places, numbers at odd ones; without leading zeros a longer number is larger.
    parts = re.split("([0-9]+)", text)
    numbers = (part.lstrip("0") for part in parts[1::2])
    pairs = zip(numbers, parts[2::2], strict=True)
    return (parts[0], *(each for n, after in pairs for each in (len(n), n, after)))


def _camera(fields: Fields) -> tuple[str, str, str, str]:
    return fields.text("make"), fields.text("model"), fields.text("serial"), fields.text("software")


def _row(fields: Fields) -> PhotoRow:
    return PhotoRow(
        name=fields.name("name"),
        size=fields.whole("size"),
        mtime_ns=fields.whole("mtime_ns"),
        sha256=fields.text("sha256"),
        kind=_kind(fields.text("state"), fields.text("outcome"), fields.text("verdict")),
        outcome=fields.text("outcome"),
        estimator=fields.text("estimator"),
        reason=fields.text("reason"),
        remedy=in_options(fields.text("remedy"), "facecrf batch"),
        camera=_camera(fields),
        seconds=sum(fields.number(name) for name in ("read_s", "estimate_s", "write_s")),
        duplicate_of=fields.name("duplicate_of"),
        curve=fields.text("curve"),
        group=fields.text("camera"),
        misfit=fields.number("misfit"),
        bracket=fields.name("bracket"),
    )


def _misfits(rows: Sequence[PhotoRow], groups: Sequence[Group]) -> frozenset[str]:
    """The members that lie farthest from their camera's curve, as many as the camera counted."""
    counts = {group.key: group.misfits for group in groups if group.misfits}
    members: dict[str, list[PhotoRow]] = {}
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


def _group(fields: Fields) -> Group:
    return Group(
        key=fields.text("key"),
        camera=_camera(fields),
        style=fields.text("style"),
        members=fields.whole("members"),
        telling=fields.whole("telling"),
        used=fields.whole("used"),
        misfits=fields.whole("misfits"),
        verdict=fields.text("verdict"),
        reason=fields.text("reason"),
        curve=fields.text("curve"),
    )


def _bracket(fields: Fields, merged: Mapping[str, tuple[str, str]]) -> Bracket:
    file, reason = merged.get(fields.name("name"), ("", ""))
    return Bracket(
        name=fields.name("name"),
        photos=fields.whole("photos"),
        stops=fields.number("stops"),
        used=bool(fields.whole("used")),
        reason=fields.text("reason"),
        residual=fields.number("residual"),
        rmse=fields.number("rmse"),
        curve=fields.text("curve"),
        merged=file,
        merge_reason=reason,
    )
