"""What a confidence says, in words: made here, where it is shown, and never parsed."""

from __future__ import annotations

from facecrf_ocio.values import Confidence, Verdict


def trust_sentences(confidence: Confidence) -> tuple[str, ...]:
    """All of it, the expected error in stops first."""
    sentences = [expected_error(confidence), compared_with_srgb(confidence)]
    sentences += [
        f"{name} contradicts the other evidence and counts less" for name in confidence.outvoted
    ]
    return (*filter(None, sentences), *confidence.doubts, *confidence.reasons)


def trust_phrase(confidence: Confidence) -> str:
    """The verdict and what it rests on, short enough for a line of a terminal or a title."""
    told = confidence.in_stops
    if told is None:
        return str(confidence.verdict)
    error = "" if confidence.verdict is Verdict.PRIOR_ONLY else f", ± {told.mid:.2f} stops"
    return f"{confidence.verdict}{error}"


def expected_error(confidence: Confidence) -> str:
    """Empty where it is not known."""
    told = confidence.in_stops
    if told is None:
        return ""
    return (
        f"expected error {told.mid:.2f} stops over codes 64 to 235, {told.shadows:.2f} in the "
        "shadows (codes 16 to 64)"
    )


def compared_with_srgb(confidence: Confidence) -> str:
    """Whether the curve differs from sRGB; empty where that was not asked."""
    share = confidence.nearer_than_srgb
    if share is None:
        return ""
    said = "differs from sRGB" if confidence.differs_from_srgb else "may be sRGB"
    return (
        f"the curve {said}: of the curves that the photo leaves possible, {100.0 * share:.0f} % "
        "are nearer to it than to sRGB"
    )
