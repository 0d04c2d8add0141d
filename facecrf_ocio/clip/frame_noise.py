"""Noise against level, from frames that follow one another: what differs there is noise.

One photo's noise cannot be told from its texture; two frames' difference holds none, but for what
moved by part of a pixel. Blocks are found in the next frame by optical flow, in whole pixels, so
that nothing is interpolated, which would smooth the noise away.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.color.primaries import LUMINANCE
from facecrf_ocio.values import Float

_BLOCK = 8  # [px] side of a block, as encoders have them
_FLOW_SIDE = 960  # [px] longest side of frames in which flow is sought: larger ones take long
_MOST = 20_000  # blocks of a pair; more tell the same again
_CLIPPED = (3.0, 252.0)  # [code value] beyond which a curve's ends or clipping take noise away
# Orders (sum of both indices of the cosine transform) that count: lower ones hold what moved by
# part of a pixel, and the highest are the first that encoders drop.
_FINE, _FINEST = 4, 8
_WIDTH = 12.0  # [code value] of a level
# [noise variance] Fine structure that both frames show beyond noise, up to which a block counts as
# flat: of it, what moved by part of a pixel would be taken for noise. Of 0.1 to 1, and of the
# flattest halves of levels by all structure, it left the levels nearest to a straight line.
_FLAT = 0.3
_FEWEST = 40  # blocks of a level that tell anything

Image = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class NoiseLevels:
    """Noise of the luminance at levels of code values.

    Attributes
    ----------
    codes
        (B, 3) mean encoded values of the blocks of a level, [0, 1].
    variance
        (B,) [squared 8-bit code value] of a pixel's luminance in one frame, by fine structure.
    blocks
        (B,) how many blocks it was taken from.
    finest
        (B,) variance of the finest structure over that: 1 for noise that no encoder touched, near
        0 where it was dropped.
    """

    codes: Float
    variance: Float
    blocks: Float
    finest: Float


def noise_levels(pairs: Iterable[tuple[Image, Image]]) -> NoiseLevels:
    """Noise at all levels that flat blocks show, of pairs of frames (H, W, 3) in [0, 1]."""
    parts = [_differences(*pair) for pair in pairs]
    means = np.concatenate([np.zeros((0, 3)), *(part[0] for part in parts)])
    fine, finest, rough = (
        np.concatenate([np.zeros(0), *(part[index] for part in parts)]) for index in (1, 2, 3)
    )
    level = (means @ LUMINANCE / _WIDTH).astype(np.intp)
    rows = []
    for one in np.unique(level):
        inside = np.flatnonzero(level == one)
        if len(inside) < _FEWEST:
            continue
        # Medians: a block whose content moved otherwise than the flow says is no noise.
        flat = inside[rough[inside] < _FLAT * float(np.median(fine[inside]))]
        if len(flat) < _FEWEST:
            continue
        variance = max(float(np.median(fine[flat])), 1e-9)
        share = float(np.median(finest[flat])) / variance
        rows.append((*means[flat].mean(axis=0) / 255.0, variance, len(flat), share))
    table = np.array(rows).reshape(-1, 6)
    return NoiseLevels(table[:, :3], table[:, 3], table[:, 4], table[:, 5])


def _differences(first: Image, second: Image) -> tuple[Float, Float, Float, Float]:
    """Of each block: mean codes (N, 3), variances (N,) of fine and finest noise, and texture."""
    down, right = first.shape[0] // _BLOCK * _BLOCK, first.shape[1] // _BLOCK * _BLOCK
    top, left = (axis.ravel() for axis in np.mgrid[:down:_BLOCK, :right:_BLOCK])
    moved = _moved(first, second)[top + _BLOCK // 2, left + _BLOCK // 2]
    below, beside = top + moved[:, 1], left + moved[:, 0]
    inside = (below >= 0) & (beside >= 0)
    inside &= (below + _BLOCK <= first.shape[0]) & (beside + _BLOCK <= first.shape[1])
    kept = np.flatnonzero(inside)
    kept = kept[:: max(1, -(-len(kept) // _MOST))]
    one = _blocks(first, top[kept], left[kept])
    other = _blocks(second, below[kept], beside[kept])
    both = np.stack([one, other])
    seen = (both.min(axis=(0, 2, 3, 4)) > _CLIPPED[0]) & (both.max(axis=(0, 2, 3, 4)) < _CLIPPED[1])
    one, other = one[seen], other[seen]
    cosine = _cosine()
    weights = LUMINANCE.astype(np.float32)
    apart = (cosine @ ((other - one) @ weights) @ cosine.T) ** 2 / 2.0
    shown = (cosine @ ((other + one) @ weights / 2.0) @ cosine.T) ** 2
    order = np.add.outer(np.arange(_BLOCK), np.arange(_BLOCK))
    fine = apart[:, order >= _FINE].mean(axis=1)
    finest = apart[:, order >= _FINEST].mean(axis=1)
    # What both frames show less the noise that is left in their mean.
    rough = shown[:, order >= _FINE].mean(axis=1) - fine / 2.0
    means = (one.mean(axis=(1, 2)) + other.mean(axis=(1, 2))) / 2.0
    return means.astype(np.float64), fine, finest, rough


def _blocks(frame: Image, top: npt.NDArray[np.intp], left: npt.NDArray[np.intp]) -> Image:
    """(N, 8, 8, 3) code values at these places."""
    step = np.arange(_BLOCK)
    cut = frame[(top[:, None] + step)[:, :, None], (left[:, None] + step)[:, None, :]]
    return np.asarray(255.0 * cut, np.float32)


def _moved(first: Image, second: Image) -> npt.NDArray[np.intp]:
    """(H, W, 2) whole pixels by which what the first frame shows lies elsewhere in the second."""
    height, width = first.shape[:2]
    scale = min(1.0, _FLOW_SIDE / max(height, width))
    size = (max(1, round(scale * width)), max(1, round(scale * height)))
    flow = cv2.DISOpticalFlow.create(cv2.DISOPTICAL_FLOW_PRESET_FAST)
    start = np.zeros((size[1], size[0], 2), np.float32)
    found = flow.calc(_equalized(first, size), _equalized(second, size), start)
    if scale < 1.0:
        found = cv2.resize(found, (width, height), interpolation=cv2.INTER_LINEAR) / scale
    return np.rint(found).astype(np.intp)


def _equalized(frame: Image, size: tuple[int, int]) -> npt.NDArray[np.uint8]:
    gray = cv2.cvtColor(np.ascontiguousarray(frame), cv2.COLOR_RGB2GRAY)
    small = cv2.resize(gray, size, interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.equalizeHist(np.rint(255.0 * np.clip(small, 0.0, 1.0)).astype(np.uint8)))


def _cosine() -> Image:
    """(8, 8) orthonormal matrix of the cosine transform."""
    rows = [cv2.dct(one[:, None])[:, 0] for one in np.eye(_BLOCK, dtype=np.float32)]
    return np.asarray(np.stack(rows, axis=1), np.float32)
