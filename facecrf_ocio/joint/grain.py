"""Noise against level over a whole photo, which tells the slope of the curve.

The variance of photon noise grows with light, so its deviation in encoded values is the root of
light times the slope of the response. Summed from black, the inverse of that deviation is therefore
the root of linear light up to a factor, exponent and all: what no ratio of skin colors tells
(Takamatsu, Matsushita, Ikeuchi, CVPR 2008, use the same noise in another way).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from facecrf_ocio.joint.noise_counts import ROUNDING, NoiseCounts, quantile
from facecrf_ocio.joint.second_differences import LEVELS
from facecrf_ocio.values import Float, frozen

# Texture reaches the upper quantiles of a second difference first.
_QUANTILE = 0.3
# Pixels of a level that count at all, and that are trusted by half; chosen by judgment.
_FEWEST, _FEW = 30, 150.0
# Weights of the least squares, whose data are log deviations: of a level seen well, of a bend, of a
# slope where nothing is seen, and of an offset. Only ratios mean something. Chosen by judgment;
# the networks were trained with them.
_TRUST, _SMOOTH, _FLAT, _OFFSET = 8.0, 1.0, 0.02, 0.05


@dataclass(frozen=True, slots=True, eq=False)
class NoiseTable:
    """What was measured at each level.

    Attributes
    ----------
    deviation
        (3, L) quantile of the absolute second difference, in 8-bit codes times six; 0 where
        nothing was measured.
    count
        (3, L) pixels that it was taken from.
    """

    deviation: Float
    count: Float

    def __post_init__(self) -> None:
        for name in ("deviation", "count"):
            object.__setattr__(self, name, frozen(getattr(self, name)))


def measure_noise(counts: NoiseCounts, size: int = 0) -> NoiseTable:
    """Noise of each channel at uniform levels of encoded values, clipped pixels left out.

    Parameters
    ----------
    counts
        Of a photo's windows.
    size
        0 as stored, 1 at half the size, 2 at a quarter of it.
    """
    histograms = counts.histograms[size]
    return NoiseTable(quantile(histograms, _QUANTILE), histograms.sum(axis=2))


def noise_curve(table: NoiseTable) -> Float | None:
    """One curve of noise against level from all channels; None where nothing was measured.

    The channels differ by a factor, which is that of their white balance, and each shows other
    levels. Their log deviations are fitted by one smooth curve and two offsets, which also bridges
    levels that no channel shows: a linear least squares problem with 26 unknowns.

    Returns
    -------
    Float
        (3 L + 2,): the mean log deviation; the curve of log deviations less that mean (L); log
        trust in each level (L); offsets of red and blue (2); the sum from black of the inverse
        deviation, as a share of the whole (L - 1).
    """
    trust = np.where(table.count >= _FEWEST, table.count / (table.count + _FEW), 0.0) * _TRUST
    if trust.sum() <= 0.0:
        return None
    measured = np.log(table.deviation + ROUNDING)
    bend, step = (np.diff(np.eye(LEVELS), order, axis=0) for order in (2, 1))
    A = np.zeros((LEVELS + 2, LEVELS + 2))
    A[:LEVELS, :LEVELS] = _SMOOTH * bend.T @ bend + _FLAT * step.T @ step + 1e-6 * np.eye(LEVELS)
    A[LEVELS:, LEVELS:] = _OFFSET * np.eye(2)
    b = np.zeros(LEVELS + 2)
    levels = np.arange(LEVELS)
    for channel, offset in ((0, LEVELS), (1, None), (2, LEVELS + 1)):
        A[levels, levels] += trust[channel]
        b[:LEVELS] += trust[channel] * measured[channel]
        if offset is not None:
            A[levels, offset] += trust[channel]
            A[offset, levels] += trust[channel]
            A[offset, offset] += trust[channel].sum()
            b[offset] += trust[channel] @ measured[channel]
    solution = np.linalg.solve(A, b)
    seen = trust.sum(axis=0)
    mean = float(seen @ solution[:LEVELS] / seen.sum())
    curve = solution[:LEVELS] - mean
    root_of_light = np.cumsum(np.exp(-curve))
    return np.concatenate(
        [
            [mean],
            curve,
            np.log(seen + 0.05),
            solution[LEVELS:],
            root_of_light[:-1] / root_of_light[-1],
        ]
    )
