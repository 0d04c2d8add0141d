"""Arrays of a file of weights that are stored as whole steps in bytes, a step for each row."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from facecrf_ocio.values import Float

STEP = "_step"  # ends the name of the steps of an array that is stored in bytes


def exact_array(arrays: Mapping[str, Float], name: str) -> Float:
    """One array of a file of weights, in numbers; some are stored in whole steps."""
    whole = np.asarray(arrays[name], np.float64)
    return whole * arrays[f"{name}{STEP}"] if f"{name}{STEP}" in arrays else whole
