"""Curves with their bands, as few numbers as a small picture needs."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.response.expected_stops import expected_of_sigma
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model
from facecrf_ocio.response.stops import CODES, NINETY_PERCENT, log_light, uniform
from facecrf_ocio.values import CHANNELS, Float, InStops, InverseCRF

SAMPLES = 33
"""Points of a drawn curve, at uniform code values."""

STOPS_RANGE = 8.0
"""[stop] Beyond this from sRGB no curve is drawn."""

_FULL = 65535  # the largest of 16 bits: 1 of a curve, which a drawing shows to a thousandth


@dataclass(frozen=True, slots=True)
class DrawnCurve:
    """A curve as the page has it.

    Attributes
    ----------
    text
        Base64 of little-endian uint16: of each channel `SAMPLES` values of relative linear light
        and as many half widths of the 90 % band, 65,535 for 1; then stops above sRGB, equal at code
        128, from 0 for -`STOPS_RANGE` to 65,535 for `STOPS_RANGE`, and half widths of the band in
        stops, 65,535 for `STOPS_RANGE`. One channel if all are alike.
    band
        Half width of the 90 % band, the mean over code values and channels, times 100.
    """

    text: str
    band: float


def drawn(curve: InverseCRF, sigma: Float, in_stops: InStops | None = None) -> DrawnCurve:
    """Sample a curve.

    Parameters
    ----------
    curve
        Any curve.
    sigma
        (3, K) standard deviation of `curve.linear`.
    in_stops
        The same in stops; to first order that of `sigma` where it is not known.
    """
    told = in_stops or expected_of_sigma(curve, sigma)
    codes = np.linspace(0.0, 1.0, SAMPLES)
    half = NINETY_PERCENT * np.nan_to_num(np.asarray(sigma, np.float64))
    rows = np.stack(
        [
            [np.interp(codes, curve.encoded, channel) for channel in curve.linear],
            [np.interp(codes, curve.encoded, channel) for channel in half],
            [np.interp(codes, CODES / CODES[-1], channel) for channel in _above_srgb(curve)],
            [
                np.interp(codes, CODES / CODES[-1], NINETY_PERCENT / STOPS_RANGE * channel)
                for channel in told.sigma
            ],
        ],
        axis=1,
    )
    if (rows == rows[:1]).all():
        rows = rows[:1]
    whole = np.rint(np.clip(rows, 0.0, 1.0) * _FULL).astype("<u2")
    text = base64.b64encode(whole.tobytes()).decode()
    return DrawnCurve(text, round(100.0 * float(half.mean()), 2))


def _above_srgb(curve: InverseCRF) -> Float:
    """(3, 256) stops above sRGB, as a share of the range that is stored."""
    srgb = log_light(fixed_curve("srgb", CODES / CODES[-1], dorf_model()))
    return 0.5 + (log_light(uniform(curve)) - srgb) / (2.0 * STOPS_RANGE)


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
