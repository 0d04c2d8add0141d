"""How a face was exposed, and what that leaves uncertain.

A verdict speaks of codes 64 to 235. A dark face is seldom as dark as that because of its camera's
curve: it is underexposed, by more than most photos of the training, and its curve is taken for
darker than it is. What a face shows of the midtones tells that from the photo itself.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from facecrf_ocio.response.coverage import COVERAGE_BINS
from facecrf_ocio.response.stops import CODES, MID_CODES
from facecrf_ocio.values import Float

_LEAST_IN_MIDTONES = 0.5
"""Share of the face's pixels. Two and three stops under, of photos with less whose error was told
to be small enough 7 of 15 would be called reliable rightly (rendered heads and real linear photos,
responses held out), of heads with more 7 of 9."""
_DARK_STRETCH = 1.4
"""Of deviations. On dark faces of 75 rendered heads and 60 real photos, two and three stops under,
0.109 and 0.107 stops were told over codes 64 to 235 in the mean, and 0.122 and 0.218 were true; the
band of 90 % covered 84 and 69 % of the codes, and covers 94 and 85 %."""


def doubts_of_exposure(coverages: Sequence[Float]) -> tuple[str, ...]:
    """A doubt where no photo has half of its face at codes 64 to 235, of which a verdict speaks.

    Parameters
    ----------
    coverages
        (3, 64) share of each photo's evidence in each bin of encoded values.
    """
    dark, midtones, bright = max(map(_shares, coverages), key=lambda three: three[1])
    if midtones >= _LEAST_IN_MIDTONES or not dark + bright:
        return ()
    if dark > bright:
        return (f"the face is dark: {100 * dark:.0f} % of it below code {MID_CODES[0]}",)
    return (f"the face is bright: {100 * bright:.0f} % of it above code {MID_CODES[1]}",)


def stretch_of_exposure(coverage: Float) -> float:
    """Factor on the deviation of what a photo's evidence (3, 64) leaves: above 1 for dark faces."""
    dark, midtones, bright = _shares(coverage)
    return _DARK_STRETCH if midtones < _LEAST_IN_MIDTONES and dark > bright else 1.0


def _shares(coverage: Float) -> tuple[float, float, float]:
    """Of the evidence (3, 64) below, at, and above codes 64 to 235; zeros where none is known."""
    low, high = (int(code * COVERAGE_BINS / len(CODES)) for code in MID_CODES)
    whole = max(float(coverage.sum()), 1e-12)
    below, at, above = np.split(coverage.sum(axis=0) / whole, (low, high + 1))
    return float(below.sum()), float(at.sum()), float(above.sum())
