"""What a LUT's name, and the record beside it, say of it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.errors import LutError
from facecrf_ocio.lut.write import split_ending
from facecrf_ocio.record.calibration_record import read_source
from facecrf_ocio.record.output_names import RECORD, output_path
from facecrf_ocio.record.source_record import Source


@dataclass(frozen=True, slots=True)
class Told:
    """What the name of a LUT and the record beside it tell.

    Attributes
    ----------
    stem
        What the name begins with: the photo's name, with suffix or without.
    space
        Working space it leads to; empty for the photo's own linear RGB.
    encodes
        Whether it goes from linear light to code values.
    source
        The photo, if there is a record.
    """

    stem: str
    space: str
    encodes: bool
    source: Source | None


# What records tell, by their paths: each is read once.
Records = dict[Path, tuple[Source, tuple[str, ...]]]


def told_of(lut: Path, records: Records) -> Told:
    """Go by the record that lists a LUT; without one, by how our files are named.

    Raises
    ------
    LutError
        If there is a record that cannot be read.
    """
    readings = list(_readings(lut.name))
    for stem, space, encodes in readings:
        record = output_path(lut.parent, stem, RECORD)
        # Without an error for a name that no disk takes, as that of a long LUT's record may be.
        if record not in records and os.path.isfile(record):  # noqa: PTH113
            records[record] = read_source(record)
        if record in records and lut.name in records[record][1]:
            return Told(stem, space, encodes, records[record][0])
    stem, space, encodes = readings[-1]
    return Told(stem, space, encodes, None)


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
