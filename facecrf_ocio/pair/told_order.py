"""Exposures in an order that photos deny: with all signs exchanged, points agree on a curve too."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from facecrf_ocio.pair.exposure_fit import FEWEST_SHARED
from facecrf_ocio.values import Bool, Float

# By judgment: steps of a third and points that glare lifts brought true brackets to -2.4 codes.
_TOLD_APART = 0.5  # [stop]
_DARKER = 4.0  # [code value] in the median


def out_of_order(codes: Float, clear: Bool, given: Float) -> str:
    """Return what is wrong where a photo is darker than one that is told as exposed less.

    Parameters
    ----------
    codes, clear
        (J, N, 3) code values, and (J, N) which of them are to be used.
    given
        (J,) [stop] exposures.
    """
    means = codes.mean(axis=2)
    for less, more in combinations(np.argsort(given, kind="stable"), 2):
        both = clear[less] & clear[more]
        if given[more] - given[less] < _TOLD_APART or both.sum() < FEWEST_SHARED:
            continue
        if np.median((means[more] - means[less])[both]) < -_DARKER:
            return (
                "photos that are told as exposed more are darker than others: check the order and "
                "the signs of the exposures (--stops)"
            )
    return ""
