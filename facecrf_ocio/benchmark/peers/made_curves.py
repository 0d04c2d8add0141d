"""Responses to measure with that neither ours nor a peer was fitted to: made by formula."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.response.model import CURVE_SIZE, inverse_crf, strictly_increasing
from facecrf_ocio.values import CHANNELS, Float, InverseCRF

_LIGHT = np.linspace(0.0, 1.0, 1 << 16)  # fine enough for the steep foot of a power


def made_curves() -> dict[str, InverseCRF]:
    """Powers, BT.709, and sRGB with more and with less contrast, and with a shoulder."""
    return {
        "gamma 1.8": _inverse(lambda light: light ** (1 / 1.8)),
        "gamma 2.6": _inverse(lambda light: light ** (1 / 2.6)),
        "BT.709": _inverse(_bt709),
        "sRGB, more contrast": _inverse(lambda light: _contrast(_srgb(light), 0.5)),
        "sRGB, less contrast": _inverse(lambda light: _contrast(_srgb(light), -0.25)),
        "sRGB after a shoulder": _inverse(lambda light: _srgb(1.3 * light / (light + 0.3))),
    }


def some_of(path: Path, most: int) -> list[InverseCRF]:
    """Responses of a file, at even distances in it, `most` at most."""
    inverse = read_responses(path).inverse
    places = np.unique(np.linspace(0, len(inverse) - 1, most).astype(np.intp))
    return [inverse_crf(np.linspace(0.0, 1.0, inverse.shape[2]), inverse[k]) for k in places]


def _inverse(response: Callable[[Float], Float]) -> InverseCRF:
    encoded = np.linspace(0.0, 1.0, CURVE_SIZE)
    row = np.interp(encoded, response(_LIGHT), _LIGHT)
    return InverseCRF(encoded, strictly_increasing(np.array([row] * len(CHANNELS))))


def _srgb(light: Float) -> Float:
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def _bt709(light: Float) -> Float:
    return np.where(light < 0.018, 4.5 * light, 1.099 * light**0.45 - 0.099)


def _contrast(encoded: Float, amount: float) -> Float:
    """An S about the middle; its slope there is 1 + amount / 2."""
    smooth = encoded * encoded * (3.0 - 2.0 * encoded)
    return (1.0 - amount) * encoded + amount * smooth
