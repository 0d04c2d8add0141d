"""An estimate as JSON and back: curve, confidence, faces, and what the estimator says."""

from __future__ import annotations

from typing import Any

import numpy as np

from facecrf_ocio.record.sampled import codes_record, one_for_all, read_codes, read_rows, thinned
from facecrf_ocio.values import (
    Confidence,
    Estimate,
    Face,
    InStops,
    InverseCRF,
    Outcome,
    Verdict,
    frozen,
)


def estimate_record(estimate: Estimate) -> dict[str, object]:
    """All of an estimate but its faces' landmarks; `read_estimate` reads it."""
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


def read_estimate(record: Any) -> Estimate:
    """What `estimate_record` wrote; JSON is untyped, so what is wrong in it raises anything."""
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


def _read_curve(record: dict[str, Any] | None) -> InverseCRF | None:
    if record is None:
        return None
    return InverseCRF(read_codes(record["encoded"]), read_rows(record["linear"]))


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
        "doubts": confidence.doubts,
        "reasons": confidence.reasons,
        "sigma_stops": None if told is None else thinned(told.sigma),
        "sigma": thinned(confidence.sigma),
        "coverage": thinned(confidence.coverage),
    }


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
        doubts=tuple(record.get("doubts", ())),
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
