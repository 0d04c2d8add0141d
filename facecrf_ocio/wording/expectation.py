"""How far off a curve is expected to be, beside what sRGB decoding would be."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cache, lru_cache

import numpy as np

from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.response.stops import MID_CODES, log_light, mean_over, uniform
from facecrf_ocio.values import Estimate, Float, Outcome, Verdict, frozen

# sRGB does as well where it lies no farther from the estimate than the estimate's own error.
_AS_WELL = 1.0


@dataclass(frozen=True, slots=True)
class Expectation:
    """What a user can expect of a curve.

    Attributes
    ----------
    verdict
        How far to trust it.
    white_percent
        Root mean square of the expected error over all codes, in percent of white.
    mid_stops, shadow_stops
        Expected mean error in stops over the codes of `response.stops`; None where not known.
    srgb_stops
        The same in the midtones if the photo were decoded as sRGB instead.
    srgb_does_as_well
        Whether that is no worse.
    """

    verdict: Verdict
    white_percent: float
    mid_stops: float | None
    shadow_stops: float | None
    srgb_stops: float
    srgb_does_as_well: bool

    def record(self) -> dict[str, object]:
        """The fields as JSON has them."""
        return {**asdict(self), "verdict": self.verdict.value}


@lru_cache(maxsize=8)  # several sentences are made of one estimate, in several threads
def expectation(estimate: Estimate) -> Expectation | None:
    """Return what to expect of an estimate; None where it has no curve."""
    confidence = estimate.confidence
    if estimate.found is None or confidence is None:
        return None
    away = np.abs(_srgb_stops() - log_light(uniform(estimate.found)))
    distance = mean_over(away, MID_CODES)
    stops = confidence.in_stops
    mid = None if stops is None else float(stops.mid)
    return Expectation(
        confidence.verdict,
        100.0 * float(np.sqrt(np.mean(confidence.sigma**2))),
        mid,
        None if stops is None else float(stops.shadows),
        # Two errors that know nothing of each other: the estimate's, and sRGB's from the estimate.
        float(np.hypot(distance, mid or 0.0)),
        estimate.outcome is not Outcome.ALREADY_LINEAR
        and distance <= _AS_WELL * (mid if mid is not None else 0.05),
    )


@cache
def _srgb_stops() -> Float:
    """(3, 256) light in stops of sRGB."""
    return frozen(log_light(np.tile(decode_srgb(np.linspace(0.0, 1.0, 1024)), (3, 1))))
