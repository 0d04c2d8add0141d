"""Curves that a file may name: exact by the standards of signals, with what their light is."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from facecrf_ocio.color.signals import decode_film_scan, decode_hlg, decode_log, decode_pq
from facecrf_ocio.values import Float, InverseCRF

_UNGRADED = "the scene's only if nobody graded the picture"
# Curves that a file may name, by whom they are defined, and what their light is. The logarithms
# (code points 9 and 10) reach over 2 and 2.5 decades.
_CURVES: dict[str, tuple[Callable[[Float], Float], str, str]] = {
    "PQ": (
        decode_pq,
        "ITU-R BT.2100",
        "a display's, after grading, and not proven to be the scene's",
    ),
    "HLG": (decode_hlg, "ITU-R BT.2100", _UNGRADED),
    "log 100:1": (partial(decode_log, decades=2.0), "ITU-T H.273", _UNGRADED),
    "log 316:1": (partial(decode_log, decades=2.5), "ITU-T H.273", _UNGRADED),
    "Cineon log": (
        decode_film_scan,
        "Kodak, 1995",
        "the scene's by a straight line for all films, bent where theirs are, if nobody graded it",
    ),
}
_SIZE = 4096
"""Samples of such a curve: linear between them, PQ is met within 0.2 % from code 16 of 255 on."""


def signal_curve(name: str) -> tuple[InverseCRF, str, str]:
    """Return the curve of a name that `Photo.named_curve` may hold, who defines it, and its light.

    Raises
    ------
    KeyError
        If the name is not known, which no reader of photos gives.
    """
    decode, source, light = _CURVES[name]
    encoded = np.linspace(0.0, 1.0, _SIZE)
    # A curve must rise, also where it shows no light yet: by a billionth of white.
    linear = np.maximum(decode(encoded), 1e-9 * encoded)
    linear[0], linear[-1] = 0.0, 1.0  # but for rounding
    return InverseCRF(encoded, np.tile(linear, (3, 1))), source, light
