"""What a user asks of an estimate before anything is written of it."""

from __future__ import annotations

from dataclasses import dataclass

from facecrf_ocio.settings import VERDICTS
from facecrf_ocio.values import Confidence, Estimate, Outcome
from facecrf_ocio.wording.sentence import ANYWHERE, surer_by
from facecrf_ocio.wording.trust_words import trust_sentences


@dataclass(frozen=True, slots=True)
class Demand:
    """The least that is asked.

    Attributes
    ----------
    verdict
        One of `settings.VERDICTS`.
    max_error
        [stop] Expected error over codes 64 to 235; None for any. Where it is not known, it is not
        met.
    """

    verdict: str = VERDICTS[0]
    max_error: float | None = None

    def unmet(self, confidence: Confidence) -> str:
        """What is missing, in words; empty if nothing is."""
        verdict = str(confidence.verdict)
        if VERDICTS.index(verdict) < VERDICTS.index(self.verdict):
            return f"the estimate is {verdict}, and {self.verdict} was asked for"
        told = confidence.in_stops
        if self.max_error is None or (told is not None and told.mid <= self.max_error):
            return ""
        least = f"the {self.max_error:g} stops asked for"
        if told is None:
            return f"the expected error is not known to be within {least}"
        return f"the expected error is above {least}"


def demand(estimate: Estimate, least: Demand) -> Estimate:
    """The estimate, or a refusal where it falls short of the least wanted."""
    if estimate.found is None or estimate.confidence is None:
        return estimate
    unmet = least.unmet(estimate.confidence)
    if not unmet:
        return estimate
    return Estimate(
        Outcome.NOT_CALIBRATED,
        estimate.estimator,
        f"{unmet} ({'; '.join(trust_sentences(estimate.confidence))})",
        f"use {', '.join(_better(estimate))}, or ask for less",
    )


def _better(estimate: Estimate) -> tuple[str, ...]:
    """What to use, where more photos would do; else what lifts the doubts."""
    ways = surer_by(estimate)
    if ANYWHERE.together in ways:
        return ("a larger, unretouched face", "several photos together")
    return ways
