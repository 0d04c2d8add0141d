"""The one line that says what can be done with a result: for every surface, from fields alone."""

from __future__ import annotations

from dataclasses import dataclass

from facecrf_ocio.values import Estimate, Outcome, Verdict
from facecrf_ocio.wording.doubts import Remedy, is_bent, lifted_by
from facecrf_ocio.wording.expectation import Expectation, expectation
from facecrf_ocio.wording.trust_words import trust_sentences


@dataclass(frozen=True, slots=True)
class Surface:
    """How a place where results are shown calls what would make them better.

    Attributes
    ----------
    together, pair, raw, larger
        More photos of one camera; a raw file beside the JPEG, or a bracket; the photo's own raw
        file; the original file.
    fallback
        A curve where the photo gives none.
    apply
        How a LUT is put to use.
    """

    together: str
    pair: str
    raw: str
    larger: str
    fallback: str
    apply: str = "load its LUT in your host"


COMMAND_LINE = Surface(
    "`facecrf calibrate --together` with more photos of this camera",
    "`facecrf pair` with a raw file, or `facecrf bracket`",
    "`facecrf pair` with the photo's raw file",
    "the original instead of a small copy",
    "--fallback mean",
    "`facecrf linearize`, or its LUT in your host",
)
ARCHIVE = Surface(
    "`facecrf batch --pool camera` with more photos of this camera",
    "`facecrf pair` with a raw file, or `facecrf bracket`",
    "`facecrf pair` with the photo's raw file",
    "the original instead of a small copy",
    "`facecrf batch --fallback mean`",
    "its LUT in your host, or `facecrf batch --exr`",
)
PYTHON = Surface(
    "calibrate_together(photos) of this camera",
    "calibrate_pair with a raw file, or calibrate_bracket",
    "calibrate_pair with the photo's raw file",
    "the original instead of a small copy",
    'fallback="mean"',
)
ANYWHERE = Surface(
    "more photos of this camera together",
    "a raw file or a bracket of this camera",
    "the photo's raw file beside it",
    "the original instead of a small copy",
    "the mean response instead",
)

# Alike on every surface.
_WORDS = {
    Remedy.ORIGINAL: "the picture as the camera wrote it",
    Remedy.OFF: "photos with that setting off",
    Remedy.PERSON: "a photo of a person",
    Remedy.ONE_CAMERA: "photos of one camera alone",
}
# What would make a measurement surer; photos of the camera would not.
_MEASURED_ANEW = {
    "pair": "another pair, with light and dark areas that are not clipped",
    "bracket": "a longer bracket, of a scene that keeps still",
    "chart": "the chart in even light, its white near code 225",
}
_SAID = {
    Verdict.RELIABLE: "expect",
    Verdict.WEAK: "a first guess: expect",
    Verdict.PRIOR_ONLY: "not this photo's own curve: expect",
}


def sentence(estimate: Estimate, surface: Surface = ANYWHERE) -> str:
    """Return what to expect of a curve and what would make it better; or why there is none."""
    if estimate.outcome in (Outcome.ALREADY_LINEAR, Outcome.NAMED):
        return expected(estimate)
    told = expectation(estimate)
    if told is None:
        return f"{estimate.reason}; {remedy(estimate, surface)}"
    if told.verdict is Verdict.RELIABLE or _says_what_to_do(estimate):
        return expected(estimate)
    return f"{expected(estimate)}; surer: {', or '.join(surer_by(estimate, surface))}"


def surer_by(estimate: Estimate, surface: Surface = ANYWHERE) -> tuple[str, ...]:
    """Return what would make a curve surer, in the words of a surface; the easiest first."""
    anew, doubts = _MEASURED_ANEW.get(estimate.estimator), _doubts(estimate)
    if anew is not None:
        return (_WORDS[Remedy.OFF] if is_bent(doubts) else anew,)
    words = {
        **_WORDS,
        Remedy.TOGETHER: surface.together,
        Remedy.PAIR: surface.pair,
        Remedy.RAW: surface.raw,
    }
    return tuple(" and ".join(words[one] for one in way) for way in lifted_by(doubts))


def expected(estimate: Estimate) -> str:
    """Return what to expect of a curve alone; empty where there is none."""
    if estimate.outcome is Outcome.ALREADY_LINEAR:
        return "linear already: use the pixels as they are"
    if estimate.outcome is Outcome.NAMED:
        return estimate.reason
    told = expectation(estimate)
    if told is None:
        return ""
    fixed = estimate.outcome is Outcome.FALLBACK
    begin = f"{estimate.reason}; expect" if fixed else _SAID[told.verdict]
    return "; ".join([f"{begin} {error_words(told)}", srgb_words(told), *_doubts(estimate)])


def details(estimate: Estimate) -> tuple[str, ...]:
    """Return what the curve rests on, one line each, for those who ask."""
    told = estimate.confidence
    reasons = () if told is None else trust_sentences(told)
    return (estimate.reason, *reasons, *estimate.assumptions)


def remedy(estimate: Estimate, surface: Surface = ANYWHERE) -> str:
    """Return what the user can do where a photo says nothing, in the words of a surface."""
    if estimate.outcome is not Outcome.NOT_CALIBRATED or estimate.estimator in _MEASURED_ANEW:
        return estimate.remedy  # what measures has no fallback
    return ", or ".join(filter(None, (estimate.remedy, surface.fallback)))


def _says_what_to_do(estimate: Estimate) -> bool:
    """Whether a doubt names what is wrong with a measurement, and how it is mended."""
    doubts = _doubts(estimate)
    return bool(doubts) and estimate.estimator in _MEASURED_ANEW and not is_bent(doubts)


def _doubts(estimate: Estimate) -> tuple[str, ...]:
    return () if estimate.confidence is None else estimate.confidence.doubts


def error_words(expected: Expectation) -> str:
    """Return `0.1 stops off in the midtones, 0.4 in the shadows (2 % of white)`."""
    white = f"{percent(expected.white_percent)} of white"
    if expected.mid_stops is None or expected.shadow_stops is None:
        return f"errors about {white}"
    return (
        f"{stops(expected.mid_stops)} off in the midtones, "
        f"{stops(expected.shadow_stops, unit='')} in the shadows ({white})"
    )


def srgb_words(expected: Expectation) -> str:
    """Return whether decoding as sRGB would do as well."""
    if expected.srgb_does_as_well:
        return "sRGB would do as well"
    return f"sRGB would be {stops(expected.srgb_stops)} off"


def stops(value: float, *, unit: str = " stops") -> str:
    """Return an error in stops with as many digits as mean anything."""
    return f"{value:.2f}{unit}" if value < 0.095 else f"{value:.1f}{unit}"


def percent(value: float) -> str:
    """Return an error in percent with as many digits as mean anything."""
    return "less than 1 %" if value < 1.0 else f"{value:.0f} %"
