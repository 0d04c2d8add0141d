"""What a user does next with a result, as a short list."""

from __future__ import annotations

from facecrf_ocio.values import Estimate, Outcome, Verdict
from facecrf_ocio.wording.expectation import expectation
from facecrf_ocio.wording.sentence import ANYWHERE, Surface, remedy, surer_by


def next_steps(estimate: Estimate, surface: Surface = ANYWHERE) -> tuple[str, ...]:
    """Return what can be done now, the most useful first."""
    if estimate.outcome is Outcome.ALREADY_LINEAR:
        return ("Use the pixels as they are.",)
    expected = expectation(estimate)
    if expected is None:
        return (_sentence(remedy(estimate, surface)),)
    steps = [f"Apply it: {surface.apply}."]
    if expected.verdict is not Verdict.RELIABLE and estimate.outcome is not Outcome.NAMED:
        if expected.srgb_does_as_well:
            steps.append("Or decode the photo as sRGB, which would do as well.")
        first, *others = surer_by(estimate, surface)
        steps.append(f"Make it surer: {first}.")
        steps += [f"Or measure the camera: {other}." for other in others]
    return tuple(steps)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}." if text else "Nothing can be done with this file."
