"""Whether what varies from pixel to pixel is a sensor's noise.

Photon noise is independent in each channel and pixel, and nearly Gaussian. The texture of what is
seen is shared by the channels, is coarser than a pixel, and has heavier tails; demosaicing, scaling
and JPEG each leave another pattern. A sum of noise (`grain.py`) tells the root of light
only as far as it is noise.
"""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.joint.grain import (
    NARROWEST,
    Codes,
    Differences,
    counted,
    histogram,
    quantile,
    second_differences,
)
from facecrf_ocio.values import Float

HalfSize = npt.NDArray[np.uint16]

GROUPS = 6
SIZE = 5 * GROUPS + 2
_PAIRS = ((0, 1), (1, 2), (0, 2))
_LOW, _HIGH = 0.3, 0.8
_NORMAL_TAIL = 1.2017  # log of the ratio of these quantiles of a normal deviate's absolute value
_ROUNDING = 0.25
_FEW_PAIRS, _FEW = 100.0, 300.0


def noise_character(samples: Sequence[Codes]) -> Float:
    """How noise of each brightness differs from independent Gaussian noise.

    Parameters
    ----------
    samples
        Of a photo, as `grain.sample_codes` takes them.

    Returns
    -------
    Float
        (5 G + 2,) for G groups of level: agreement in sign of the channels' second differences, as
        stored (G) and at half the size (G); how much pairs of channels differ in it at either size
        (2); logarithm of the upper by the lower quantile less that of a normal deviate, at either
        size (2 G); logarithm of the deviation at half the size, which is 0 for independent noise
        (G). Levels that are not seen have zeros.
    """
    agreement, pairs = np.zeros((2, len(_PAIRS), GROUPS)), np.zeros((2, len(_PAIRS), GROUPS))
    histograms = np.zeros((2, GROUPS, 1024))
    for codes in samples:
        seen: tuple[tuple[Codes | HalfSize, int], ...] = ((codes, 255), (_halved(codes), 1020))
        for size, (pixels, white) in enumerate(seen):
            if min(pixels.shape[:2]) < NARROWEST:
                continue
            channels = np.ascontiguousarray(np.moveaxis(pixels, 2, 0))
            planes = [second_differences(channel, white, GROUPS) for channel in channels]
            for number, (one, other) in enumerate(_PAIRS):
                agree, compared = _agreement(planes[one], planes[other], planes[1])
                agreement[size, number] += agree
                pairs[size, number] += compared
            for plane in planes:
                histograms[size] += histogram(plane, GROUPS, 1 + size)
    shared = agreement / (pairs + _FEW_PAIRS)
    counts = histograms.sum(axis=2)
    trust = counts / (counts + _FEW)
    low, high = (_log_quantiles(histograms, share) for share in (_LOW, _HIGH))
    tails = (high - low - _NORMAL_TAIL) * trust
    coarser = (low[1] - low[0]) * trust[1]
    spread = shared.std(axis=1).mean(axis=1)
    return np.concatenate([shared.mean(axis=1).ravel(), spread, tails.ravel(), coarser])


def _halved(codes: Codes) -> HalfSize:
    """Sums of two by two pixels: the means of four times their values."""
    height, width = codes.shape[0] // 2, codes.shape[1] // 2
    whole = codes[: 2 * height, : 2 * width].astype(np.uint16) * np.uint16(4)
    return np.asarray(cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA), np.uint16)


def _agreement(one: Differences, other: Differences, green: Differences) -> tuple[Float, Float]:
    """(G,) sum of the products of the signs by level of green, and the number of products."""
    chosen = one.unclipped & other.unclipped & (one.residue != 0) & (other.residue != 0)
    opposed = (one.residue < 0) ^ (other.residue < 0)
    cells = green.level + np.uint8(GROUPS) * opposed
    same, opposite = counted(cells, chosen, 2 * GROUPS).reshape(2, GROUPS)
    return same - opposite, same + opposite


def _log_quantiles(histograms: Float, share: float) -> Float:
    """(2, G) logarithms of quantiles in codes, rounding added."""
    return np.array(
        [[np.log(quantile(row, share) + _ROUNDING) for row in rows] for rows in histograms]
    )
