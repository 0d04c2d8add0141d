"""The record of a calibration that stands beside its LUTs, NAME.crf.json."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path, PurePath
from typing import Any, TypeVar

import numpy as np

from facecrf_ocio.errors import FaceCRFError, LutError, reason_of
from facecrf_ocio.files import strict_json
from facecrf_ocio.files.atomic import Draft, write_files
from facecrf_ocio.files.versions import versions
from facecrf_ocio.record.sampled import codes_record, one_for_all, read_codes, read_rows, thinned
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import (
    Camera,
    Confidence,
    Estimate,
    Face,
    InStops,
    InverseCRF,
    Outcome,
    Photo,
    Primaries,
    Verdict,
    frozen,
)
from facecrf_ocio.wording.expectation import expectation
from facecrf_ocio.wording.sentence import sentence

SCHEMA = "facecrf sidecar"
SCHEMA_VERSION = 2
"""1 wrote all numbers of a curve for each channel; it is read, too."""

SUFFIX = ".crf.json"
_LARGEST = 32 << 20  # [byte] the largest ever written, of version 1, has half a megabyte
# What numbers, texts and nothing in the place of something else make of us.
_DAMAGE = (
    *(ArithmeticError, AttributeError, LookupError, MemoryError),
    *(RecursionError, TypeError, ValueError),
)
_T = TypeVar("_T")


@dataclass(frozen=True, slots=True)
class Source:
    """The photo a calibration was made from; `name` and `sha256` are None for one in memory.

    `gain_map` names the standard of the map that the file has, if any.
    """

    name: str | None
    sha256: str | None
    width: int
    height: int
    bit_depth: int | None
    scene_linear: bool
    grayscale: bool
    camera: Camera
    primaries: Primaries | None
    notes: tuple[str, ...] = ()
    named_curve: str = ""
    edits: tuple[str, ...] = ()
    gain_map: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Sidecar:
    """What a sidecar holds.

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


def write_sidecar(
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
    return write_files([sidecar_draft(path, photo, estimate, settings, luts)], overwrite=overwrite)[
        0
    ]


def sidecar_draft(
    path: Path, photo: Photo, estimate: Estimate, settings: Settings, luts: Sequence[Path]
) -> Draft:
    """Return the sidecar to be written, which is read back before it appears."""
    expected = expectation(_as_read(estimate))
    record = {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        **_estimate_record(estimate),
        "summary": sentence(estimate),
        "expected": None if expected is None else expected.record(),
        "source": asdict(_source(photo)),
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


def read_sidecar(path: Path) -> Sidecar:
    """Read the record of a calibration.

    Raises
    ------
    LutError
        If the file cannot be read, is no sidecar, or comes from a newer version.
    """
    return _read(path, _sidecar)


def read_curve(path: str | Path) -> InverseCRF:
    """Read the curve of a record, NAME.crf.json, to the last digit.

    Raises
    ------
    LutError
        As `read_sidecar` does, or if the photo could not be calibrated.
    """
    path = Path(path)
    curve = read_sidecar(path).estimate.found
    if curve is None:
        raise LutError(f"{path}: holds no curve, since its photo could not be calibrated")
    return curve


def read_source(path: Path) -> tuple[Source, tuple[str, ...]]:
    """Read only what photo a record is of, and which LUTs were written with it.

    Raises
    ------
    LutError
        As `read_sidecar` does.
    """
    return _read(path, lambda record: (_read_source(record["source"]), _read_luts(record)))


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
        raise LutError(
            f"{path}: is not a sidecar of facecrf, or was changed "
            f"({type(error).__name__}: {' '.join(str(error).split())[:200]}); "
            "calibrate the photo again"
        ) from error


def _content(path: Path) -> bytes:
    with path.open("rb") as file:
        content = file.read(_LARGEST + 1)
    if len(content) > _LARGEST:
        raise ValueError(f"it has more than {_LARGEST >> 20} MB")
    return content


def _source(photo: Photo) -> Source:
    height, width = photo.encoded.shape[:2]
    return Source(
        name=None if photo.path is None else photo.path.name,
        sha256=photo.sha256,
        width=width,
        height=height,
        bit_depth=photo.bit_depth,
        scene_linear=photo.scene_linear,
        grayscale=photo.grayscale,
        camera=photo.camera,
        primaries=photo.primaries,
        notes=photo.notes,
        named_curve=photo.named_curve,
        edits=photo.edits,
        gain_map=None if photo.gain_map is None else photo.gain_map.standard,
    )


def _estimate_record(estimate: Estimate) -> dict[str, object]:
    """All of an estimate but its faces' landmarks; `_read_estimate` reads it."""
    faces = [{"box_xy": face.box_xy, "score": face.score} for face in estimate.faces]
    return {
        "outcome": estimate.outcome.value,
        "estimator": estimate.estimator,
        "reason": estimate.reason,
        "remedy": estimate.remedy,
        "assumptions": estimate.assumptions,
        "energy": estimate.energy,
        "coefficients": estimate.coefficients,
        "faces": faces,
        "confidence": _confidence_record(estimate.confidence),
        "curve": _curve_record(estimate.found),
    }


def _read_estimate(record: Any) -> Estimate:
    coefficients = record["coefficients"]
    curve, confidence = _read_curve(record["curve"]), _read_confidence(record["confidence"])
    if curve is not None and confidence is not None:
        shapes = {curve.linear.shape, confidence.sigma.shape, confidence.coverage.shape}
        if len(shapes) > 1:
            raise ValueError(f"its curve and its confidence have shapes {sorted(shapes)}")
    return Estimate(
        Outcome(record["outcome"]),
        estimator=str(record["estimator"]),
        reason=str(record["reason"]),
        remedy=str(record["remedy"]),
        found=curve,
        confidence=confidence,
        coefficients=None if coefficients is None else frozen(coefficients),
        energy={name: _number(value) for name, value in record["energy"].items()},
        faces=tuple(
            Face(np.array(face["box_xy"], np.float64), np.empty((0, 3)), float(face["score"]))
            for face in record["faces"]
        ),
        assumptions=tuple(record["assumptions"]),
    )


def _curve_record(curve: InverseCRF | None) -> dict[str, object] | None:
    if curve is None:
        return None
    return {"encoded": codes_record(curve.encoded), "linear": one_for_all(curve.linear)}


def _confidence_record(confidence: Confidence | None) -> dict[str, object] | None:
    if confidence is None:
        return None
    told = confidence.in_stops
    return {
        "verdict": confidence.verdict.value,
        "expected_stops": None if told is None else {"64-235": told.mid, "16-64": told.shadows},
        "differs_from_srgb": confidence.differs_from_srgb,
        "nearer_than_srgb": confidence.nearer_than_srgb,
        "outvoted": confidence.outvoted,
        "reasons": confidence.reasons,
        "sigma_stops": None if told is None else thinned(told.sigma),
        "sigma": thinned(confidence.sigma),
        "coverage": thinned(confidence.coverage),
    }


def _compare(written: Path, path: Path, estimate: Estimate) -> None:
    curve, found = read_sidecar(written).estimate.found, estimate.found
    same = (curve is None) == (found is None)
    if curve is not None and found is not None:
        same = np.array_equal(curve.encoded, found.encoded) and np.array_equal(
            curve.linear, found.linear
        )
    if not same:
        raise LutError(f"{path}: does not read back as written; please report this")


# JSON is untyped: what is missing or of the wrong kind raises, and read_sidecar says so.
def _require_schema(record: Any, path: Path) -> None:
    if record["schema"] != SCHEMA:
        raise ValueError(f"its schema is {record['schema']!r}")
    if record["schema_version"] > SCHEMA_VERSION:
        raise LutError(f"{path}: was written by a newer facecrf; update facecrf-ocio to read it")


def _sidecar(record: Any) -> Sidecar:
    return Sidecar(
        source=_read_source(record["source"]),
        estimate=_read_estimate(record),
        settings=dict(record["settings"]),
        versions=dict(record["versions"]),
        luts=_read_luts(record),
    )


def _read_curve(record: dict[str, Any] | None) -> InverseCRF | None:
    if record is None:
        return None
    return InverseCRF(read_codes(record["encoded"]), read_rows(record["linear"]))


def _read_source(record: dict[str, Any]) -> Source:
    primaries = record["primaries"]
    if primaries is not None:
        pairs = {name: _pair(primaries[name]) for name in ("red", "green", "blue", "white")}
        primaries = Primaries(**{**primaries, **pairs})
    # Records told neither before.
    texts = {name: tuple(map(str, record.get(name, ()))) for name in ("notes", "edits")}
    camera = Camera(**record["camera"])
    return Source(**{**record, "camera": camera, "primaries": primaries, **texts})


def _pair(numbers: Any) -> tuple[float, float]:
    x, y = map(float, numbers)
    if not np.isfinite([x, y]).all():
        raise ValueError("its primaries are not finite")
    return x, y


def _read_luts(record: Any) -> tuple[str, ...]:
    """Names of files beside the record; others lead elsewhere."""
    names = tuple(record["luts"])
    for name in names:
        if name != PurePath(name).name or "\0" in name:
            raise ValueError(f"{name!r:.80} is no name of a file beside it")
    return names


def _read_confidence(record: dict[str, Any] | None) -> Confidence | None:
    if record is None:
        return None
    return Confidence(
        sigma=frozen(read_rows(record["sigma"])),
        coverage=frozen(read_rows(record["coverage"])),
        verdict=Verdict(record["verdict"]),
        reasons=tuple(record["reasons"]),
        in_stops=_read_in_stops(record),
        nearer_than_srgb=record.get("nearer_than_srgb"),
        outvoted=tuple(record.get("outvoted", ())),
    )


def _read_in_stops(record: dict[str, Any]) -> InStops | None:
    """None in records that were written before stops were told."""
    expected = record.get("expected_stops")
    if expected is None:
        return None
    sigma = frozen(read_rows(record["sigma_stops"]))
    return InStops(sigma, float(expected["64-235"]), float(expected["16-64"]))


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)
