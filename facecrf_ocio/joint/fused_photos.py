"""What all photos of one camera leave of the prior, and which of their cues the others outvote."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from facecrf_ocio.joint.brightness import less_sure
from facecrf_ocio.joint.cue_weights import agreeing_shares
from facecrf_ocio.joint.evidence import PhotoEvidence
from facecrf_ocio.joint.fuse import average, multiply, widened
from facecrf_ocio.joint.known_response import KnownResponse, share_beside
from facecrf_ocio.joint.messages import COMBINED
from facecrf_ocio.joint.prior import FamilyPrior, Message, Posterior
from facecrf_ocio.values import Float

# Photos of one camera err alike (what a cue does not know of any photo): the correlation of their
# errors. Ten cameras' own photos, three to 31 of each, are off by 0.072 stops together and by 0.079
# alone, and heads through 56 responses by 2 to 5 % less: 0.8 to 0.95. With 0.5 they expected 0.075
# for 0.098 alone (docs/evidence/real-photos-with-a-truth.md).
PHOTO_CORRELATION = 0.8
# Of cues whose names in the code are not words.
_NAMES = {
    COMBINED: "the combination of all cues",
    "soft_edges": "soft edges",
    "color_lines": "color lines",
}


@dataclass(frozen=True, slots=True, eq=False)
class Fused:
    """What all photos leave of the prior.

    Attributes
    ----------
    posterior
        Over the prior's coefficients.
    families
        (F,) share of each of the prior's families in it.
    outvoted
        Cues or photos that the others outvoted.
    """

    posterior: Posterior
    families: Float
    outvoted: tuple[str, ...] = ()


def fuse_photos(
    telling: Mapping[str, PhotoEvidence],
    stretches: Mapping[str, float],
    prior: FamilyPrior,
    weights: Float,
    known: Mapping[tuple[str, str], KnownResponse],
    correlation: float = PHOTO_CORRELATION,
) -> Fused:
    """What all photos leave of the prior.

    Photos are averaged as posteriors and not multiplied as likelihoods: the networks were trained
    for what one photo's messages leave of the prior, and several photos share what is wrong in it.
    The posterior of each is widened by its stretch. What is known of their camera is the same
    message for all of them, and counts once at the end. `weights` (C,) are those of the prior's
    components before any photo.
    """
    of_photos: dict[str, Message] = {}
    outvoted = []
    of_cameras: dict[str, list[float]] = {}
    for name, one in telling.items():
        messages, camera = dict(one.messages), known.get(one.camera)
        if camera is not None:
            messages[camera.source] = camera.message
        shares = agreeing_shares(messages, prior, weights)
        joined = multiply(list(one.messages.values()), [shares[c] for c in one.messages])
        if joined is not None:
            of_photos[name] = joined
        if camera is not None:
            share = share_beside(camera.message, _left_by(joined, prior, weights))
            of_cameras.setdefault(camera.name, []).append(share)
            shares[camera.source] = share
        outvoted += [called(cue) for cue, share in shares.items() if share < 0.5]
    if not of_photos:
        return Fused(prior.posterior(None, weights), prior.shares_of_families(weights))
    shares = agreeing_shares(of_photos, prior, weights)
    outvoted += [photo for photo, share in shares.items() if share < 0.5]
    posteriors = [
        widened(_left_by(message, prior, weights), stretches[photo])
        for photo, message in of_photos.items()
    ]
    trust = [
        share / float((prior.deviations(posterior) ** 2).mean())
        for share, posterior in zip(shares.values(), posteriors, strict=True)
    ]
    alone = len(posteriors) == 1
    pooled = posteriors[0] if alone else average(posteriors, trust, correlation)
    families = np.mean([prior.shares_of_families(one.weights) for one in posteriors], axis=0)
    return Fused(_times_cameras(pooled, known, of_cameras), families, tuple(outvoted))


def _left_by(message: Message | None, prior: FamilyPrior, weights: Float) -> Posterior:
    """What all cues of a photo leave of the prior."""
    left = prior.posterior(message, weights)
    return left if message is None else less_sure(left, message, prior.family)


def _times_cameras(
    pooled: Posterior,
    known: Mapping[tuple[str, str], KnownResponse],
    shares: Mapping[str, Sequence[float]],
) -> Posterior:
    """Each camera's message once, with the mean of its shares in the photos that name it."""
    for one in {camera.name: camera for camera in known.values()}.values():
        share = float(np.mean(shares[one.name]))
        pooled = pooled.times(Message(one.message.mean, share * one.message.precision))
    return pooled


def called(cue: str) -> str:
    """A cue in words."""
    return _NAMES.get(cue, cue)
