"""Curves with their bands, as few numbers as a small picture needs."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.response.stops import NINETY_PERCENT
from facecrf_ocio.values import CHANNELS, Float, InverseCRF

SAMPLES = 33
"""Points of a drawn curve, at uniform code values."""

_FULL = 65535


@dataclass(frozen=True, slots=True)
class DrawnCurve:
    """A curve as the page has it.

    Attributes
    ----------
    text
        Base64 of little-endian uint16, 65,535 for 1: of each channel `SAMPLES` values of relative
        linear light, then as many half widths of the 90 % band. One channel if all are alike.
    band
        Half width of the 90 % band, the mean over code values and channels, times 100.
    """

    text: str
    band: float


def drawn(curve: InverseCRF, sigma: Float) -> DrawnCurve:
    """Sample a curve.

    Parameters
    ----------
    curve
        Any curve.
    sigma
        (3, K) standard deviation of `curve.linear`.
    """
    codes = np.linspace(0.0, 1.0, SAMPLES)
    half = NINETY_PERCENT * np.nan_to_num(np.asarray(sigma, np.float64))
    rows = np.stack(
        [
            [np.interp(codes, curve.encoded, channel) for channel in curve.linear],
            [np.interp(codes, curve.encoded, channel) for channel in half],
        ],
        axis=1,
    )
    if (rows == rows[:1]).all():
        rows = rows[:1]
    whole = np.rint(np.clip(rows, 0.0, 1.0) * _FULL).astype("<u2")
    text = base64.b64encode(whole.tobytes()).decode()
    return DrawnCurve(text, round(100.0 * float(half.mean()), 2))


def drawn_from_json(text: str) -> DrawnCurve | None:
    """Sample the curve of a camera or bracket as the manifest has it, None if there is none."""
    if not text:
        return None
    try:
        record = json.loads(text)
        encoded = np.array(record["encoded"], np.float64)
        linear, sigma = (_three(record, name, encoded.size) for name in ("linear", "sigma"))
        return drawn(InverseCRF(encoded, linear), sigma)
    except (ValueError, KeyError, TypeError, SettingsError):
        return None  # of another version: its picture is left out


def _three(record: dict[str, Any], name: str, size: int) -> Float:
    values = np.array(record[name], np.float64)
    return np.broadcast_to(values, (len(CHANNELS), size))


def srgb_samples() -> tuple[float, ...]:
    """Linear light of sRGB at the same code values, to compare with."""
    linear = fixed_curve("srgb", np.linspace(0.0, 1.0, SAMPLES), dorf_model())
    return tuple(round(float(value), 4) for value in linear)


class CurveList:
    """Curves without repetition: photos of one camera, or with a fixed curve, share theirs."""

    def __init__(self) -> None:
        self._places: dict[DrawnCurve, int] = {}

    def place(self, curve: DrawnCurve | None) -> int:
        """Index of a curve in the list, where it is put if it is new; -1 for none."""
        return -1 if curve is None else self._places.setdefault(curve, len(self._places))

    @property
    def texts(self) -> tuple[str, ...]:
        """The curves in the order of their indices."""
        return tuple(curve.text for curve in self._places)
