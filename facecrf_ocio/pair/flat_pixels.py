"""Which pixels of two aligned pictures tell of the response: flat, unclipped, of every code."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from facecrf_ocio.pair.align import Aligned
from facecrf_ocio.values import Bool, Float

CLIPPED, BLACK = 0.985, 0.012  # [encoded] beyond which a channel may have lost light
_BLUR = 3  # [px] side of the square over which both pictures are averaged
_SHARE_KEPT = 0.5  # of each bin's pixels, the flattest
# Of code values, and samples from each: as many from dark as from bright ones.
_BINS, _PER_BIN = 128, 100


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """What one channel is fitted to.

    Attributes
    ----------
    encoded
        (N,) code values of the channel.
    linear
        (N, 3) linear light of all three channels of the other picture.
    """

    encoded: Float
    linear: Float


def choose_samples(aligned: Aligned) -> tuple[Samples, Samples, Samples]:
    """Samples of each channel, at most 100 for each of 128 ranges of codes.

    Of the flatter half of each range's pixels: where neighbors are alike, a displacement, noise,
    sharpening and demosaicing matter least.
    """
    size = (_BLUR, _BLUR)
    encoded = np.asarray(cv2.blur(aligned.encoded, size), np.float32)
    linear = np.asarray(cv2.blur(aligned.linear, size), np.float32)
    usable = _unclipped(aligned)
    generator = np.random.default_rng(0)

    def of(channel: int) -> Samples:
        rough = _roughness(aligned, channel)
        return _of_channel(encoded[..., channel], linear, usable, rough, generator)

    return of(0), of(1), of(2)


def _unclipped(aligned: Aligned) -> Bool:
    """(H, W) True at which, and beside which, neither picture is clipped."""
    top = float(aligned.linear.max())
    bad = ~aligned.both
    bad |= (aligned.encoded > CLIPPED).any(axis=2)
    bad |= (aligned.linear > 0.98 * top).any(axis=2)
    grown = cv2.dilate(bad.astype(np.uint8), np.ones((_BLUR + 2, _BLUR + 2), np.uint8))
    return np.asarray(grown == 0, np.bool_)


def _roughness(aligned: Aligned, channel: int) -> Float:
    """(H, W) local standard deviation of the encoded values of a channel."""
    plane = aligned.encoded[..., channel].astype(np.float64)
    size = (2 * _BLUR - 1, 2 * _BLUR - 1)
    mean = cv2.blur(plane, size)
    return np.asarray(np.sqrt(np.maximum(cv2.blur(plane * plane, size) - mean * mean, 0.0)))


def _of_channel(
    encoded: Float, linear: Float, usable: Bool, roughness: Float, generator: np.random.Generator
) -> Samples:
    chosen = np.flatnonzero(usable & (encoded > BLACK))
    codes, rough = encoded.ravel()[chosen], roughness.ravel()[chosen]
    bins = (codes * _BINS).astype(np.intp)
    kept = []
    for index in np.unique(bins):
        members = np.flatnonzero(bins == index)
        flat = members[rough[members] <= np.quantile(rough[members], _SHARE_KEPT)]
        kept.append(generator.choice(flat, min(_PER_BIN, len(flat)), replace=False))
    places = chosen[np.concatenate(kept)] if kept else chosen[:0]
    return Samples(
        encoded.ravel()[places].astype(np.float64), linear.reshape(-1, 3)[places].astype(np.float64)
    )
