"""From evidence to a curve with a calibrated band: one photo, or several of one camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from facecrf_ocio.joint.evidence import COVERAGE_BINS, PhotoEvidence
from facecrf_ocio.joint.fuse import agreeing_shares, average, multiply
from facecrf_ocio.joint.messages import COMBINED, Networks, load_networks
from facecrf_ocio.joint.prior import FamilyPrior, Message, Posterior, load_prior
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model, inverse_crf, strictly_increasing
from facecrf_ocio.values import (
    CHANNELS,
    Confidence,
    Estimate,
    Float,
    InverseCRF,
    Outcome,
    Verdict,
)

# Share of the posterior's curves to which the estimate is nearer than sRGB decoding, and the
# expected error, from which an estimate is called reliable.
RELIABLE_SHARE = 0.95
RELIABLE_ERROR = 0.045
# Photos of one camera err alike in part (what a cue does not know of any photo): the correlation of
# their errors, by which bands of several photos cover as they say.
PHOTO_CORRELATION = 0.5
_DRAWS = 512
_NAMES = {COMBINED: "the combination of all cues"}


@dataclass(frozen=True, slots=True)
class JointModel:
    """All that was learned: the prior, the networks, and how much too narrow the posterior is.

    Attributes
    ----------
    prior
        Families of responses.
    networks
        What the statistics of each cue say.
    band_scale
        Factor on the posterior's deviation that makes bands cover as they say, measured on heads
        that were not trained on.
    """

    prior: FamilyPrior
    networks: Networks
    band_scale: float = 1.0


def load_joint(path: Path) -> JointModel:
    """Read a model that `train` wrote."""
    with np.load(path) as stored:
        scale = float(stored["band_scale"])
    return JointModel(load_prior(path), load_networks(path), scale)


@cache
def shipped_joint() -> JointModel:
    """The model that ships."""
    return load_joint(Path(str(files("facecrf_ocio.joint") / "joint_model.npz")))


def conclude(
    evidence: Sequence[PhotoEvidence], prior: str = "auto", model: JointModel | None = None
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

    Returns
    -------
    Estimate
        Without any evidence, the prior's mean with the prior's band, as a fallback.
    """
    model = model or shipped_joint()
    telling = [e for e in evidence if e.messages]
    leanings = [e.leaning for e in telling or evidence] or [0.0]
    weights = model.prior.weights_for(prior, float(np.mean(leanings)))
    posterior, dissent = _pool(telling, model.prior, weights)
    coefficients = posterior.mean
    curve = strictly_increasing([model.prior.samples(coefficients)] * len(CHANNELS))
    found = inverse_crf(model.prior.grid, curve)
    confidence = _confidence(telling, posterior, found, model, dissent)
    if not telling:
        first = evidence[0] if evidence else PhotoEvidence({}, np.empty(0), 0.0, "no photo given")
        return Estimate(
            Outcome.FALLBACK,
            "joint",
            f"{first.lacking}: the mean of the prior",
            first.remedy,
            found=found,
            confidence=confidence,
            coefficients=np.tile(coefficients, (len(CHANNELS), 1)),
        )
    faces = tuple(e.face for e in telling if e.face is not None)
    cues = sorted({cue for e in telling for cue in e.messages} - {COMBINED})
    photos = "1 photo" if len(telling) == 1 else f"{len(telling)} photos"
    return Estimate(
        Outcome.CALIBRATED,
        "joint",
        f"{photos}, {len(cues)} cues: {', '.join(cues)}",
        found=found,
        confidence=confidence,
        coefficients=np.tile(coefficients, (len(CHANNELS), 1)),
        faces=faces,
    )


def misfit(evidence: PhotoEvidence, estimate: Estimate, model: JointModel | None = None) -> float:
    """How far a photo's own evidence lies from a curve, in standard deviations per coefficient.

    About 1 for a member of the group; 0 where the photo says nothing.
    """
    model = model or shipped_joint()
    if not evidence.messages or estimate.coefficients is None:
        return 0.0
    weights = model.prior.weights_for("auto", evidence.leaning)
    own, _ = _pool([evidence], model.prior, weights)
    offset = own.mean - estimate.coefficients[0]
    distance = float(offset @ np.linalg.solve(own.covariance, offset))
    return float(np.sqrt(distance / offset.size))


def _pool(
    telling: Sequence[PhotoEvidence], prior: FamilyPrior, weights: Float
) -> tuple[Posterior, tuple[str, ...]]:
    """What all photos leave of the prior, and which cues or photos the others outvoted.

    Photos are averaged as posteriors and not multiplied as likelihoods: the networks were trained
    for what one photo's messages leave of the prior, and several photos share what is wrong in it.
    """
    of_photos: dict[str, Message] = {}
    outvoted = []
    for number, one in enumerate(telling):
        shares = agreeing_shares(one.messages, prior, weights)
        joined = multiply(list(one.messages.values()), [shares[c] for c in one.messages])
        if joined is not None:
            of_photos[f"photo {number + 1}"] = joined
        outvoted += [_NAMES.get(cue, cue) for cue, share in shares.items() if share < 0.5]
    if not of_photos:
        return prior.posterior(None, weights), ()
    shares = agreeing_shares(of_photos, prior, weights)
    outvoted += [photo for photo, share in shares.items() if share < 0.5]
    posteriors = [prior.posterior(message, weights) for message in of_photos.values()]
    trust = [
        share / float((prior.deviations(posterior) ** 2).mean())
        for share, posterior in zip(shares.values(), posteriors, strict=True)
    ]
    return average(posteriors, trust, PHOTO_CORRELATION), tuple(outvoted)


def _confidence(
    telling: Sequence[PhotoEvidence],
    posterior: Posterior,
    found: InverseCRF,
    model: JointModel,
    outvoted: tuple[str, ...],
) -> Confidence:
    prior = model.prior
    sigma = np.interp(found.encoded, prior.grid, prior.deviations(posterior))
    sigma = np.tile(model.band_scale * sigma, (len(CHANNELS), 1))
    if not telling:
        nothing = "nothing in the photo was used: this is the prior's mean and spread"
        return Confidence(sigma, np.zeros_like(sigma), Verdict.PRIOR_ONLY, (nothing,))
    centers = (np.arange(COVERAGE_BINS) + 0.5) / COVERAGE_BINS
    total = np.sum([e.coverage for e in telling], axis=0)
    coverage = np.array(
        [np.interp(found.encoded, centers, c / max(float(c.max()), 1e-12)) for c in total]
    )
    error = float(np.sqrt((sigma[0] ** 2).mean()))
    share = _share_nearer_than_srgb(posterior, found, model)
    reliable = error <= RELIABLE_ERROR and share >= RELIABLE_SHARE and not outvoted
    reasons = (
        f"expected error {error:.3f}; nearer to the truth than sRGB decoding in "
        f"{100.0 * share:.0f} % of the curves that the photo leaves possible",
        *(f"{name} contradicts the other evidence and counts less" for name in outvoted),
    )
    verdict = Verdict.RELIABLE if reliable else Verdict.WEAK
    return Confidence(sigma, coverage, verdict, reasons)


def _share_nearer_than_srgb(posterior: Posterior, found: InverseCRF, model: JointModel) -> float:
    """Share of curves drawn from the posterior to which the estimate is nearer than sRGB is."""
    generator = np.random.default_rng(0)
    spread = np.linalg.cholesky(posterior.covariance)
    draws = generator.standard_normal((_DRAWS, posterior.mean.size)) @ spread.T
    grid = model.prior.grid[::8]
    curves = model.prior.samples(posterior.mean + model.band_scale * draws)[:, ::8]
    estimate = np.interp(grid, found.encoded, found.linear[0])
    srgb = fixed_curve("srgb", grid, dorf_model())
    ours = ((curves - estimate) ** 2).mean(axis=1)
    theirs = ((curves - srgb) ** 2).mean(axis=1)
    return float((ours < theirs).mean())
