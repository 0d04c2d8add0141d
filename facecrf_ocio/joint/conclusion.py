"""From evidence to a curve with a calibrated band: one photo, or several of one camera."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from facecrf_ocio.cameras.known_cameras import KnownCamera
from facecrf_ocio.checks import typed
from facecrf_ocio.files.plain_text import counted
from facecrf_ocio.joint.evidence import PhotoEvidence
from facecrf_ocio.joint.face_exposure import doubts_of_exposure, stretch_of_exposure
from facecrf_ocio.joint.fused_photos import PHOTO_CORRELATION, Fused, called, fuse_photos
from facecrf_ocio.joint.joint_model import JointModel, shipped_joint
from facecrf_ocio.joint.known_response import (
    KnownResponse,
    cameras_named,
    in_channels,
    known_responses,
)
from facecrf_ocio.joint.messages import COMBINED
from facecrf_ocio.joint.metadata import UNTOLD
from facecrf_ocio.joint.prior import Posterior
from facecrf_ocio.joint.verdict import deviations, doubted, judge
from facecrf_ocio.response.coverage import coverage_at
from facecrf_ocio.response.expected_stops import verdict_of
from facecrf_ocio.response.model import inverse_crf, strictly_increasing
from facecrf_ocio.values import (
    CHANNELS,
    Confidence,
    Estimate,
    Float,
    InverseCRF,
    Outcome,
    Verdict,
)
from facecrf_ocio.wording.doubts import bent_by, contradicted, not_single, of_several_cameras

_CAMERAS_TOLD = 3  # of those that photos of one curve name by mistake: the mistake is seen


@typed
def conclude(
    evidence: Sequence[PhotoEvidence],
    prior: str = "auto",
    model: JointModel | None = None,
    *,
    names: Sequence[str] | None = None,
    cameras: Sequence[KnownCamera] | None = None,
    correlation: float = PHOTO_CORRELATION,
    besides: Callable[[Posterior], Posterior] | None = None,
    shared: bool = False,
) -> Estimate:
    """One curve from the evidence of one photo, or of several that one camera took.

    Parameters
    ----------
    evidence
        Of each photo, as `gather` gives it; photos that say nothing are passed over.
    prior
        `auto`, `dorf` or `modern`.
    model
        The shipped one by default.
    names
        What the reasons call each photo, no two alike; its place among them by default.
    cameras
        Measured responses, in which the cameras that the files name are looked up; those that ship
        and the user's own by default.
    correlation
        Of the errors of any two of the photos.
    besides
        Adds what is known besides the photos' own evidence.
    shared
        Whether channels stay alike where the user measured the camera's apart.

    Returns
    -------
    Estimate
        Without any evidence, the prior's mean with the prior's band, as a fallback.
    """
    model = model or shipped_joint()
    names = names or [f"photo {number}" for number, _ in enumerate(evidence, 1)]
    if len(set(names)) != len(evidence):
        raise ValueError("photos to conclude from are as many as their names, no two alike")
    named = {name: e for name, e in zip(names, evidence, strict=True) if e.messages}
    telling = list(named.values())
    leanings = [(e.leaning, e.phone) for e in telling or evidence] or [(UNTOLD, 0.0)]
    weights = model.prior.weights_for(prior, *np.mean(leanings, axis=0).tolist())
    bent = {one.camera for one in telling if one.adapted}
    known = known_responses((one.camera for one in telling), model.prior, cameras, bent)
    stretches = {n: e.stretch * stretch_of_exposure(e.coverage) for n, e in named.items()}
    fused = fuse_photos(named, stretches, model.prior, weights, known, correlation)
    dissent = fused.outvoted
    posterior = besides(fused.posterior) if besides and telling else fused.posterior
    alike = strictly_increasing([model.prior.samples(posterior.mean)] * len(CHANNELS))
    found = inverse_crf(model.prior.grid, alike)
    stops_scale = fused.families @ model.stops_scale
    confidence = _confidence(telling, posterior, found, model, stops_scale, dissent)
    confidence = doubted(_with_cameras(confidence, telling, known, dissent), _doubts_of(named))
    if telling and not known:
        confidence = doubted(confidence, doubts_of_exposure([e.coverage for e in telling]))
    if not shared:
        agreed = {one: what for one, what in known.items() if what.source not in dissent}
        found = in_channels(found, agreed, (one.camera for one in telling), model.prior)
    coefficients = np.tile(posterior.mean, (len(CHANNELS), 1))
    if not telling:
        first = next(iter(evidence), PhotoEvidence({}, np.empty(0), lacking="no photo given"))
        return Estimate(
            Outcome.FALLBACK,
            "joint",
            f"{first.lacking}: the mean of the prior",
            first.remedy,
            found=found,
            confidence=confidence,
            coefficients=coefficients,
        )
    faces = tuple(e.face for e in telling if e.face is not None)
    cues = sorted({called(c) for e in telling for c in e.messages if c != COMBINED})
    return Estimate(
        Outcome.CALIBRATED,
        "joint",
        f"{counted(len(telling), 'photo')}, {counted(len(cues), 'cue')}: {', '.join(cues)}",
        found=found,
        confidence=confidence,
        coefficients=coefficients,
        faces=faces,
    )


def _doubts_of(named: Mapping[str, PhotoEvidence]) -> tuple[str, ...]:
    """What speaks against any single curve; of several photos, with their names."""
    said = {name: one.doubt for name, one in named.items() if one.doubt}
    alone = len(named) == 1
    found = (doubt if alone else f"{name}: {doubt}" for name, doubt in said.items())
    return (*not_single(found), *bent_by(what for one in named.values() for what in one.adapted))


def _with_cameras(
    confidence: Confidence,
    telling: Sequence[PhotoEvidence],
    known: Mapping[tuple[str, str], KnownResponse],
    dissent: Sequence[str],
) -> Confidence:
    """Say what was known of the cameras; `weak` where a photo contradicts that, or they differ."""
    named = {one.source: one.bent for one in known.values()}
    counts = {False: "counts as evidence", True: "counts as another model's would"}
    agreeing = (f"{one} {counts[bent]}" for one, bent in named.items() if one not in dissent)
    doubts = [contradicted(len(telling), one) for one in named if one in dissent]
    taken_with = cameras_named(one.camera for one in telling)
    if len(taken_with) > 1:
        told_of = [*taken_with[:_CAMERAS_TOLD], *(["..."] if taken_with[_CAMERAS_TOLD:] else [])]
        doubts.append(of_several_cameras(len(taken_with), ", ".join(told_of)))
    told = replace(confidence, reasons=(*confidence.reasons, *agreeing))
    return doubted(told, tuple(doubts))


@typed
def misfit(evidence: PhotoEvidence, estimate: Estimate, model: JointModel | None = None) -> float:
    """How far a photo's own evidence lies from a curve, in standard deviations per coefficient.

    About 1 for a member of the group; 0 where the photo says nothing.
    """
    model = model or shipped_joint()
    if not evidence.messages or estimate.coefficients is None:
        return 0.0
    own = _alone(evidence, model).posterior
    offset = own.mean - estimate.coefficients[0]
    distance = float(offset @ np.linalg.solve(own.covariance, offset))
    return float(np.sqrt(distance / offset.size))


def families_of(evidence: PhotoEvidence, model: JointModel) -> Float:
    """(F,) share of each of the prior's families in what one photo leaves of it."""
    return _alone(evidence, model).families


def _alone(evidence: PhotoEvidence, model: JointModel) -> Fused:
    """What one photo leaves of the prior, nothing being known of its camera."""
    weights = model.prior.weights_for("auto", evidence.leaning, evidence.phone)
    # Edits darken faces too, and must not hide behind that: the stretch is what cues say.
    return fuse_photos({"photo": evidence}, {"photo": evidence.stretch}, model.prior, weights, {})


def _confidence(
    telling: Sequence[PhotoEvidence],
    posterior: Posterior,
    found: InverseCRF,
    model: JointModel,
    stops_scale: Float,
    outvoted: tuple[str, ...],
) -> Confidence:
    prior = model.prior
    alike = deviations(posterior, prior, model.band_scale)
    sigma = np.tile(np.interp(found.encoded, prior.grid, alike), (len(CHANNELS), 1))
    if not telling:
        nothing = "nothing in the photo was used: this is the prior's mean and spread"
        in_stops, _ = judge(posterior, found, prior, model.band_scale, stops_scale)
        nowhere = np.zeros_like(sigma)
        return Confidence(sigma, nowhere, Verdict.PRIOR_ONLY, (nothing,), in_stops)
    total = np.sum([e.coverage for e in telling], axis=0)
    coverage = np.array([coverage_at(found.encoded, counts) for counts in total])
    in_stops, nearer = judge(posterior, found, prior, model.band_scale, stops_scale)
    return Confidence(sigma, coverage, verdict_of(in_stops), (), in_stops, nearer, outvoted)
