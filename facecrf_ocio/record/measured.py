"""From the record of a measurement to an entry of the registry of cameras."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from facecrf_ocio.cameras.known_cameras import POINTS, KnownCamera
from facecrf_ocio.errors import LutError
from facecrf_ocio.record.calibration_record import Record
from facecrf_ocio.values import Camera, Confidence, Estimate, Float, InverseCRF, Verdict

MEASURED = ("pair", "bracket", "chart")
"""Estimators that measure; what others found in a photo is no measurement of a camera."""


def from_record(path: Path, record: Record) -> KnownCamera:
    """The measurement that a record holds.

    Raises
    ------
    LutError
        If it was not measured, has no curve, or does not name its camera.
    """
    estimate = record.estimate
    if estimate.estimator not in MEASURED or estimate.found is None:
        raise LutError(
            f"{path}: holds an estimate by {estimate.estimator!r}, and no measurement; add records "
            "of facecrf pair, bracket or chart"
        )
    camera = record.source.camera
    if not camera.model:
        raise LutError(f"{path}: does not name its camera; use photos with EXIF")
    proof = f"{record.source.name} sha256 {record.source.sha256}: {estimate.reason}"
    # Exposures that a camera bent unlike each other leave a residual; a single one does not.
    bent = () if estimate.estimator == "bracket" else record.source.adapted
    return entry(camera, estimate, proof, style=", ".join(bent))


def entry(camera: Camera, estimate: Estimate, proof: str, *, style: str = "") -> KnownCamera:
    """A measurement as the registry holds it; its style is what bent the curve, if anything did."""
    at, curve, told = np.linspace(0.0, 1.0, POINTS), estimate.curve, estimate.confidence
    rows = rounded([np.interp(at, curve.encoded, row) for row in curve.linear])
    grade = "B" if told is not None and told.verdict is Verdict.RELIABLE else "C"
    spread = 0.1 if told is None else spread_stops(curve, told)
    return KnownCamera(
        camera.make, camera.model, style, estimate.estimator, grade, spread, proof, rows
    )


def rounded(rows: Iterable[Float]) -> tuple[tuple[float, ...], ...]:
    """Rows (K,) of linear light as a registry tells it: six digits."""
    return tuple(tuple(float(f"{value:.6g}") for value in row) for row in rows)


def spread_stops(curve: InverseCRF, told: Confidence) -> float:
    """[stop] of green, over codes 32 to 235."""
    inside = spread_codes(curve.encoded)
    relative: Float = told.sigma[1, inside] / np.maximum(curve.linear[1, inside], 1e-6)
    return float(f"{np.sqrt((relative**2).mean()) / np.log(2.0):.3g}")


def spread_codes(encoded: Float) -> npt.NDArray[np.bool_]:
    """(K,) which encoded values (K,) a registry tells a spread of: codes 32 to 235."""
    return np.asarray((encoded >= 32 / 255) & (encoded <= 235 / 255))
