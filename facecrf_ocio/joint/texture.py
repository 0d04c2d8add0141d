"""Whether what varies from pixel to pixel is a sensor's noise.

Photon noise is independent in each channel and pixel, and nearly Gaussian. The texture of what is
seen is shared by the channels, is coarser than a pixel, and has heavier tails; demosaicing, scaling
and JPEG each leave another pattern. A sum of noise (`grain.py`) tells the root of light
only as far as it is noise.
"""

from __future__ import annotations

import numpy as np

from facecrf_ocio.joint.noise_counts import ROUNDING, NoiseCounts, quantile
from facecrf_ocio.values import Float

GROUPS = 6
_LOW, _HIGH = 0.3, 0.8
_NORMAL_TAIL = 1.2017  # log of the ratio of these quantiles of a normal deviate's absolute value
_FEW_PAIRS, _FEW = 100.0, 300.0


def noise_character(counts: NoiseCounts) -> Float:
    """How noise of each brightness differs from independent Gaussian noise.

    Returns
    -------
    Float
        (5 G + 2,) for G groups of level: agreement in sign of the channels' second differences, as
        stored (G) and at half the size (G); how much pairs of channels differ in it at either size
        (2); logarithm of the upper by the lower quantile less that of a normal deviate, at either
        size (2 G); logarithm of the deviation at half the size, which is 0 for independent noise
        (G). Levels that are not seen have zeros.
    """
    same, opposite = (_grouped(signs) for signs in (counts.same, counts.opposite))
    shared = (same - opposite) / (same + opposite + _FEW_PAIRS)
    histograms = _grouped(counts.histograms).sum(axis=1)
    seen = histograms.sum(axis=2)
    trust = seen / (seen + _FEW)
    low, high = (_log_quantiles(histograms, share) for share in (_LOW, _HIGH))
    tails = (high - low - _NORMAL_TAIL) * trust
    coarser = (low[1] - low[0]) * trust[1]
    spread = shared.std(axis=1).mean(axis=1)
    return np.concatenate([shared.mean(axis=1).ravel(), spread, tails.ravel(), coarser])


def _grouped(by_level: Float) -> Float:
    """Counts of (2, 3, L, ...) as (2, 3, G, ...)."""
    grouped = by_level.reshape(*by_level.shape[:2], GROUPS, -1, *by_level.shape[3:])
    return np.asarray(grouped.sum(axis=3))


def _log_quantiles(histograms: Float, share: float) -> Float:
    """(2, G) logarithms of quantiles in codes, rounding added."""
    return np.array(
        [[np.log(quantile(row, share) + ROUNDING) for row in rows] for rows in histograms]
    )
