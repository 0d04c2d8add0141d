"""What a user may ask of an estimate, and the words in which its confidence is told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from facecrf_ocio.record.demand import Demand, demand
from facecrf_ocio.values import Confidence, Estimate, InStops, InverseCRF, Outcome, Verdict
from facecrf_ocio.wording.trust_words import trust_phrase, trust_sentences

CODES = np.linspace(0.0, 1.0, 256)
TOLD = Confidence(
    np.full((3, 256), 0.01), np.ones((3, 256)), Verdict.RELIABLE, ("a reason",),
    InStops(np.full((3, 256), 0.1), 0.084, 0.213), 0.97, ("grain",),
)  # fmt: skip


def estimate(**changes):
    curve = InverseCRF(CODES, np.tile(CODES, (3, 1)))
    told = replace(TOLD, **changes)
    return Estimate(Outcome.CALIBRATED, "joint", "1 photo", found=curve, confidence=told)


@pytest.mark.parametrize(
    ("least", "met"),
    [
        (Demand(), True),
        (Demand("reliable"), True),
        (Demand(max_error=0.09), True),
        (Demand("reliable", 0.084), True),
        (Demand(max_error=0.08), False),
    ],
)
def test_the_expected_error_must_not_be_above_what_is_asked(least, met):
    given = estimate()
    assert (demand(given, least) is given) is met


def test_a_refusal_says_what_is_missing_and_what_is_known():
    refused = demand(estimate(), Demand(max_error=0.05))
    assert refused.outcome is Outcome.NOT_CALIBRATED
    assert refused.reason.startswith(
        "the expected error is above the 0.05 stops asked for (expected error 0.08 stops"
    )
    assert "0.21 in the shadows" in refused.reason


def test_an_error_that_is_not_known_is_not_below_anything():
    refused = demand(estimate(in_stops=None), Demand(max_error=1.0))
    assert refused.reason.startswith("the expected error is not known to be within the 1 st")


def test_a_verdict_is_demanded_as_before():
    refused = demand(estimate(verdict=Verdict.WEAK), Demand("reliable"))
    assert refused.reason.startswith("the estimate is weak, and reliable was asked for")


def test_the_expected_error_comes_first_and_srgb_is_a_statement_of_its_own():
    first, second, third, fourth = trust_sentences(TOLD)
    assert first.startswith("expected error 0.08 stops over codes 64 to 235, 0.21 in the shadows")
    assert second == (
        "the curve differs from sRGB: of the curves that the photo leaves possible, 97 % are "
        "nearer to it than to sRGB"
    )
    assert third == "grain contradicts the other evidence and counts less"
    assert fourth == "a reason"
    assert "the curve may be sRGB" in trust_sentences(replace(TOLD, nearer_than_srgb=0.4))[1]


def test_nothing_is_said_of_what_is_not_known():
    older = replace(TOLD, in_stops=None, nearer_than_srgb=None, outvoted=())
    assert trust_sentences(older) == ("a reason",)
    assert older.differs_from_srgb is None
    assert trust_phrase(older) == "reliable"


def test_the_phrase_has_the_error_with_the_verdict():
    assert trust_phrase(TOLD) == "reliable, ± 0.08 stops"
    assert trust_phrase(replace(TOLD, verdict=Verdict.PRIOR_ONLY)) == "prior only"
