"""How the curve changes over a shot: how far, whether that is sure, and each stretch's own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from facecrf_ocio.clip.beside_faces import BesideFaces
from facecrf_ocio.clip.clip_estimate import Stretch
from facecrf_ocio.clip.curve_course import course_of_points, levels_of, posterior_at
from facecrf_ocio.clip.curve_drift import drift_of_points
from facecrf_ocio.clip.drift_evidence import Drift
from facecrf_ocio.clip.tracked_points import FEWER, TrackedPoints, thinned
from facecrf_ocio.joint import JointModel
from facecrf_ocio.joint.prior import Posterior
from facecrf_ocio.values import Estimate, Float


@dataclass(frozen=True, slots=True)
class CurveChange:
    """The change of a curve.

    Attributes
    ----------
    drift
        How far the curves of both ends lie apart.
    stretches
        With a curve each, where it is sure that the curve changes and it shows when.
    evenly
        Whether it goes evenly from the first of them to the last, and does not jump.
    maybe_feigned
        Whether exposure goes one way over time, which can feign the drift that is told.
    """

    drift: Drift
    stretches: tuple[Stretch, ...] = ()
    evenly: bool = False
    maybe_feigned: bool = False


def change_of_curve(
    followed: TrackedPoints,
    frames: tuple[int, ...],
    times: Float,
    told: BesideFaces,
    model: JointModel,
    concluded: Callable[[Posterior], Estimate],
) -> CurveChange:
    """The change that points of fixed light show.

    Parameters
    ----------
    followed
        The same points in J frames of a shot.
    frames
        Indices of these in the clip.
    times
        (J,) of these, -0.5 to 0.5 from first to last of the clip.
    told
        The clip's curve.
    model
        Has the prior of the curves, and the factor that makes deviations honest.
    concluded
        The estimate of coefficients that are known.
    """
    prior, scale = model.prior, model.band_scale
    drift = drift_of_points(told.faces, followed, times, prior, scale)
    if not drift.is_sure:
        return CurveChange(drift)
    course = course_of_points(told.faces, thinned(followed, FEWER), times, prior)
    if course.with_exposure:
        return CurveChange(drift, maybe_feigned=True)
    levels = levels_of(course.places, times)
    if levels is None:
        return CurveChange(drift)
    stretches = tuple(
        Stretch(
            frames[level.first : level.last + 1],
            concluded(posterior_at(level.place, course, told.whole, scale)),
        )
        for level in levels.parts
    )
    return CurveChange(drift, stretches, levels.even)
