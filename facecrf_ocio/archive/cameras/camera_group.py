"""One camera, one curve: what its photos say together, and which of them it fits."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from facecrf_ocio.archive.cameras.bracket import BracketPhoto, stops_of
from facecrf_ocio.archive.manifest.camera_rows import different_photos, exposed_photos
from facecrf_ocio.archive.manifest.database import Manifest
from facecrf_ocio.archive.manifest.keys import key_of
from facecrf_ocio.archive.task import Recipe
from facecrf_ocio.joint import PhotoEvidence, conclude
from facecrf_ocio.pair.bracket_curve import (
    BracketCurve,
    bracket_reasons,
    rmse_after_scale,
    solve_bracket,
)
from facecrf_ocio.pair.calibrate_bracket import bracket_doubts, bracket_verdict
from facecrf_ocio.pair.code_samples import read_samples
from facecrf_ocio.values import Confidence, Estimate, Float, InverseCRF, Outcome, Verdict

MOST = 100
"""Photos that a curve is concluded from at most. Errors of one camera's photos are correlated by
0.3, so that any number of photos tells as much as 3.3 independent ones, and 100 as much as 3.2."""

_CURVE_POINTS = 256  # one for each code of 8 bits


@dataclass(frozen=True, slots=True, eq=False)
class CameraCurve:
    """What a camera's photos say together.

    Attributes
    ----------
    estimate
        The curve; None if none of them says anything.
    used
        Photos it was concluded from.
    sha256
        Hash of all that is written of it.
    """

    estimate: Estimate | None
    used: int
    sha256: str


def conclude_camera(
    manifest: Manifest, key: str, recipe_sha256: str, recipe: Recipe
) -> CameraCurve:
    """One curve from the evidence of a camera's photos, each content counted once."""
    chosen = []
    for name in different_photos(manifest, key, recipe_sha256):
        evidence = evidence_of(manifest, name)
        if evidence.messages:
            chosen.append((name, evidence))
        if len(chosen) == MOST:
            break
    if not chosen:
        return CameraCurve(None, 0, "")
    chosen.sort(key=lambda item: item[0])
    names = [key_of(name) for name, _ in chosen]
    shared = recipe.settings.shared_curve
    evidences = [evidence for _, evidence in chosen]
    estimate = conclude(evidences, recipe.prior, names=names, shared=shared)
    estimate = replace(estimate, faces=())
    return CameraCurve(estimate, len(chosen), estimate_sha256(estimate))


def evidence_of(manifest: Manifest, name: str) -> PhotoEvidence:
    """What a photo said, without its face."""
    return PhotoEvidence.from_json(manifest.gathered(name).evidence)


def exposures(
    manifest: Manifest, camera: str, recipe_sha256: str, bracket: str | None = None
) -> Iterator[BracketPhoto]:
    """A camera's photos, or a bracket's, that tell time and exposure; each content once."""
    for name, sha256, shot in exposed_photos(manifest, camera, recipe_sha256, bracket):
        yield BracketPhoto(name, sha256, shot, manifest.gathered(name).samples)


def solve(members: tuple[BracketPhoto, ...]) -> BracketCurve:
    """The curve that a bracket gives."""
    return solve_bracket([read_samples(one.samples) for one in members], stops_of(members))


def bracket_estimate(
    members: tuple[BracketPhoto, ...], solved: BracketCurve, camera: Estimate | None
) -> Estimate | None:
    """What the photos of a bracket get, None if they get their camera's curve."""
    if solved.problem or solved.found is None:
        return None
    shown = np.array(
        [np.interp(_levels(), np.linspace(0.0, 1.0, 256), row) for row in _hits(members)]
    )
    reasons = list(bracket_reasons(solved))
    if camera is not None:
        error = rmse_after_scale(solved.found, camera.curve)
        reasons.append(
            f"RMSE against the curve estimated for its camera, after one scale: {error:.3f}"
        )
    return Estimate(
        Outcome.CALIBRATED,
        "bracket",
        f"a bracket of {len(members)} exposures over {solved.stops:.1f} stops",
        found=solved.found,
        confidence=Confidence(
            solved.sigma,
            shown,
            bracket_verdict(solved),
            tuple(reasons),
            solved.in_stops,
            doubts=bracket_doubts(solved, [one.name for one in members]),
        ),
    )


def member_estimate(estimate: Estimate, evidence: PhotoEvidence) -> Estimate:
    """Its camera's curve for a photo that fits it, or that says nothing itself."""
    rest = f"the curve of its camera ({estimate.reason})"
    faces = () if evidence.face is None else (evidence.face,)
    if evidence.messages:
        return replace(estimate, reason=rest, faces=faces)
    told = estimate.confidence
    if told is None:
        raise ValueError("a camera's curve has a confidence")
    verdict = Verdict.WEAK if told.verdict is Verdict.RELIABLE else told.verdict
    reasons = ("nothing in this photo confirms that its curve is its camera's", *told.reasons)
    return replace(
        estimate,
        outcome=Outcome.FROM_CAMERA,
        reason=f"{evidence.lacking}: {rest}",
        faces=faces,
        confidence=replace(
            told, coverage=np.zeros_like(told.coverage), verdict=verdict, reasons=reasons
        ),
    )


def estimate_sha256(estimate: Estimate) -> str:
    """Hash of all that is written of an estimate."""
    digest = hashlib.sha256(estimate.reason.encode())
    told = estimate.confidence
    if told is not None:
        said = [told.verdict.value, told.reasons, told.outvoted, told.nearer_than_srgb]
        said += [told.doubts] if told.doubts else []
        digest.update(json.dumps(said).encode())
    for array in (estimate.curve.linear, *_arrays(told)):
        digest.update(np.ascontiguousarray(array, dtype=np.float64).tobytes())
    return digest.hexdigest()


def _arrays(told: Confidence | None) -> tuple[Float, ...]:
    if told is None:
        return ()
    in_stops = told.in_stops
    return (told.sigma, told.coverage, *(() if in_stops is None else (in_stops.sigma,)))


def curve_json(curve: InverseCRF | None, sigma: Float) -> str:
    """A curve with its band, at 256 code values, for a reader of the manifest."""
    if curve is None:
        return ""
    at = np.linspace(0.0, 1.0, _CURVE_POINTS)

    def rows(arrays: Float) -> list[list[float]]:
        return [
            [float(f"{value:.6g}") for value in np.interp(at, curve.encoded, row)] for row in arrays
        ]

    encoded = [float(f"{value:.6g}") for value in at]
    return json.dumps({"encoded": encoded, "linear": rows(curve.linear), "sigma": rows(sigma)})


@lru_cache(maxsize=1)
def _levels() -> Float:
    return np.linspace(0.0, 1.0, 4096)


def _hits(members: tuple[BracketPhoto, ...]) -> Float:
    """(3, 256) share of the points at each code value, relative to where they are densest."""
    codes = np.concatenate([read_samples(one.samples) for one in members])
    counts = np.stack([np.bincount(codes[:, c], minlength=256) for c in range(3)]).astype(
        np.float64
    )
    counts[:, [0, 255]] = 0.0
    smooth = np.stack([np.convolve(row, np.ones(17), mode="same") for row in counts])
    return np.asarray(smooth / np.maximum(smooth.max(axis=1, keepdims=True), 1e-12))
