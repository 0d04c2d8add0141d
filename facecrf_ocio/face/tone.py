"""Brightening of dark copies, for the eyes of detectors only."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

_WHITE_QUANTILE = 0.99  # of the pixels, taken for white
_MIDDLE = 0.4  # code value that the median is brought to
_STRONGEST = 0.25  # least exponent


@dataclass(frozen=True, slots=True)
class Tone:
    """The map v -> min(v / white, 1) ** exponent.

    Attributes
    ----------
    white
        Code value that becomes 1.
    exponent
        At most 1.
    """

    white: float
    exponent: float

    def apply(self, encoded: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        """Brighten (H, W, 3) pixels."""
        scaled = np.clip(encoded * np.float32(1.0 / self.white), 0.0, 1.0)
        return np.asarray(scaled ** np.float32(self.exponent), dtype=np.float32)


def brightening_tone(encoded: npt.NDArray[np.float32]) -> Tone | None:
    """Return the tone that gives a dark (H, W, 3) middle gray and white, None if it has both."""
    level = encoded.max(axis=2)
    white = float(np.quantile(level, _WHITE_QUANTILE))
    if not white > 0.0:
        return None
    middle = float(np.median(level)) / white
    exponent = 1.0
    if middle < _MIDDLE:
        exponent = max(np.log(_MIDDLE) / np.log(max(middle, 1e-6)), _STRONGEST)
    tone = Tone(min(white, 1.0), float(exponent))
    return tone if tone.white < 0.7 or tone.exponent < 0.8 else None
