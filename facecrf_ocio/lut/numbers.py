"""Whether a LUT holds numbers alone, once OpenColorIO has read it.

A file without NaN may become one with them, such as a shaper of .csp with an input twice.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import PyOpenColorIO as ocio  # noqa: N813


def is_of_numbers(processor: Any) -> bool:
    """Whether all steps of a LUT hold numbers, as OpenColorIO reads them."""
    return not any(_is_broken(part) for part in processor.createGroupTransform())


def _is_broken(part: Any) -> bool:
    """Whether a step of a transform holds what is no number, where a finite code may meet it."""
    if isinstance(part, ocio.MatrixTransform):
        return not np.isfinite([*part.getMatrix(), *part.getOffset()]).all()
    if not hasattr(part, "getData"):
        return False
    table = part.getData()
    if np.isfinite(table).all():
        return False
    if not (isinstance(part, ocio.Lut1DTransform) and part.getInputHalfDomain()):
        return True
    # An entry for each half float: what is infinite or NaN of the input may be so of the output,
    # and light beyond 1 may go to infinity.
    light = np.arange(65536, dtype=np.uint16).view(np.float16)
    entries = np.reshape(table, (light.size, -1))
    codes = (light >= 0) & (light <= 1)
    return bool(np.isnan(entries[np.isfinite(light)]).any() or np.isinf(entries[codes]).any())
