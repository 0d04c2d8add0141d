"""Exposures with which the photos of a bracket are merged, and whose was not what was told."""

from __future__ import annotations

from dataclasses import dataclass

from facecrf_ocio.pair.bracket_pixels import SmallBracket, with_stops
from facecrf_ocio.pair.calibrate_bracket import BracketEstimate, told_of_false
from facecrf_ocio.pair.left_out import false_by_curve
from facecrf_ocio.pair.merge import refined_stops
from facecrf_ocio.values import InverseCRF


@dataclass(frozen=True, slots=True, eq=False)
class MergeExposures:
    """The exposures of a bracket that is to be merged.

    Attributes
    ----------
    bracket
        Its `stops` as the pixels have them.
    false, remedy
        Whose exposure is not what was told, and what to do; empty if none is.
    """

    bracket: SmallBracket
    false: str
    remedy: str


def merge_exposures(solved: BracketEstimate, curve: InverseCRF) -> MergeExposures:
    """Ask the photos of a bracket what their exposures are, by its own curve or another."""
    bracket, patches = solved.bracket, (solved.codes, solved.usable)
    own = curve is solved.estimate.found
    stops = solved.solved.refined if own else refined_stops(bracket.stops, *patches, curve)
    false = solved.solved.false
    if false is None and not own:
        false = false_by_curve(*patches, bracket.stops, curve)
    return MergeExposures(with_stops(bracket, stops), *told_of_false(false, bracket))
