"""Start here: a clip in, its curve out, and whether curve or exposure change over time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.clip.chosen_frames import ChosenFrame, choose_frames
from facecrf_ocio.clip.clip_estimate import ClipEstimate, ClipShot, Stretch
from facecrf_ocio.clip.curve_course import (
    CourseLevels,
    CurveCourse,
    course_of_points,
    levels_of,
    posterior_at,
)
from facecrf_ocio.clip.curve_drift import drift_of_curves, drift_of_points
from facecrf_ocio.clip.frame_list import Clip
from facecrf_ocio.clip.frame_noise import Image, noise_levels
from facecrf_ocio.clip.jpeg_frames import holds_jpeg
from facecrf_ocio.clip.noise_light import add_noise
from facecrf_ocio.clip.shared_light import add_points
from facecrf_ocio.clip.tracked_points import FEWER, TrackedPoints, thinned, track
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
_PAIRS = 6  # of frames that follow one another, whose noise is measured; more tell hardly more


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
    followed = track([one.small for one in longest]) if len(longest) > 1 else None
    points = None if followed is None else thinned(followed, FEWER)
    told = _told_stops(longest)
    besides = _Besides(clip, longest, points, told, model)
    shared = settings is not None and settings.shared_curve
    concluded = partial(conclude, prior=prior, model=model, shared=shared)
    pool = partial(_of_frames, concluded, evidence)
    pooled = pool(besides)
    alone = tuple(concluded([one]) for one in evidence)
    stretches: tuple[Stretch, ...] = ()
    evenly = feigned = False
    if followed is None or points is None:
        drift = drift_of_curves([one.curve for one in alone])
    else:
        times = np.array([one.index for one in longest]) / (len(clip.times) - 1) - 0.5
        drift = drift_of_points(besides.faces, followed, times, model.prior, model.band_scale)
        if drift.is_sure:
            course = course_of_points(besides.faces, points, times, model.prior)
            feigned = course.with_exposure
            levels = None if feigned else levels_of(course.places, times)
            stretches = tuple(_stretches(levels, course, longest, besides, pool))
            evenly = levels is not None and levels.even
    light = [np.log2(_level(one.face_codes, pooled)) for one in chosen]
    return ClipEstimate(
        pooled,
        tuple(one.index for one in chosen),
        _shots(shots, pool(), concluded, model),
        drift,
        float(np.ptp(light)),
        alone,
        points is not None and told is not None,
        besides.noise_told,
        stretches,
        evenly,
        feigned,
    )


class _Besides:
    """What a clip tells besides its frames' faces; called with what these leave, it keeps both."""

    def __init__(
        self,
        clip: Clip,
        shot: Sequence[ChosenFrame],
        points: TrackedPoints | None,
        stops: Float | None,
        model: JointModel,
    ) -> None:
        self.clip, self.shot, self.points, self.stops = clip, shot, points, stops
        self.model = model
        self.noise_told = False

    def __call__(self, posterior: Posterior) -> Posterior:
        self.faces = posterior
        self.whole = self._with_others(posterior)
        return self.whole

    def _with_others(self, faces: Posterior) -> Posterior:
        prior, scale = self.model.prior, self.model.band_scale
        if self.points is not None and self.stops is not None:
            return add_points(faces, self.points, self.stops, prior, scale)
        if self.clip.motion_jpeg or any(one.path and holds_jpeg(one.path) for one in self.shot):
            return faces
        levels = noise_levels(_pairs(self.clip, [one.index for one in self.shot]))
        found = add_noise(faces, levels, prior, scale)
        self.noise_told = found is not None
        return faces if found is None else found


def _stretches(
    levels: CourseLevels | None,
    course: CurveCourse,
    shot: Sequence[ChosenFrame],
    besides: _Besides,
    pool: _Concluded,
) -> Iterator[Stretch]:
    """Parts of a shot whose curve changes, each with its own."""
    for level in levels.parts if levels else ():
        own = posterior_at(level.place, course, besides.whole, besides.model.band_scale)
        used = shot[level.first : level.last + 1]
        yield Stretch(tuple(one.index for one in used), pool(_known(own)))


def _pairs(clip: Clip, frames: Sequence[int]) -> Iterator[tuple[Image, Image]]:
    """Some of these frames, each with the one that follows it."""
    spread = np.unique(np.linspace(0, len(frames) - 1, min(len(frames), _PAIRS)).astype(np.intp))
    firsts = {min(frames[at], len(clip.times) - 2) for at in spread}
    wanted = sorted(firsts | {index + 1 for index in firsts})
    before: tuple[int, Image] | None = None
    for index, photo in clip.read(wanted):
        if before is not None and index - 1 in firsts and before[0] == index - 1:
            yield before[1], photo.encoded
        before = index, photo.encoded


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


def _known(posterior: Posterior) -> Callable[[Posterior], Posterior]:
    """What to conclude from, whatever the frames' own evidence leaves."""
    return lambda _: posterior


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
