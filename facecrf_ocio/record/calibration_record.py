"""The record of a calibration that stands beside its LUTs, NAME.crf.json."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path, PurePath
from typing import Any, TypeVar

import numpy as np

from facecrf_ocio.checks import typed
from facecrf_ocio.errors import FaceCRFError, LutError, reason_of
from facecrf_ocio.files import strict_json
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.files.versions import versions
from facecrf_ocio.record.estimate_record import estimate_record, read_estimate
from facecrf_ocio.record.sampled import read_rows, thinned
from facecrf_ocio.record.source_record import Source, source_in, source_of
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Estimate, InverseCRF, Photo, frozen
from facecrf_ocio.wording.expectation import expectation
from facecrf_ocio.wording.sentence import sentence

SCHEMA = "facecrf sidecar"  # what a record was called first; files that exist say so
SCHEMA_VERSION = 2
"""1 wrote all numbers of a curve for each channel; it is read, too."""

_LARGEST = 32 << 20  # [byte] the largest ever written, of version 1, has half a megabyte
# What numbers, texts and nothing in the place of something else make of us.
_DAMAGE = (
    *(ArithmeticError, AttributeError, LookupError, MemoryError),
    *(RecursionError, TypeError, ValueError),
)
_T = TypeVar("_T")


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """What a record holds.

    Attributes
    ----------
    estimate
        Its curve to the last digit; the numbers of its confidence have six significant digits,
        where they are smooth they are within 1e-5. Its faces are without landmarks.
    settings
        All settings of the calibration, by name.
    versions
        Versions of this package, of Python and of the libraries, and the processor.
    luts
        Names of the LUT files written with it.
    """

    source: Source
    estimate: Estimate
    settings: Mapping[str, bool | int | float | str]
    versions: Mapping[str, str]
    luts: tuple[str, ...]


def write_record(
    path: Path,
    photo: Photo,
    estimate: Estimate,
    settings: Settings,
    *,
    luts: Sequence[Path] = (),
    overwrite: bool = False,
) -> Path:
    """Write the record of one calibration, with or without a curve.

    Raises
    ------
    OutputError
        If the file exists and `overwrite` is false, or it cannot be written.
    """
    return write_files([record_draft(path, photo, estimate, settings, luts)], overwrite=overwrite)[
        0
    ]


def record_draft(
    path: Path, photo: Photo, estimate: Estimate, settings: Settings, luts: Sequence[Path]
) -> Draft:
    """Return the record to be written, which is read back before it appears."""
    as_read = _as_read(estimate)  # which is written as the estimate itself, and thinned already
    expected = expectation(as_read)
    record = {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        **estimate_record(as_read),
        "summary": sentence(estimate),
        "expected": None if expected is None else expected.record(),
        "source": asdict(source_of(photo)),
        "luts": [lut.name for lut in luts],
        "linear_light": {
            "exposure": "relative: known up to one factor",
            "primaries": "unknown" if photo.primaries is None else photo.primaries.name,
        },
        "settings": asdict(settings),
        "versions": versions(),
    }
    return Draft(path, strict_json.dump(record), lambda written: _compare(written, path, estimate))


def _as_read(estimate: Estimate) -> Estimate:
    """The estimate with the band that the record holds, so that duplicates get the same bytes."""
    told = estimate.confidence
    if told is None:
        return estimate
    sigma = frozen(read_rows(thinned(told.sigma)))
    return replace(estimate, confidence=replace(told, sigma=sigma))


def read_record(path: Path) -> Record:
    """Read the record of a calibration.

    Raises
    ------
    LutError
        If the file cannot be read, is no record, or comes from a newer version.
    """
    return _read(path, _record_in)


@typed
def read_curve(path: str | Path) -> InverseCRF:
    """Read the curve of a record, NAME.crf.json, to the last digit.

    Raises
    ------
    LutError
        As `read_record` does, or if the photo could not be calibrated.
    """
    path = Path(path)
    curve = read_record(path).estimate.found
    if curve is None:
        raise LutError(f"{path}: holds no curve, since its photo could not be calibrated")
    return curve


def read_source(path: Path) -> tuple[Source, tuple[str, ...]]:
    """Read only what photo a record is of, and which LUTs were written with it.

    Raises
    ------
    LutError
        As `read_record` does.
    """
    return _read(path, lambda record: (source_in(record["source"]), _read_luts(record)))


def _read(path: Path, parse: Callable[[Any], _T]) -> _T:
    path = Path(path)
    try:
        record = strict_json.load(_content(path))
        _require_schema(record, path)
        return parse(record)
    except OSError as error:
        raise LutError(f"{path}: cannot be read: {reason_of(error)}") from error
    except LutError:
        raise
    except (FaceCRFError, *_DAMAGE) as error:
        # A LUT beside its record, mostly, or a picture, all of which the error would quote.
        if path.suffix.lower() != ".json" or isinstance(error, UnicodeDecodeError):
            raise LutError(f"{path}: is no record of facecrf; name a .crf.json") from error
        raise LutError(
            f"{path}: is no record of facecrf, or was changed "
            f"({type(error).__name__}: {plain_text(error, limit=200)}); "
            "calibrate the photo again"
        ) from error


def _content(path: Path) -> bytes:
    with path.open("rb") as file:
        content = file.read(_LARGEST + 1)
    if len(content) > _LARGEST:
        raise ValueError(f"it has more than {_LARGEST >> 20} MB")
    return content


def _compare(written: Path, path: Path, estimate: Estimate) -> None:
    curve, found = read_record(written).estimate.found, estimate.found
    same = (curve is None) == (found is None)
    if curve is not None and found is not None:
        same = np.array_equal(curve.encoded, found.encoded) and np.array_equal(
            curve.linear, found.linear
        )
    if not same:
        raise LutError(f"{path}: does not read back as written; please report this")


# JSON is untyped: what is missing or of the wrong kind raises, and read_record says so.
def _require_schema(record: Any, path: Path) -> None:
    if record["schema"] != SCHEMA:
        raise ValueError(f"its schema is {record['schema']!r}")
    if record["schema_version"] > SCHEMA_VERSION:
        raise LutError(f"{path}: was written by a newer facecrf; update facecrf-ocio to read it")


def _record_in(record: Any) -> Record:
    return Record(
        source=source_in(record["source"]),
        estimate=read_estimate(record),
        settings=dict(record["settings"]),
        versions=dict(record["versions"]),
        luts=_read_luts(record),
    )


def _read_luts(record: Any) -> tuple[str, ...]:
    """Names of files beside the record; others lead elsewhere."""
    names = tuple(record["luts"])
    for name in names:
        if name != PurePath(name).name or "\0" in name:
            raise ValueError(f"{name!r:.80} is no name of a file beside it")
    return names
