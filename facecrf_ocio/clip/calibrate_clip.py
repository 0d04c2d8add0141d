"""Start here: a clip in, its curve out, and whether curve or exposure change over time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.clip.chosen_frames import ChosenFrame, choose_frames
from facecrf_ocio.clip.frame_list import Clip
from facecrf_ocio.clip.frame_noise import Image, noise_levels
from facecrf_ocio.clip.jpeg_frames import holds_jpeg
from facecrf_ocio.clip.noise_light import add_noise
from facecrf_ocio.clip.shared_light import add_points, drift_of_points
from facecrf_ocio.clip.tracked_points import track
from facecrf_ocio.joint import (
    JointModel,
    PhotoEvidence,
    conclude,
    misfit,
    shipped_joint,
)
from facecrf_ocio.joint.prior import Posterior
from facecrf_ocio.pair.exposure_grid import exposure_stops
from facecrf_ocio.photo.shot import read_shot
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

_LEAST_STOPS = 0.3  # [stop] of exposures that tell anything of the curve
_SAME_SHOT = 0.5  # correlation of the brightness ranks of thumbnails, 32 x 18
_SURE = 3.0  # standard errors from which a difference between both ends is a drift
_LEAST_DRIFT = 0.003  # RMSE where points lie; clips without drift show 0.0015 at most
_FEWEST = 4  # frames that a drift is told from
_PAIRS = 6  # of frames that follow one another, whose noise is measured; more tell hardly more


@dataclass(frozen=True, slots=True)
class Shot:
    """A part of a clip between cuts, as far as chosen frames tell.

    Attributes
    ----------
    frames
        Indices of the frames it was calibrated from.
    estimate
        Its own curve; None where it fits the clip's.
    misfit
        [standard deviation] how far its evidence lies from the clip's curve.
    """

    frames: tuple[int, ...]
    estimate: Estimate | None
    misfit: float


@dataclass(frozen=True, slots=True)
class ClipEstimate:
    """What a clip gives.

    Attributes
    ----------
    estimate
        The curve of all frames.
    frames
        Indices of those it comes from; none where the stream names its curve.
    shots
        Parts between cuts.
    drift
        RMSE between the curves of both ends, over the codes that the scene shows.
    drift_error
        Standard error of that.
    exposure_stops
        [stop] How much the brightness of the face's light varied, from least to most.
    alone
        What each of the frames says alone.
    exposures_told
        Whether files told exposures that differ, by which the curve was found.
    noise_told
        Whether the noise of frames that follow one another told the curve's exponent.
    """

    estimate: Estimate
    frames: tuple[int, ...] = ()
    shots: tuple[Shot, ...] = ()
    drift: float = 0.0
    drift_error: float = 0.0
    exposure_stops: float = 0.0
    alone: tuple[Estimate, ...] = ()
    exposures_told: bool = False
    noise_told: bool = False

    @property
    def drifts(self) -> bool:
        """Whether the curve changes over time, beyond doubt."""
        return self.drift > max(_LEAST_DRIFT, _SURE * self.drift_error)


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
    """
    first = next(clip.read([0]))
    if first.scene_linear or first.named_curve:
        return ClipEstimate(calibrate(first))
    model = model or shipped_joint()
    chosen = choose_frames(clip, frames, settings, model)
    if not chosen:
        nothing = conclude([], prior, model)
        return ClipEstimate(
            replace(
                nothing,
                outcome=Outcome.NOT_CALIBRATED,
                reason="no frame that was looked at shows a face",
                remedy="give a part of the clip with a face, or look at more frames",
                found=None,
                confidence=None,
            )
        )
    evidence = [one.evidence for one in chosen]
    shots = _grouped(chosen)
    longest = max(shots, key=len)
    points = track([one.small for one in longest]) if len(longest) > 1 else None
    told = _told_stops(longest)
    faces: list[Posterior] = []
    noise: list[Posterior] = []

    def besides(posterior: Posterior) -> Posterior:
        faces.append(posterior)
        if points is not None and told is not None:
            return add_points(posterior, points, told, model.prior, model.band_scale)
        if clip.motion_jpeg or any(one.path and holds_jpeg(one.path) for one in longest):
            return posterior
        levels = noise_levels(_pairs(clip, [one.index for one in longest]))
        found = add_noise(posterior, levels, model.prior, model.band_scale)
        noise.extend([] if found is None else [found])
        return posterior if found is None else found

    shared = settings is not None and settings.shared_curve
    concluded = partial(conclude, prior=prior, model=model, shared=shared)
    pooled = _of_frames(concluded, evidence, besides)
    alone = tuple(concluded([one]) for one in evidence)
    if points is None:
        drift, error = _drift([one.curve.linear[0] for one in alone])
    else:
        times = np.array([one.index for one in longest]) / (len(clip.times) - 1) - 0.5
        drift, error = drift_of_points(faces[0], points, times, model.prior)
    light = [np.log2(_level(one.face_codes, pooled)) for one in chosen]
    return ClipEstimate(
        pooled,
        tuple(one.index for one in chosen),
        _shots(shots, _of_frames(concluded, evidence), concluded, model),
        drift,
        error,
        float(np.ptp(light)),
        alone,
        points is not None and told is not None,
        bool(noise),
    )


def _pairs(clip: Clip, frames: Sequence[int]) -> Iterator[tuple[Image, Image]]:
    """Some of these frames, each with the one that follows it."""
    spread = np.unique(np.linspace(0, len(frames) - 1, min(len(frames), _PAIRS)).astype(np.intp))
    firsts = {min(frames[at], len(clip.times) - 2) for at in spread}
    wanted = sorted(firsts | {index + 1 for index in firsts})
    before: Image | None = None
    for index, photo in zip(wanted, clip.read(wanted), strict=True):
        if before is not None and index - 1 in firsts:
            yield before, photo.encoded
        before = photo.encoded


def _level(codes: Float, estimate: Estimate) -> float:
    """Median linear light of green."""
    return max(float(np.median(estimate.curve.linearize(codes)[:, 1])), 1e-6)


def _of_frames(
    concluded: _Concluded,
    evidence: Sequence[PhotoEvidence],
    besides: Callable[[Posterior], Posterior] | None = None,
) -> Estimate:
    """The curve of frames of one scene, in whose words photos are frames."""
    pooled = concluded(evidence, correlation=CORRELATION, besides=besides)
    reason = pooled.reason.replace("photos", "frames").replace("1 photo", "1 frame")
    return replace(pooled, reason=reason)


def _told_stops(shot: Sequence[ChosenFrame]) -> Float | None:
    """(J,) log2 of the exposures of frames, by the EXIF of their files; None where it is silent."""
    paths = [one.path for one in shot if one.path is not None]
    if len(set(paths)) < len(shot):
        return None  # frames of one video file
    told = [read_shot(path) for path in paths]
    if any(one.exposure_s <= 0.0 for one in told):
        return None
    stops = exposure_stops(
        [one.exposure_s for one in told],
        [one.aperture for one in told],
        [one.iso for one in told],
    )
    return stops if np.ptp(stops) >= _LEAST_STOPS else None


def _drift(curves: Sequence[Float]) -> tuple[float, float]:
    """RMSE between the mean curves of the first and last third, and its standard error."""
    if len(curves) < _FEWEST:
        return 0.0, 0.0
    third = max(2, len(curves) // 3)
    first, last = np.array(curves[:third]), np.array(curves[-third:])
    apart = first.mean(axis=0) - last.mean(axis=0)
    scatter = (first.var(axis=0, ddof=1) + last.var(axis=0, ddof=1)) / third
    return float(np.sqrt((apart**2).mean())), float(np.sqrt(scatter.mean()))


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
) -> tuple[Shot, ...]:
    """Parts between cuts, each held against the curve that the faces of all of them give."""
    found = []
    for group in groups:
        off = float(np.mean([misfit(one.evidence, pooled, model) for one in group]))
        own = None
        if off > MISFIT_LIMIT and len(groups) > 1:
            own = _of_frames(concluded, [one.evidence for one in group])
        found.append(Shot(tuple(one.index for one in group), own, off))
    return tuple(found)


def _alike(one: Float, other: Float) -> float:
    return float(np.corrcoef(one, other)[0, 1])
