"""What a curve takes for granted, in words that all who find one share."""

from __future__ import annotations

from facecrf_ocio.values import Primaries

RELATIVE_TO_WHITE = "linear light is relative: 1 is what the highest code stands for"
"""Of a curve that was measured, whose end at white is the camera's."""


def primaries_assumed(primaries: Primaries | None) -> str:
    """Which primaries the light is in, which no curve tells."""
    if primaries is None:
        return "primaries are not known and taken as Rec.709 with a D65 white"
    return f"primaries are {primaries.name}, from the {primaries.source}"
