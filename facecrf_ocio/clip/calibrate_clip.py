"""Start here: a clip in, its curve out, and whether curve or exposure change over time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.clip.beside_faces import add_beside_faces
from facecrf_ocio.clip.chosen_frames import ChosenFrame, choose_frames
from facecrf_ocio.clip.clip_estimate import ClipEstimate, ClipShot
from facecrf_ocio.clip.curve_change import CurveChange, change_of_curve
from facecrf_ocio.clip.curve_drift import drift_of_curves
from facecrf_ocio.clip.frame_list import Clip
from facecrf_ocio.clip.tracked_points import track
from facecrf_ocio.joint import (
    JointModel,
    PhotoEvidence,
    conclude,
    misfit,
    shipped_joint,
)
from facecrf_ocio.joint.prior import Posterior
from facecrf_ocio.settings import Settings
from facecrf_ocio.together import MISFIT_LIMIT
from facecrf_ocio.values import Estimate, Float, Outcome

_Concluded = Callable[..., Estimate]  # `conclude`, told of the prior and the model

FRAMES = 12  # more tell hardly more: their errors are alike
CORRELATION = 0.95
"""Of the errors of any two frames of one face in one light, by `examples/measure_clips` on 35 clips
of four faces and 10 of three others: where exposure stays 0.90 to 1.0, however far frames are
apart; where it moves by 1.5 stops 0.55 to 0.99 in rows of four. That of fixed exposure is used, so
that no band is too narrow."""

_SAME_SHOT = 0.5  # correlation of the brightness ranks of thumbnails, 32 x 18


def calibrate_clip(
    clip: Clip,
    *,
    frames: int = FRAMES,
    prior: str = "auto",
    settings: Settings | None = None,
    model: JointModel | None = None,
) -> ClipEstimate:
    """Estimate the one curve of a clip.

    Parameters
    ----------
    clip
        As `open_clip` gives it.
    frames
        How many to use at most, spread over time.
    prior, settings, model
        As for `calibrate`.

    Raises
    ------
    PhotoError
        If too few of its frames can be read.
    """
    first = clip.first(range(len(clip.times)))
    if first.scene_linear or first.named_curve:
        return ClipEstimate(calibrate(first))
    model = model or shipped_joint()
    chosen = choose_frames(clip, frames, settings, model)
    if not chosen:
        return _nothing(prior, model)
    shots = _grouped(chosen)
    longest = max(shots, key=len)
    followed = track([one.small for one in longest]) if len(longest) > 1 else None
    shared = settings is not None and settings.shared_curve
    concluded = partial(conclude, prior=prior, model=model, shared=shared)
    evidence = [one.evidence for one in chosen]
    by_faces, faces = _by_faces(concluded, evidence)
    told = add_beside_faces(faces, clip, longest, followed, model)
    by_all = partial(_by_all, concluded, evidence)
    pooled = by_all(told.whole)
    alone = tuple(concluded([one]) for one in evidence)
    if followed is None:
        change = CurveChange(drift_of_curves([one.curve for one in alone]))
    else:
        shown = tuple(one.index for one in longest)
        times = np.array(shown) / (len(clip.times) - 1) - 0.5
        change = change_of_curve(followed, shown, times, told, model, by_all)
    light = [np.log2(_level(one.face_codes, pooled)) for one in chosen]
    return ClipEstimate(
        pooled,
        tuple(one.index for one in chosen),
        _shots(shots, by_faces, concluded, model),
        change.drift,
        float(np.ptp(light)),
        alone,
        told.exposures_told,
        told.noise_told,
        change.stretches,
        change.evenly,
        change.maybe_feigned,
    )


def _nothing(prior: str, model: JointModel) -> ClipEstimate:
    """Of a clip without faces."""
    return ClipEstimate(
        replace(
            conclude([], prior, model),
            outcome=Outcome.NOT_CALIBRATED,
            reason="no frame that was looked at shows a face",
            remedy="give a part of the clip with a face, or look at more frames",
            found=None,
            confidence=None,
        )
    )


def _level(codes: Float, estimate: Estimate) -> float:
    """Median linear light of green."""
    return max(float(np.median(estimate.curve.linearize(codes)[:, 1])), 1e-6)


def _by_faces(
    concluded: _Concluded, evidence: Sequence[PhotoEvidence]
) -> tuple[Estimate, Posterior]:
    """The curve of frames of one scene by their faces, and what these leave of the prior."""
    left = []

    def looked_at(posterior: Posterior) -> Posterior:
        left.append(posterior)
        return posterior

    estimate = _of_frames(concluded, evidence, looked_at)
    return estimate, left[0]


def _by_all(concluded: _Concluded, evidence: Sequence[PhotoEvidence], known: Posterior) -> Estimate:
    """The curve of frames where more is known than their faces leave of it."""
    return _of_frames(concluded, evidence, lambda _: known)


def _of_frames(
    concluded: _Concluded,
    evidence: Sequence[PhotoEvidence],
    besides: Callable[[Posterior], Posterior] | None = None,
) -> Estimate:
    """The curve of frames of one scene, in whose words photos are frames."""
    pooled = concluded(evidence, correlation=CORRELATION, besides=besides)
    reason = pooled.reason.replace("photos", "frames").replace("1 photo", "1 frame")
    return replace(pooled, reason=reason)


def _grouped(chosen: Sequence[ChosenFrame]) -> list[list[ChosenFrame]]:
    """Frames between cuts."""
    groups: list[list[ChosenFrame]] = []
    for one in chosen:
        if groups and _alike(groups[-1][-1].thumbnail, one.thumbnail) >= _SAME_SHOT:
            groups[-1].append(one)
        else:
            groups.append([one])
    return groups


def _shots(
    groups: Sequence[Sequence[ChosenFrame]],
    pooled: Estimate,
    concluded: _Concluded,
    model: JointModel,
) -> tuple[ClipShot, ...]:
    """Parts between cuts, each held against the curve that the faces of all of them give."""
    found = []
    for group in groups:
        off = float(np.mean([misfit(one.evidence, pooled, model) for one in group]))
        own = None
        if off > MISFIT_LIMIT and len(groups) > 1:
            own = _of_frames(concluded, [one.evidence for one in group])
        found.append(ClipShot(tuple(one.index for one in group), own, off))
    return tuple(found)


def _alike(one: Float, other: Float) -> float:
    return float(np.corrcoef(one, other)[0, 1])
