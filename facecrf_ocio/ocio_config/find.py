"""The LUTs a config is made of, and what is known of their photos."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.errors import LutError, reason_of
from facecrf_ocio.files.folders import real_path
from facecrf_ocio.image.lut_lookup import lut_processor
from facecrf_ocio.lut.format_table import config_suffixes
from facecrf_ocio.lut.records import lut_records, space_by_matrix
from facecrf_ocio.record.lut_names import Records, Told, told_of
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
    leads_to
        Linear RGB that the LUT's own records name; None where they name none.
    mixes
        Whether the result's channels depend on each other, as behind a matrix.
    """

    path: Path
    stem: str
    photo: str | None = None
    folders: tuple[str, ...] = ()
    space: str = ""
    primaries: Primaries | None = None
    leads_to: Primaries | None = None
    mixes: bool = False


def find_luts(paths: Sequence[Path]) -> tuple[PhotoLut, ...]:
    """LUTs that linearize, among files and folders.

    Of several in a folder for one photo the first by `format_table` counts, and one to the
    photo's own linear RGB before those to working spaces; those that encode do not.

    Raises
    ------
    LutError
        If a LUT is missing or cannot be read, encodes, or none is left. Those in a folder that
        encode by their names are left out.
    """
    try:
        found = _found(tuple(map(Path, paths)))
    except OSError as error:
        problem = reason_of(error)
        raise LutError(f"{error.filename}: cannot be read: {problem}; check the folder") from error
    homes = [real_path(lut).parent for lut in found]
    shared = Path(os.path.commonpath(homes))
    return tuple(
        PhotoLut(
            lut,
            told.stem,
            None if told.source is None else told.source.name,
            home.relative_to(shared).parts,
            told.space,
            None if told.source is None else told.source.primaries,
            *_way(lut, told),
        )
        for (lut, told), home in zip(found.items(), homes, strict=True)
    )


def _found(paths: Sequence[Path]) -> dict[Path, Told]:
    found: dict[Path, Told] = {}
    records: Records = {}
    for path in paths:
        if path.is_dir():
            found |= dict(_in_folder(path, records))
        else:
            told = told_of(path, records)
            if told.encodes:
                raise LutError(f"{path}: it encodes; name the LUT that linearizes")
            found[path] = told
    if not found:
        raise LutError(f"{', '.join(map(str, paths))}: no LUT; name a LUT or a folder of them")
    return found


def _way(lut: Path, told: Told) -> tuple[Primaries | None, bool]:
    """The linear RGB a LUT says it leads to, and whether it mixes channels."""
    processor = lut_processor(lut)
    records = lut_records(processor, encodes="its name" if told.encodes else "")
    if records.encodes:
        raise LutError(f"{lut}: it encodes, by {records.encodes}; name the LUT that linearizes")
    mixes = bool(processor.hasChannelCrosstalk())
    return records.after or space_by_matrix(processor), mixes


def _in_folder(folder: Path, records: Records) -> Iterator[tuple[Path, Told]]:
    """The LUT of each photo below a folder, in the order of their names."""
    suffixes = config_suffixes()
    best: dict[Path, tuple[tuple[bool, int, int], Path, Told]] = {}
    for lut in sorted(folder.rglob("*")):
        suffix = lut.suffix.lower()
        if suffix not in suffixes or not lut.is_file():
            continue
        told = told_of(lut, records)
        if told.encodes:
            continue
        rank = (told.space != "", suffixes.index(suffix), len(lut.name))
        photo = lut.parent / told.stem
        if photo not in best or rank < best[photo][0]:
            best[photo] = rank, lut, told
    for photo in sorted(best):
        _, lut, told = best[photo]
        yield lut, told
