"""Start here: a clip in, its curve out, and whether curve or exposure change over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.clip.frame_list import Clip
from facecrf_ocio.joint import PhotoEvidence, conclude, gather, misfit
from facecrf_ocio.response.expected_stops import expected_of_sigma
from facecrf_ocio.settings import Settings
from facecrf_ocio.together import MISFIT_LIMIT
from facecrf_ocio.values import Estimate, Float, Outcome, Photo

FRAMES = 12  # more tell hardly more: their errors are alike
_TRIED = 3  # frames looked at for each that is used
# Of the errors of any two frames: they show one face in one light, where photos of one camera,
# of which 0.3 holds, show several. With this 12 frames tell as much as 1.2 independent ones.
_CORRELATION, _OF_PHOTOS = 0.8, 0.3
_SAME_SHOT = 0.5  # correlation of the brightness ranks of thumbnails, 32 x 18
_SURE = 3.0  # standard errors from which a difference between both ends is a drift
_LEAST_DRIFT = 0.01  # RMSE
_FEWEST = 4  # frames that a drift is told from


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
        RMSE between the curves of the first and the last third of the frames.
    drift_error
        Standard error of that, by how frames of one third scatter.
    exposure_stops
        [stop] How much the brightness of the face's light varied, from least to most.
    """

    estimate: Estimate
    frames: tuple[int, ...] = ()
    shots: tuple[Shot, ...] = ()
    drift: float = 0.0
    drift_error: float = 0.0
    exposure_stops: float = 0.0

    @property
    def drifts(self) -> bool:
        """Whether the curve changes over time, beyond doubt."""
        return self.drift > max(_LEAST_DRIFT, _SURE * self.drift_error)


def calibrate_clip(
    clip: Clip, *, frames: int = FRAMES, prior: str = "auto", settings: Settings | None = None
) -> ClipEstimate:
    """Estimate the one curve of a clip.

    Parameters
    ----------
    clip
        As `open_clip` gives it.
    frames
        How many to use at most, spread over time.
    prior, settings
        As for `calibrate`.
    """
    first = next(clip.read([0]))
    if first.scene_linear or first.named_curve:
        return ClipEstimate(calibrate(first))
    chosen = _chosen(clip, frames, settings)
    if not chosen:
        nothing = conclude([], prior)
        return ClipEstimate(
            replace(
                nothing,
                outcome=Outcome.NOT_CALIBRATED,
                reason="no frame that was looked at shows a face",
                remedy="give a part of the clip with a face, or more --frames",
                found=None,
                confidence=None,
            )
        )
    evidence = [one.evidence for one in chosen]
    pooled = conclude(evidence, prior)
    drift, error = _drift([conclude([e], prior).curve.linear[0] for e in evidence])
    light = [np.log2(_level(one.face_codes, pooled)) for one in chosen]
    return ClipEstimate(
        _honest(pooled, len(chosen)),
        tuple(one.index for one in chosen),
        _shots(chosen, pooled, prior),
        drift,
        error,
        float(np.ptp(light)),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Chosen:
    """A frame that tells something: its evidence, the code values of its face, a thumbnail."""

    index: int
    evidence: PhotoEvidence
    worth: float
    face_codes: Float
    thumbnail: Float


def _chosen(clip: Clip, frames: int, settings: Settings | None) -> list[_Chosen]:
    """The frame of each stretch of time whose face is largest and sharpest."""
    count = len(clip.times)
    tried = np.unique(np.linspace(0, count - 1, min(count, _TRIED * frames)).astype(np.intp))
    best: dict[int, _Chosen] = {}
    for index, photo in zip(tried, clip.read([int(i) for i in tried]), strict=True):
        one = _looked_at(int(index), photo, settings)
        stretch = int(index * frames // count)
        if one is not None and (stretch not in best or one.worth > best[stretch].worth):
            best[stretch] = one
    return [best[stretch] for stretch in sorted(best)]


def _looked_at(index: int, photo: Photo, settings: Settings | None) -> _Chosen | None:
    evidence = gather(photo, settings)
    if evidence.face is None or not evidence.messages:
        return None
    x, y, width, height = (round(float(v)) for v in evidence.face.box_xy)
    inside = photo.encoded[max(y, 0) : y + height, max(x, 0) : x + width]
    gray = cv2.cvtColor(np.ascontiguousarray(inside), cv2.COLOR_RGB2GRAY)
    sharp = float(np.std(cv2.Laplacian(gray, cv2.CV_32F)))
    small = cv2.resize(photo.encoded, (32, 18), interpolation=cv2.INTER_AREA).mean(axis=2)
    ranks = np.argsort(np.argsort(small.ravel())).astype(np.float64)
    return _Chosen(index, evidence, width * sharp, inside.reshape(-1, 3).astype(np.float64), ranks)


def _level(codes: Float, estimate: Estimate) -> float:
    """Median linear light of green."""
    return max(float(np.median(estimate.curve.linearize(codes)[:, 1])), 1e-6)


def _honest(pooled: Estimate, count: int) -> Estimate:
    """Widen the band from that of as many photos to that of as many frames of one scene."""
    told = pooled.confidence
    if told is None:
        return pooled
    frames = _CORRELATION + (1.0 - _CORRELATION) / count
    photos = _OF_PHOTOS + (1.0 - _OF_PHOTOS) / count
    sigma = told.sigma * np.sqrt(frames / photos)
    expected = expected_of_sigma(pooled.curve, sigma)
    return replace(
        pooled,
        reason=pooled.reason.replace("photos", "frames").replace("1 photo", "1 frame"),
        confidence=replace(told, sigma=sigma, in_stops=expected),
    )


def _drift(curves: Sequence[Float]) -> tuple[float, float]:
    """RMSE between the mean curves of the first and last third, and its standard error."""
    if len(curves) < _FEWEST:
        return 0.0, 0.0
    third = max(2, len(curves) // 3)
    first, last = np.array(curves[:third]), np.array(curves[-third:])
    apart = first.mean(axis=0) - last.mean(axis=0)
    scatter = (first.var(axis=0, ddof=1) + last.var(axis=0, ddof=1)) / third
    return float(np.sqrt((apart**2).mean())), float(np.sqrt(scatter.mean()))


def _shots(chosen: Sequence[_Chosen], pooled: Estimate, prior: str) -> tuple[Shot, ...]:
    groups: list[list[_Chosen]] = []
    for one in chosen:
        alike = groups and _alike(groups[-1][-1].thumbnail, one.thumbnail) >= _SAME_SHOT
        if alike:
            groups[-1].append(one)
        else:
            groups.append([one])
    found = []
    for group in groups:
        off = float(np.mean([misfit(one.evidence, pooled) for one in group]))
        own = None
        if off > MISFIT_LIMIT and len(groups) > 1:
            own = _honest(conclude([one.evidence for one in group], prior), len(group))
        found.append(Shot(tuple(one.index for one in group), own, off))
    return tuple(found)


def _alike(one: Float, other: Float) -> float:
    return float(np.corrcoef(one, other)[0, 1])
