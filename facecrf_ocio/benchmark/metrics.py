"""How far an estimated inverse response lies from the true one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Confidence, Float, InverseCRF

NINETY_PERCENT = 1.645  # standard deviations on either side that hold 90 % of a Gaussian


@dataclass(frozen=True, slots=True)
class Score:
    """Errors of one estimate.

    Attributes
    ----------
    rmse
        Mean over the channels of `rmse_channels`, as the paper's tables have it.
    rmse_channels
        Root mean square of estimated less true linear light on 1,024 uniform encoded values.
    rmse_scaled
        The same after the one scale, common to all channels, that fits the truth best.
    stops
        Median over the photo's pixels of |log2(estimated / true)|, after its median, one scale of
        exposure for all channels, is taken off; pixels at the lowest or highest code are left out.
        None where no pixel lies between.
    band_coverage
        Share of the inner 1,022 encoded values and three channels where the error is less than
        1.645 sigma: 0.9 if the confidence is honest. None where the estimate has no confidence.
    """

    rmse: float
    rmse_channels: tuple[float, float, float]
    rmse_scaled: float
    stops: float | None
    band_coverage: float | None


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
    scale = float((estimated * truth).sum() / (estimated**2).sum())
    scaled = np.sqrt(((scale * estimated - truth) ** 2).mean(axis=1))
    covered = None
    if confidence is not None:
        sigma = _at(grid, curve.encoded, confidence.sigma)
        covered = float((np.abs(estimated - truth) < NINETY_PERCENT * sigma)[:, 1:-1].mean())
    red, green, blue = channels.tolist()
    return Score(
        rmse=float(channels.mean()),
        rmse_channels=(red, green, blue),
        rmse_scaled=float(scaled.mean()),
        stops=error_in_stops(curve, truth, code_counts),
        band_coverage=covered,
    )


def error_in_stops(
    curve: InverseCRF, truth: Float, code_counts: npt.NDArray[np.int64]
) -> float | None:
    """Median error in stops over the photo's unclipped pixels; see `Score.stops`."""
    codes = np.linspace(0.0, 1.0, code_counts.shape[1])
    estimated = _at(codes, curve.encoded, curve.linear)
    true = _at(codes, np.linspace(0.0, 1.0, truth.shape[1]), truth)
    used = (code_counts > 0) & (estimated > 0) & (true > 0)
    used[:, [0, -1]] = False
    if not used.any():
        return None
    weights = code_counts[used]
    stops = np.log2(estimated[used] / true[used])
    return weighted_median(np.abs(stops - weighted_median(stops, weights)), weights)


def weighted_median(values: Float, weights: npt.NDArray[np.int64]) -> float:
    """Lower median of `values`, each taken `weights` times."""
    order = np.argsort(values, kind="stable")
    total = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(total, (total[-1] + 1) // 2)])


def _at(codes: Float, encoded: Float, rows: Float) -> Float:
    return np.array([np.interp(codes, encoded, row) for row in rows])
