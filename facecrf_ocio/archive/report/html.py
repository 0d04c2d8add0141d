"""The page of a report: data that only its own script reads, and nothing from elsewhere."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from itertools import islice
from pathlib import Path
from typing import TypeVar

from facecrf_ocio import __version__
from facecrf_ocio.archive.report.contents import KINDS, Archive, Bracket, Group, PhotoRow
from facecrf_ocio.archive.report.page_source import ARCHIVE_PAGE, around
from facecrf_ocio.archive.report.pictures import Pictures
from facecrf_ocio.archive.report.reason_kinds import reason_kinds
from facecrf_ocio.archive.report.small_curves import (
    STOPS_RANGE,
    CurveList,
    drawn_from_json,
    srgb_samples,
)
from facecrf_ocio.archive.task import Thumbnail
from facecrf_ocio.archive.thumbnail import SIDE
from facecrf_ocio.files.atomic import Draft
from facecrf_ocio.response.stops import NINETY_PERCENT

BLOCK = 50
"""Photos whose pictures stand in one block, which is parsed when one of them is shown."""

_Value = TypeVar("_Value")


class _Words:
    """Texts without repetition: a column of texts becomes one of small numbers."""

    def __init__(self) -> None:
        self._places: dict[str, int] = {}

    def column(self, texts: Iterable[str]) -> list[int]:
        return [self._places.setdefault(text, len(self._places)) for text in texts]

    @property
    def texts(self) -> tuple[str, ...]:
        return tuple(self._places)


def page_draft(path: Path, pieces: Iterable[bytes]) -> Draft:
    """The file that a page becomes."""

    def write(temporary: Path) -> None:
        with temporary.open("wb") as file:
            file.writelines(pieces)

    return Draft(path, write, lambda _: None)


def this_minute() -> str:
    """When a page is made: the local time, as pages tell it."""
    return datetime.now().astimezone().isoformat(sep=" ", timespec="minutes")


def render(
    archive: Archive,
    pictures: Mapping[str, Pictures],
    *,
    generated: str,
    source_is_there: bool,
    links: tuple[str, str] = ("", ""),
    title: str = ARCHIVE_PAGE,
) -> Iterator[bytes]:
    """Yield the HTML of a report in pieces, since tens of megabytes are not to be held twice.

    Parameters
    ----------
    archive
        What the manifest tells.
    pictures
        By the photos' names; of photos that are not in it there is nothing to see.
    generated
        Date and time to be shown.
    source_is_there
        Whether the folder of the photos could be found.
    links
        Addresses of the folders of the photos and of the outputs; empty where none is known.
    title
        `ARCHIVE_PAGE` or `PHOTO_PAGE`, which says what page it is.
    """
    curves = CurveList()
    words = _Words()
    columns = _columns(archive, pictures, curves, words)
    data = {
        "version": __version__,
        "generated": generated,
        "folder": str(archive.folder.absolute()),
        "source": "" if archive.source is None else str(archive.source),
        "sourceThere": source_is_there,
        "kinds": KINDS,
        "side": SIDE,
        "block": BLOCK,
        "links": links,
        "pictured": len(pictures),
        "large": sum(item.large is not None for item in pictures.values()),
        "small": sum(map(_is_small, pictures.values())),
        "srgb": srgb_samples(),
        "stopsRange": STOPS_RANGE,
        "ninety": NINETY_PERCENT,
        "groups": [_group(group, curves) for group in archive.groups],
        "brackets": [_bracket(bracket, curves) for bracket in archive.brackets],
        "columns": columns,
        "words": words.texts,
    }
    head, tail = around(title)
    yield _utf8(head)
    yield _element("data", data)
    yield _element("curves", curves.texts)
    yield from _pictures([pictures[row.name] for row in archive.rows if row.name in pictures])
    yield _utf8(tail)


def _pictures(shown: Sequence[Pictures]) -> Iterator[bytes]:
    for number, block in enumerate(_batched(shown, BLOCK)):
        yield _element(f"pictures-{number}", [_texts(item.small) for item in block])
    for number, item in enumerate(shown):
        if item.large is not None:
            yield _element(f"large-{number}", _texts(item.large))


def _is_small(shown: Pictures) -> bool:
    return shown.small is not None and shown.small.before != b"" and shown.large is None


def _texts(webps: Thumbnail | None) -> list[str]:
    webps = webps or Thumbnail(b"")
    return [base64.b64encode(webp).decode() for webp in (webps.before, webps.after)]


def _element(name: str, value: object) -> bytes:
    return _utf8(f'<script type="application/json" id="{name}">{_json(value)}</script>\n')


def _utf8(text: str) -> bytes:
    # What UTF-8 cannot hold becomes JSON's own escape: it can stand in the data alone.
    return text.encode("utf-8", "backslashreplace")


def _columns(
    archive: Archive, pictures: Mapping[str, Pictures], curves: CurveList, words: _Words
) -> dict[str, object]:
    """One list for each property of the photos, which is half the size of one list a photo."""
    rows = archive.rows
    seen = [pictures.get(row.name) for row in rows]
    places = iter(range(len(rows)))
    drawn = [None if item is None else item.curve for item in seen]
    expected = [None if item is None else item.expected for item in seen]
    return {
        "name": [row.name for row in rows],
        "size": [max(row.size, 0) for row in rows],
        "kind": [KINDS.index(row.kind) for row in rows],
        "outcome": words.column(row.outcome for row in rows),
        "estimator": words.column(row.estimator for row in rows),
        "reason": words.column(row.reason for row in rows),
        "reasonKind": words.column(reason_kinds(row.reason for row in rows)),
        "remedy": words.column(row.remedy for row in rows),
        "make": words.column(row.camera[0] for row in rows),
        "model": words.column(row.camera[1] for row in rows),
        "serial": words.column(row.camera[2] for row in rows),
        "software": words.column(row.camera[3] for row in rows),
        "whose": words.column(row.curve for row in rows),
        "group": words.column(row.group for row in rows),
        "bracket": words.column(row.bracket for row in rows),
        "duplicateOf": words.column(row.duplicate_of for row in rows),
        "misfit": [round(row.misfit, 2) if row.name in archive.misfits else 0 for row in rows],
        "seconds": [round(row.seconds, 2) for row in rows],
        "faces": [-1 if item is None else item.faces for item in seen],
        "missing": words.column("" if item is None else item.missing for item in seen),
        **{name: words.column(_told(item, name) for item in seen) for name in _TOLD},
        "files": words.column(
            "\n".join(_endings(row, item)) for row, item in zip(rows, seen, strict=True)
        ),
        "picture": [-1 if item is None else next(places) for item in seen],
        "curve": [curves.place(curve) for curve in drawn],
        "band": [-1 if curve is None else curve.band for curve in drawn],
        "stops": [-1 if told is None else round(told[0], 3) for told in expected],
        "shadows": [-1 if told is None else round(told[1], 3) for told in expected],
    }


# Texts of `Pictures` that are columns; of several lines each.
_TOLD = ("line", "steps")


def _told(shown: Pictures | None, name: str) -> str:
    said = "" if shown is None else getattr(shown, name)
    return said if isinstance(said, str) else "\n".join(said)


def _endings(row: PhotoRow, shown: Pictures | None) -> Iterable[str]:
    """Names of a photo's files, with `*` for what most begin with: the photo's name."""
    files = () if shown is None else shown.files
    return (f"*{n.removeprefix(row.name)}" if n.startswith(row.name) else n for n in files)


def _group(group: Group, curves: CurveList) -> dict[str, object]:
    curve = drawn_from_json(group.curve)
    return {
        "key": group.key,
        "camera": group.camera,
        "style": group.style,
        "members": group.members,
        "telling": group.telling,
        "used": group.used,
        "misfits": group.misfits,
        "verdict": group.verdict,
        "reason": group.reason,
        "curve": curves.place(curve),
        "band": -1 if curve is None else curve.band,
    }


def _bracket(bracket: Bracket, curves: CurveList) -> dict[str, object]:
    curve = drawn_from_json(bracket.curve)
    return {
        "name": bracket.name,
        "photos": bracket.photos,
        "stops": round(bracket.stops, 1),
        "used": bracket.used,
        "reason": bracket.reason,
        "merged": bracket.merged,
        "mergeReason": bracket.merge_reason,
        "rmse": round(100.0 * bracket.rmse, 1) if bracket.rmse >= 0 else -1,
        "curve": curves.place(curve),
        "band": -1 if curve is None else curve.band,
    }


def _json(value: object) -> str:
    """JSON that cannot end the script element it stands in, whatever a file name holds."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def _batched(items: Iterable[_Value], size: int) -> Iterable[tuple[_Value, ...]]:
    left = iter(items)
    while block := tuple(islice(left, size)):
        yield block
