"""What a clip gives: its curve, those of its shots and stretches, and what is told of them."""

from __future__ import annotations

from dataclasses import dataclass

from facecrf_ocio.clip.drift_evidence import Drift
from facecrf_ocio.values import Estimate


@dataclass(frozen=True, slots=True)
class ClipShot:
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
class Stretch:
    """A part of a shot over which its curve stays, where it changes within the shot.

    Attributes
    ----------
    frames
        Indices of the frames that show it.
    estimate
        Its curve: the clip's, changed as the points that frames share tell.
    """

    frames: tuple[int, ...]
    estimate: Estimate


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
        How far the curves of both ends lie apart over the codes that the scene shows.
    exposure_stops
        [stop] How much the brightness of the face's light varied, from least to most.
    alone
        What each of the frames says alone.
    exposures_told
        Whether files told exposures that differ, by which the curve was found.
    noise_told
        Whether the noise of frames that follow one another told the curve's exponent.
    stretches
        Of the longest shot, where its curve changes and it shows when; empty otherwise.
    evenly
        Whether the curve goes evenly from the first of them to the last, and does not jump.
    maybe_feigned
        Whether exposure goes one way over time, which can feign the drift that is told.
    """

    estimate: Estimate
    frames: tuple[int, ...] = ()
    shots: tuple[ClipShot, ...] = ()
    drift: Drift = Drift()  # noqa: RUF009 -- frozen
    exposure_stops: float = 0.0
    alone: tuple[Estimate, ...] = ()
    exposures_told: bool = False
    noise_told: bool = False
    stretches: tuple[Stretch, ...] = ()
    evenly: bool = False
    maybe_feigned: bool = False

    def of_frame(self, index: int) -> Estimate:
        """The curve of a frame: that of the used frame nearest to it."""
        nearest = min(self.frames, key=lambda one: abs(one - index), default=index)
        parts: tuple[Stretch | ClipShot, ...] = (*self.stretches, *self.shots)
        for part in parts:
            if nearest in part.frames and part.estimate is not None:
                return part.estimate
        return self.estimate
