"""The LUTs a config is made of, and what is known of their photos."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.errors import LutError, reason_of
from facecrf_ocio.image.lut_lookup import lut_processor
from facecrf_ocio.lut.format_table import config_suffixes
from facecrf_ocio.lut.write import split_ending
from facecrf_ocio.record.sidecar import SUFFIX, Source, read_source
from facecrf_ocio.values import Primaries


@dataclass(frozen=True, slots=True)
class PhotoLut:
    """A LUT that linearizes one photo.

    Attributes
    ----------
    path
        The file.
    stem
        What its name is made of: the photo's name, with suffix or without.
    photo
        The photo's file name, where the record beside the LUT tells it.
    folders
        Where it is below the folder that all LUTs share.
    space
        Working space it leads to; empty for the photo's own linear RGB.
    primaries
        The photo's, where the record tells them.
    """

    path: Path
    stem: str
    photo: str | None = None
    folders: tuple[str, ...] = ()
    space: str = ""
    primaries: Primaries | None = None


def find_luts(paths: Sequence[Path]) -> tuple[PhotoLut, ...]:
    """LUTs that linearize, among files and folders.

    Of several in a folder for one photo the first by `format_table` counts, and one to the
    photo's own linear RGB before those to working spaces; those that encode do not.

    Raises
    ------
    LutError
        If a LUT is missing or cannot be read, encodes though it was named, or none is left.
    """
    try:
        found = _found(tuple(map(Path, paths)))
    except OSError as error:
        problem = reason_of(error)
        raise LutError(f"{error.filename}: cannot be read: {problem}; check the folder") from error
    homes = [lut.resolve().parent for lut in found]
    shared = Path(os.path.commonpath(homes))
    return tuple(
        PhotoLut(
            lut,
            told.stem,
            None if told.source is None else told.source.name,
            home.relative_to(shared).parts,
            told.space,
            None if told.source is None else told.source.primaries,
        )
        for (lut, told), home in zip(found.items(), homes, strict=True)
    )


def _found(paths: Sequence[Path]) -> dict[Path, _Told]:
    found: dict[Path, _Told] = {}
    records: _Records = {}
    for path in paths:
        if path.is_dir():
            found |= dict(_in_folder(path, records))
        else:
            told = _told(path, records)
            if told.encodes:
                raise LutError(f"{path}: it encodes; name the LUT that linearizes")
            found[path] = told
    if not found:
        raise LutError(f"{', '.join(map(str, paths))}: no LUT; name a LUT or a folder of them")
    for lut in found:
        lut_processor(lut)
    return found


@dataclass(frozen=True, slots=True)
class _Told:
    """What the name of a LUT and the record beside it tell."""

    stem: str
    space: str
    encodes: bool
    source: Source | None


# What records tell, by their paths: each is read once.
_Records = dict[Path, tuple[Source, tuple[str, ...]]]


def _in_folder(folder: Path, records: _Records) -> Iterator[tuple[Path, _Told]]:
    """The LUT of each photo below a folder, in the order of their names."""
    suffixes = config_suffixes()
    best: dict[Path, tuple[tuple[bool, int, int], Path, _Told]] = {}
    for lut in sorted(folder.rglob("*")):
        suffix = lut.suffix.lower()
        if suffix not in suffixes or not lut.is_file():
            continue
        told = _told(lut, records)
        if told.encodes:
            continue
        rank = (told.space != "", suffixes.index(suffix), len(lut.name))
        photo = lut.parent / told.stem
        if photo not in best or rank < best[photo][0]:
            best[photo] = rank, lut, told
    for photo in sorted(best):
        _, lut, told = best[photo]
        yield lut, told


def _told(lut: Path, records: _Records) -> _Told:
    """Go by the record that lists the LUT; without one, by how our files are named."""
    readings = list(_readings(lut.name))
    for stem, space, encodes in readings:
        record = lut.parent / f"{stem}{SUFFIX}"
        if record not in records and record.is_file():
            records[record] = read_source(record)
        if record in records and lut.name in records[record][1]:
            return _Told(stem, space, encodes, records[record][0])
    stem, space, encodes = readings[-1]
    return _Told(stem, space, encodes, None)


def _readings(name: str) -> Iterator[tuple[str, str, bool]]:
    """What a name may mean as stem, working space, whether it encodes; the longest stem first."""
    *parts, suffix = name.split(".")
    yield ".".join(parts), "", False
    for count in range(1, min(len(parts), 4)):
        stem, ending = parts[:-count], [*parts[-count:], suffix.lower()]
        try:
            space, direction, _ = split_ending(".".join(ending))
        except LutError:
            continue
        yield ".".join(stem), space, direction == "encode"
