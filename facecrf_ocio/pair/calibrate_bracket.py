"""Start here: exposures of one scene in, the camera's response out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from facecrf_ocio.checks import typed
from facecrf_ocio.errors import PhotoError, SettingsError
from facecrf_ocio.pair.bracket_curve import BracketCurve, bracket_reasons, solve_bracket
from facecrf_ocio.pair.bracket_pixels import (
    SmallBracket,
    flat_patches,
    no_bracket,
    small_bracket,
)
from facecrf_ocio.pair.exposure_grid import stops_of_shots
from facecrf_ocio.pair.told_order import out_of_order
from facecrf_ocio.photo.given import GivenPhoto, photo_given
from facecrf_ocio.photo.shot import Shot
from facecrf_ocio.response.coverage import coverage_at, coverage_counts
from facecrf_ocio.response.expected_stops import verdict_of
from facecrf_ocio.values import Bool, Confidence, Estimate, Float, Outcome, Photo, Verdict, frozen
from facecrf_ocio.wording.assumption_words import RELATIVE_TO_WHITE

_RELIABLE_RESIDUAL = 0.08  # [stop]
_CHECKED = 3  # photos from which on their exposures check each other
_UNCHECKED = "two photos agree with any exposures told of them; a third would check these"
_SAME_APERTURE = 1e-3  # f-numbers are written with one decimal or two


@dataclass(frozen=True, slots=True, eq=False)
class BracketEstimate:
    """The response of a camera by a bracket.

    Attributes
    ----------
    estimate
        As `calibrate` gives it; not calibrated where the bracket does not tell.
    solved
        What its figures are.
    bracket
        Its photos, aligned.
    codes, usable
        Of their patches, as `flat_patches` gives them.
    """

    estimate: Estimate
    solved: BracketCurve
    bracket: SmallBracket
    codes: Float
    usable: Bool

    @property
    def wrong_order(self) -> str:
        """Why no curve fits the exposures, with what to do, empty if one may: nothing merges."""
        problem = out_of_order(self.codes, self.usable, self.bracket.stops)
        return problem and (
            "; ".join(filter(None, told_of_false(self.solved.false, self.bracket))) or problem
        )


def stops_by_exif(shots: Sequence[Shot], photos: Sequence[Photo] | None = None) -> Float:
    """(J,) exposures of a bracket by EXIF.

    Raises
    ------
    PhotoError
        If it is but one photo, one does not tell its exposure time, or all have the same exposure.
    """
    if len(shots) == 1:
        raise no_bracket(photos[0].path if photos else None)
    for number, shot in enumerate(shots):
        if shot.exposure_s <= 0.0:
            path = photos[number].path if photos else None
            raise PhotoError(
                path, "does not tell its exposure time", "give the exposures, stops=..."
            )
    return stops_of_shots(shots)


@typed
def calibrate_bracket(
    photos: Iterable[GivenPhoto], stops: Sequence[float] | Float, *, center_only: bool = False
) -> BracketEstimate:
    """Find the inverse camera response from exposures of one scene.

    Parameters
    ----------
    photos
        One after the other, as `calibrate` takes them; only small versions are kept.
    stops
        (J,) log2 of their exposures.
    center_only
        Whether f-numbers differ, which changes how a lens darkens corners.

    Raises
    ------
    PhotoError, SettingsError
        As `small_bracket` does, or if exposures are no numbers.
    """
    given = frozen(stops)
    if not np.isfinite(given).all():
        raise SettingsError("an exposure is not finite; give stops")
    bracket = small_bracket(map(photo_given, photos), given)
    codes, usable = flat_patches(bracket, center_only=center_only)
    solved = solve_bracket(codes, given, usable)
    false, remedy = told_of_false(solved.false, bracket)
    if solved.problem or solved.found is None or solved.in_stops is None:
        estimate = _not_calibrated(solved, false, remedy)
        return BracketEstimate(estimate, solved, bracket, codes, usable)
    estimate = Estimate(
        Outcome.CALIBRATED,
        "bracket",
        f"a bracket of {len(bracket.images)} exposures over {solved.stops:.1f} stops, "
        f"residual {solved.residual:.3f} stops",
        found=solved.found,
        confidence=Confidence(
            solved.sigma,
            _coverage(codes, usable, solved),
            bracket_verdict(solved),
            bracket_reasons(solved),
            solved.in_stops,
            doubts=_doubts(f"{false}: {remedy}" if false else "", solved),
        ),
        assumptions=(
            RELATIVE_TO_WHITE,
            "the camera's exposures are not stretched as a whole: one stop is one stop",
        ),
    )
    return BracketEstimate(estimate, solved, bracket, codes, usable)


def apertures_differ(shots: Sequence[Shot]) -> bool:
    """Whether photos of a bracket were taken with different f-numbers."""
    return bool(np.ptp([shot.aperture for shot in shots]) > _SAME_APERTURE)


def bracket_verdict(solved: BracketCurve) -> Verdict:
    """`reliable` or `weak`, as the expected errors are; never `reliable` with a doubt."""
    checked = solved.false is None and solved.refined.size >= _CHECKED
    agree = checked and solved.residual <= _RELIABLE_RESIDUAL
    return verdict_of(solved.in_stops) if agree and solved.in_stops else Verdict.WEAK


def bracket_doubts(solved: BracketCurve, names: Sequence[str]) -> tuple[str, ...]:
    """Whose exposure is not what was told, of photos of these names, found in an archive."""
    said = _named(solved.false, names)
    remedy = "leave it out, or give the exposures (`facecrf bracket --stops`)"
    return _doubts(f"{said}: {remedy}" if said else "", solved)


def _doubts(false: str, solved: BracketCurve) -> tuple[str, ...]:
    unchecked = "" if solved.refined.size >= _CHECKED else _UNCHECKED
    return tuple(filter(None, [false, unchecked]))


def _named(false: tuple[int, float] | None, names: Sequence[str]) -> str:
    if false is None:
        return ""
    photo, stops = false
    more = "more" if stops > 0.0 else "less"
    return (
        f"{names[photo]} was exposed {abs(stops):.1f} stops {more} than is told of it, by what the "
        "other photos show"
    )


def told_of_false(false: tuple[int, float] | None, bracket: SmallBracket) -> tuple[str, str]:
    """Whose exposure is not what was told, and what to do; empty if none is."""
    if false is None:
        return "", ""
    photo, stops = false
    right = bracket.stops + stops * (np.arange(len(bracket.paths)) == photo)
    given = ", ".join(f"{round(stop, 2) + 0.0:g}" for stop in (right - right[0]).tolist())
    return (
        _named(false, [path.name for path in bracket.paths]),
        f"run again without it, or with stops=[{given}]",
    )


def _not_calibrated(solved: BracketCurve, false: str, remedy: str) -> Estimate:
    return Estimate(
        Outcome.NOT_CALIBRATED,
        "bracket",
        # A false time explains other problems, or hides them: one thing to do after the other.
        f"the photos give no curve: {false or solved.problem}",
        remedy
        or "shoot from a tripod with all settings fixed but the time, one stop apart, from nearly "
        "black to nearly white",
    )


def _coverage(codes: Float, usable: Bool, solved: BracketCurve) -> Float:
    if solved.found is None:
        return np.empty(0)
    at, channels = solved.found.encoded, codes[usable].T / 255.0
    return np.array([coverage_at(at, coverage_counts(channel)) for channel in channels])
