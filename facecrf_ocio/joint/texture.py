"""Whether what varies from pixel to pixel is a sensor's noise.

Photon noise is independent in each channel and pixel, and nearly Gaussian. The texture of what is
seen is shared by the channels, is coarser than a pixel, and has heavier tails; demosaicing,
scaling, sharpening, denoising and JPEG each leave another pattern. A sum of noise (`grain.py`)
tells the root of light only as far as it is noise.
"""

from __future__ import annotations

import numpy as np

from facecrf_ocio.joint.noise_counts import ROUNDING, NoiseCounts, quantile
from facecrf_ocio.values import Float

GROUPS = 6  # of four levels each: agreement in sign needs more pixels than a deviation
_LOW, _HIGH = 0.3, 0.8  # quantiles that texture reaches last, as `grain` takes it, and first
_NORMAL_TAIL = 1.2017  # log of the ratio of these quantiles of a normal deviate's absolute value
_FEW_PAIRS, _FEW = 100.0, 300.0  # pairs, and pixels, that are trusted by half; chosen by judgment


def noise_character(counts: NoiseCounts) -> Float:
    """How noise of each brightness differs from independent Gaussian noise.

    Returns
    -------
    Float
        (14 G + 12,) for G groups of level: agreement in sign of the channels' second differences,
        as stored and at a half and a quarter of the size (3 G); how much pairs of channels differ
        in it at each size (3); logarithm of the upper by the lower quantile less that of a normal
        deviate, at each size (3 G); logarithm of the deviation at the smaller sizes over that as
        stored, which is 0 for independent noise (2 G); that of red and blue over green's as stored
        and at half the size, with the share of pixels that says so (3 + 3 + 3 summed up over all
        levels); agreement in sign of neighbors at three lags (3 G) and of the smallest differences,
        those of rounding, as stored (3 G: of none, of one code at most, of two). Levels that are
        not seen have zeros.
    """
    shared = _agreement(_grouped(counts.pairs))
    histograms = _grouped(np.moveaxis(counts.histograms, -1, 2))
    histograms = np.moveaxis(histograms, 2, -1)
    pooled = histograms.sum(axis=1)
    seen = pooled.sum(axis=2)
    trust = seen / (seen + _FEW)
    low, high = (np.log(quantile(pooled, share) + ROUNDING) for share in (_LOW, _HIGH))
    tails = (high - low - _NORMAL_TAIL) * trust
    coarser = (low[1:] - low[:1]) * trust[1:]
    of_channel = histograms.sum(axis=2)
    deviation = np.log(quantile(of_channel, 0.5) + ROUNDING)
    neighbors = _agreement(_grouped(counts.lags))
    rounding = np.cumsum(pooled[0], axis=1)[:, [0, 6, 12]] / (seen[0][:, None] + _FEW)
    return np.concatenate(
        [
            shared.mean(axis=1).ravel(),
            shared.std(axis=1).mean(axis=1),
            tails.ravel(),
            coarser.ravel(),
            deviation.ravel(),
            neighbors.ravel(),
            rounding.ravel(),
        ]
    )


def _agreement(signs: Float) -> Float:
    """Of (..., 2, G) same and opposite signs, from -1 to 1."""
    same, opposite = signs[..., 0, :], signs[..., 1, :]
    return np.asarray((same - opposite) / (same + opposite + _FEW_PAIRS))


def _grouped(by_level: Float) -> Float:
    """Counts of (..., L) as (..., G)."""
    return np.asarray(by_level.reshape(*by_level.shape[:-1], GROUPS, -1).sum(axis=-1))
