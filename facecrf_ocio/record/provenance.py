"""Where linear light comes from, as short texts that any file can carry."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import numpy as np

from facecrf_ocio import __version__
from facecrf_ocio.errors import LutError, reason_of
from facecrf_ocio.lut.table import lut_table
from facecrf_ocio.record.calibration_record import Record, read_record
from facecrf_ocio.record.output_names import RECORD, output_path
from facecrf_ocio.values import Confidence, Estimate, InverseCRF, Photo
from facecrf_ocio.wording.sentence import sentence

EXPOSURE = "relative, known up to one factor"


def curve_sha256(curve: InverseCRF) -> str:
    """SHA-256 of the (4096, 3) little-endian float32 entries that every LUT of a curve holds."""
    return hashlib.sha256(lut_table(curve).astype("<f4").tobytes()).hexdigest()


def expected_error(confidence: Confidence | None) -> str:
    """How far a curve is expected to be off; empty if that is not known."""
    if confidence is None:
        return ""
    if confidence.in_stops is not None:
        stops = confidence.in_stops
        return f"{stops.mid:.2f} stops in the mid-tones, {stops.shadows:.2f} in the shadows"
    return f"{100.0 * float(np.sqrt(np.mean(confidence.sigma**2))):.1f} % of white"


def of_estimate(photo: Photo, estimate: Estimate) -> dict[str, str]:
    """What an image says that an estimate's curve made linear; empty texts left out."""
    confidence = estimate.confidence
    texts = {
        "outcome": str(estimate.outcome),
        "estimator": estimate.estimator,
        "confidence": "" if confidence is None else str(confidence.verdict),
        "summary": "" if confidence is None else sentence(estimate),
        "expected_error": expected_error(confidence),
        "curve_sha256": "" if estimate.found is None else curve_sha256(estimate.found),
        **_of_photo(photo),
    }
    return {name: text for name, text in texts.items() if text}


def of_lut(photo: Photo, lut: Path, direction: str) -> dict[str, str]:
    """What an image says that went through a LUT file; with the record beside it, if it has one.

    Raises
    ------
    LutError
        If the LUT cannot be read.
    """
    try:
        digest = hashlib.sha256(lut.read_bytes()).hexdigest()
    except OSError as error:
        raise LutError(f"{lut}: cannot be read: {reason_of(error)}; check the file") from error
    texts = {"lut": lut.name, "lut_sha256": digest, "direction": direction}
    record = record_of(lut)
    if record is not None:
        estimate = record.estimate
        confidence = estimate.confidence
        texts |= {
            "outcome": str(estimate.outcome),
            "estimator": estimate.estimator,
            "confidence": "" if confidence is None else str(confidence.verdict),
            "expected_error": expected_error(confidence),
            "calibrated_from": record.source.name or "",
            "calibrated_from_sha256": record.source.sha256 or "",
        }
    texts |= _of_photo(photo)
    return {name: text for name, text in texts.items() if text}


def record_of(lut: Path) -> Record | None:
    """The record beside a LUT that lists it; None if there is none that can be read."""
    parts = lut.name.split(".")
    for count in range(len(parts) - 1, 0, -1):
        path = output_path(lut.parent, ".".join(parts[:count]), RECORD)
        if os.path.isfile(path):  # noqa: PTH113 - False, too, for a name that no disk takes
            try:
                record = read_record(path)
            except LutError:
                continue
            if lut.name in record.luts:
                return record
    return None


def _of_photo(photo: Photo) -> dict[str, str]:
    return {
        "source": "" if photo.path is None else photo.path.name,
        "source_sha256": photo.sha256 or "",
        "exposure_assumption": EXPOSURE,
        "version": __version__,
    }
