"""All files of one calibrated photo: its LUTs and its record, all of them or none."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from facecrf_ocio import __version__
from facecrf_ocio.errors import LutError, OutputError, reason_of
from facecrf_ocio.files.atomic import Draft, require_free, write_files
from facecrf_ocio.lut.format_table import default_formats
from facecrf_ocio.lut.transform import LutTransform
from facecrf_ocio.lut.write import lut_draft, split_ending
from facecrf_ocio.record.calibration_record import read_source, record_draft
from facecrf_ocio.record.output_names import RECORD, output_path
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Estimate, Photo
from facecrf_ocio.wording.trust_words import trust_phrase


def write_outputs(
    photo: Photo,
    estimate: Estimate,
    settings: Settings,
    folder: Path,
    formats: Iterable[str] | None = None,
    *,
    overwrite: bool = False,
    also: Sequence[Draft] = (),
    name: str | None = None,
) -> tuple[Path, ...]:
    """Write the LUTs and the record of a photo, named after it; without a curve, the record.

    `output_names` says how.
    Formats are those that `format_table` calls the default unless they are named.
    The folder is made if it is missing. The drafts in `also` are written with them or not at all.
    With `name` the files are named after it instead of after the photo.

    Returns
    -------
    tuple of pathlib.Path
        The LUTs in the order of `formats`, then the record, then `also`.

    Raises
    ------
    OutputError
        If a file exists and `overwrite` is false, if the record there is another photo's, or if a
        file cannot be written. Nothing is written then.
    LutError
        If a format is unknown, or a LUT does not read back as written.
    """
    folder = Path(folder)
    if photo.path is None:
        raise OutputError("a photo in memory has no name to name its files after; set Photo.path")
    named = default_formats() if formats is None else tuple(formats)
    formats = () if estimate.found is None else named
    *luts, record = require_outputs_free(
        photo.path, folder, formats, overwrite=overwrite, name=name
    )
    drafts = [
        _lut_draft(ending, lut, photo, estimate)
        for ending, lut in zip(dict.fromkeys(formats), luts, strict=True)
    ]
    drafts.append(record_draft(record, photo, estimate, settings, luts))
    _make_folder(folder)
    return write_files([*drafts, *also], overwrite=overwrite)


def output_paths(
    source: Path, folder: Path, formats: Iterable[str], name: str | None = None
) -> tuple[Path, ...]:
    """Return where `write_outputs` puts a photo's LUTs and, last, its record.

    Raises
    ------
    LutError
        If a format is unknown.
    """
    unique = dict.fromkeys(formats)
    for ending in unique:
        split_ending(ending)
    return tuple(output_path(folder, name or source, ending) for ending in (*unique, RECORD))


def require_outputs_free(
    source: Path,
    folder: Path,
    formats: Iterable[str],
    *,
    overwrite: bool,
    name: str | None = None,
) -> tuple[Path, ...]:
    """Return `output_paths`, or raise what `write_outputs` would, before a photo is calibrated.

    Raises
    ------
    OutputError
        If a file exists and `overwrite` is false, or the record there is another photo's.
    LutError
        If a format is unknown.
    """
    targets = output_paths(source, folder, formats, name)
    _require_same_source(targets[-1], source)
    for target in targets:
        require_free(target, overwrite=overwrite)
    return targets


def require_distinct_names(sources: Sequence[Path]) -> None:
    """Raise OutputError if two photos of one run would write the same files."""
    first: dict[str, Path] = {}
    for source in sources:
        other = first.setdefault(source.name, source)
        if other is not source:
            raise OutputError(
                f"{source}: would write the same files as {other}; calibrate them into two folders "
                "or rename one"
            )


def _require_same_source(record: Path, source: Path) -> None:
    try:
        owner = read_source(record)[0].name
    except LutError:  # none there, or unreadable: then overwriting is for the user to decide
        return
    if owner is not None and owner != source.name:
        raise OutputError(
            f"{record}: belongs to {owner}, not to {source.name}; write to another folder or "
            "rename one of the photos"
        )


def _lut_draft(ending: str, path: Path, photo: Photo, estimate: Estimate) -> Draft:
    space, direction, name = split_ending(ending)
    transform = LutTransform(estimate.curve, direction, space, photo.primaries)
    return lut_draft(transform, path, _provenance(photo, estimate), name)


def _provenance(photo: Photo, estimate: Estimate) -> Mapping[str, str]:
    lines = {
        "Made by": f"facecrf_ocio {__version__}",
        "Source": "" if photo.path is None else photo.path.name,
        "Source SHA-256": photo.sha256 or "",
        "Outcome": f"{estimate.outcome} ({estimate.estimator})",
        "Confidence": "" if estimate.confidence is None else trust_phrase(estimate.confidence),
        "Primaries": "" if photo.primaries is None else photo.primaries.name,
        "Exposure": "relative, known up to one factor",
    }
    return {key: value for key, value in lines.items() if value}


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        problem = reason_of(error)
        raise OutputError(
            f"{folder}: the folder cannot be made: {problem}; choose another folder"
        ) from error
