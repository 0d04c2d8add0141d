"""How far an estimated inverse response lies from the true one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from facecrf_ocio.response.stops import (
    CODES,
    MID_CODES,
    MID_GRAY,
    NINETY_PERCENT,
    SHADOW_CODES,
    log_light,
    mean_over,
    stops_error,
    uniform,
)
from facecrf_ocio.values import Confidence, Float, InverseCRF


@dataclass(frozen=True, slots=True)
class Score:
    """Errors of one estimate.

    Attributes
    ----------
    mid, shadows, used
        Errors in stops, see `response.stops.StopsError`; `used` is None where all pixels are
        clipped.
    bias_stops
        Mean of log2(estimate / truth) over codes 64 to 235: above 0 where too bright.
    rmse
        Mean over the channels of `rmse_channels`, as the paper's tables have it.
    rmse_channels
        Root mean square of estimated less true linear light on 1,024 uniform encoded values.
    bias
        Mean of estimated less true linear light.
    band_coverage
        Share of the inner 1,022 encoded values and three channels where the error is less than
        1.645 sigma: 0.9 if the confidence is honest. None where the estimate has no confidence.
    band_stops
        The same in stops, over codes 16 to 235 but 128, where there is no error.
    """

    mid: float
    shadows: float
    used: float | None
    bias_stops: float
    rmse: float
    rmse_channels: tuple[float, float, float]
    bias: float
    band_coverage: float | None
    band_stops: float | None


def score(
    curve: InverseCRF,
    confidence: Confidence | None,
    truth: Float,
    code_counts: npt.NDArray[np.int64],
) -> Score:
    """Compare an estimate with the truth.

    Parameters
    ----------
    curve
        The estimate.
    confidence
        Its confidence, if it has one.
    truth
        (3, 1024) linear light at uniform encoded values.
    code_counts
        (3, L) pixels of the photo at each of L uniform code values.
    """
    grid = np.linspace(0.0, 1.0, truth.shape[1])
    estimated = _at(grid, curve.encoded, curve.linear)
    channels = np.sqrt(((estimated - truth) ** 2).mean(axis=1))
    signed = log_light(uniform(curve)) - log_light(truth)
    stops = stops_error(uniform(curve), truth, in_8_bits(code_counts))
    covered = covered_stops = None
    if confidence is not None:
        sigma = _at(grid, curve.encoded, confidence.sigma)
        covered = float((np.abs(estimated - truth) < NINETY_PERCENT * sigma)[:, 1:-1].mean())
        covered_stops = _covered_in_stops(signed, confidence)
    red, green, blue = channels.tolist()
    return Score(
        mid=stops.mid,
        shadows=stops.shadows,
        used=stops.used,
        bias_stops=mean_over(signed, MID_CODES),
        rmse=float(channels.mean()),
        rmse_channels=(red, green, blue),
        bias=float((estimated - truth).mean()),
        band_coverage=covered,
        band_stops=covered_stops,
    )


def in_8_bits(code_counts: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """(3, L) pixels at L uniform code values, counted at the nearest of 256."""
    levels = code_counts.shape[1]
    if levels == CODES.size:
        return code_counts
    nearest = np.rint(np.arange(levels) * (CODES[-1] / (levels - 1))).astype(np.intp)
    rows = [np.bincount(nearest, row, minlength=CODES.size) for row in code_counts]
    return np.array(rows).astype(np.int64)


def _covered_in_stops(signed: Float, confidence: Confidence) -> float | None:
    if confidence.in_stops is None:
        return None
    within = np.abs(signed) < NINETY_PERCENT * confidence.in_stops.sigma
    judged = np.setdiff1d(np.arange(SHADOW_CODES[0], MID_CODES[1] + 1), [MID_GRAY])
    return float(within[:, judged].mean())


def _at(codes: Float, encoded: Float, rows: Float) -> Float:
    return np.array([np.interp(codes, encoded, row) for row in rows])
