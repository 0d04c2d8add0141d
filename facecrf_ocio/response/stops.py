"""Errors in stops: what users feel of a curve, once the one free factor is taken out.

Linear light is relative, so one factor, common to all channels, is free. It is taken out at
mid-gray; what is left is |log2(estimate / truth)| at each 8-bit code.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.values import Float, Index, InverseCRF

CODES = np.arange(256)  # [8-bit code]
MID_GRAY = 128  # [8-bit code] where the one free factor is taken out
# From the upper shadows to where a shoulder begins: what a compositor grades by. Video's legal
# white, 235, is the end, because most photos show too little above it to tell, or to care.
MID_CODES = (64, 235)
# Where decoding as sRGB goes wrong most; below code 16 one code is a tenth of a stop or more.
SHADOW_CODES = (16, 64)
# Light is told apart down to so many stops below mid-gray: a 14-bit sensor's last count lies about
# there. Darker light, zero among it, counts as this.
DARKEST = -12.0
# Standard deviations on either side that hold 90 % of a Gaussian.
NINETY_PERCENT = 1.645


@dataclass(frozen=True, slots=True)
class StopsError:
    """Mean |log2(estimate / truth)| over codes and channels, in stops.

    Attributes
    ----------
    mid, shadows
        Over codes 64 to 235, and 16 to 64, both ends included.
    used
        Over the codes that the photo uses, as often as it does; None if it has none between 0 and
        255, or was not asked for.
    """

    mid: float
    shadows: float
    used: float | None = None


def log_light(curves: Float) -> Float:
    """Light in stops relative to mid-gray.

    Parameters
    ----------
    curves
        (..., C, K) never decreasing linear light of C channels at uniform encoded values from 0 to
        1, or (K,) of one.

    Returns
    -------
    numpy.ndarray
        (..., C, 256) log2 of light at each 8-bit code over that at code 128, whose geometric mean
        over the channels is the one factor taken out; nowhere below `DARKEST`.
    """
    return stops_of_light(_at_codes(np.asarray(curves, dtype=np.float64)))


def stops_of_light(light: Float) -> Float:
    """As `log_light`, of light at each 8-bit code, (..., C, 256) of C channels or (256,) of one."""
    tiny = np.finfo(np.float64).tiny
    stops = np.log2(np.maximum(light, tiny))
    middle = stops[..., MID_GRAY]
    if stops.ndim > 1:
        middle = middle.mean(axis=-1, keepdims=True)
    return np.asarray(np.maximum(stops - middle[..., None], DARKEST))


def stops_error(
    estimate: Float, truth: Float, counts: npt.NDArray[np.number[Any]] | None = None
) -> StopsError:
    """Compare curves in stops.

    Parameters
    ----------
    estimate, truth
        (C, K) or (K,) as `log_light` takes them; K may differ.
    counts
        (C, 256) or (256,) pixels of the photo at each code. Those at codes 0 and 255 are left out:
        they are clipped.
    """
    error = np.abs(log_light(estimate) - log_light(truth))
    used = None
    if counts is not None:
        weights = np.broadcast_to(np.asarray(counts, dtype=np.float64), error.shape)[..., 1:-1]
        total = float(weights.sum())
        used = float((weights * error[..., 1:-1]).sum()) / total if total > 0 else None
    return StopsError(mean_over(error, MID_CODES), mean_over(error, SHADOW_CODES), used)


def mean_over(values: Float, span: tuple[int, int]) -> float:
    """Mean of values (..., 256) over the codes of a span, ends included, and everything else."""
    return float(values[..., span[0] : span[1] + 1].mean())


def uniform(curve: InverseCRF) -> Float:
    """(3, K) samples of a curve at uniform encoded values, as `log_light` takes them."""
    grid = np.linspace(0.0, 1.0, max(curve.encoded.size, CODES.size))
    if np.array_equal(grid, curve.encoded):
        return curve.linear
    return np.array([np.interp(grid, curve.encoded, row) for row in curve.linear])


def _at_codes(curves: Float) -> Float:
    """(..., K) linear between samples, as LUTs are read, to (..., 256)."""
    below, share = places_of_codes(curves.shape[-1])
    return np.asarray((1.0 - share) * curves[..., below] + share * curves[..., below + 1])


def places_of_codes(size: int) -> tuple[Index, Float]:
    """Which sample of so many lies before each 8-bit code, and the share of the next one in it.

    Each is (256,). Raises SettingsError for fewer than two samples.
    """
    if size < 2:
        raise SettingsError("a curve needs two samples or more to be compared in stops")
    place = CODES / CODES[-1] * (size - 1)
    below = np.minimum(place.astype(np.intp), size - 2)
    return below, place - below
