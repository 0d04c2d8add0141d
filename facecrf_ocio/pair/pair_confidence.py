"""How far a pair's curve may be trusted, from its residual and from how far white is out of sight.

Constants are those that make what is told likeliest on 27 pairs of known curves that are alike in
all channels (drawn and real scenes, noise, JPEG 88 to 100, sharpening, vignetting of up to 0.4
stops, white up to 1.6 stops out of sight): what came of 30 others is in `docs/evidence`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from facecrf_ocio.pair.continue_alike import SEEN
from facecrf_ocio.pair.fit_channel import ChannelFit
from facecrf_ocio.pair.flat_pixels import Samples
from facecrf_ocio.response.coverage import COVERAGE_BINS, coverage_at
from facecrf_ocio.response.expected_stops import expected_of_deviation, verdict_of
from facecrf_ocio.response.model import CURVE_SIZE
from facecrf_ocio.response.robust import robust_deviation
from facecrf_ocio.response.stops import CODES, DARKEST, MID_CODES, MID_GRAY, mean_over
from facecrf_ocio.values import Confidence, Float, InStops, InverseCRF, Verdict

RELIABLE_RESIDUAL_CODES = 3.0  # [8-bit code] up to which one curve explains noise and compression
RELIABLE_SPAN = 0.5  # [encoded] that samples must cover, or most of the curve is continued
_MIN_PER_BIN = 10  # samples that make a bin one that is seen
_OF_ALL = 0.004  # [stop] of every curve
# Of the spread of single samples. A fit over hundreds is surer than one of them; but what a pair
# gets wrong is mostly not noise: local tone mapping, vignetting, saturation, which samples share.
_SHARED = 0.3
_GUESSED = 0.2  # of the stops beyond the brightest samples, which known responses bridge
_WHITE = 0.45  # of the stops from the brightest samples to white: how far white itself may lie off
# Of the stops in which a channel is continued as another one goes on: what channels differ by.
_UNLIKE = 0.1
# [stop] Mean distance of what is seen of the channels from their mean, up to which noise, color
# and compression explain it (0.056 at most, where all have one curve); and how much more of the
# unseen stops each stop beyond it costs.
_ALIKE, _AS_UNLIKE = 0.05, 3.0


def pair_confidence(
    samples: Sequence[Samples], fits: Sequence[ChannelFit], found: InverseCRF
) -> Confidence:
    """Band, expected error in stops and verdict of a pair's curve."""
    encoded = found.encoded
    spreads, coverage = np.empty((3, CURVE_SIZE)), np.empty((3, CURVE_SIZE))
    for channel, (chosen, fit) in enumerate(zip(samples, fits, strict=True)):
        centers, measured, counts = _spreads(chosen.encoded, fit.residual)
        coverage[channel] = coverage_at(encoded, counts)
        seen = counts >= _MIN_PER_BIN
        spreads[channel] = np.interp(encoded, centers[seen], measured[seen])
    depth = np.log2(np.maximum(found.linear, 2.0**DARKEST))
    tops = np.array([np.quantile(one.encoded, SEEN[1]) for one in samples])
    unseen = -np.array([np.interp(top, encoded, d) for top, d in zip(tops, depth, strict=True)])
    white = _WHITE * np.log(2.0) * found.linear * np.minimum(unseen[:, None], -depth)
    sigma = np.hypot(spreads, white)
    sigma[:, [0, -1]] = 0.0
    low = max(float(s.encoded.min()) for s in samples)
    high = min(float(s.encoded.max()) for s in samples)
    worst = max(fit.residual_codes for fit in fits)
    explained = worst <= RELIABLE_RESIDUAL_CODES and high - low >= RELIABLE_SPAN
    in_stops = _in_stops(found, spreads, depth, unseen)
    return Confidence(
        sigma,
        coverage,
        verdict_of(in_stops) if explained else Verdict.WEAK,
        (
            "the band is the residual of the fit to the linear picture, and how far white is from "
            "the brightest samples",
            f"the samples lie between the encoded values {low:.2f} and {high:.2f}; beyond them the "
            "curve keeps the shape of a typical one",
        ),
        in_stops,
    )


def _in_stops(found: InverseCRF, spreads: Float, depth: Float, unseen: Float) -> InStops:
    """With the factor out at mid-gray: where white lies then says nothing of the shape."""
    codes = CODES / CODES[-1]
    light, depth, spread = (
        np.array([np.interp(codes, found.encoded, row) for row in rows])
        for rows in (found.linear, depth, spreads)
    )
    own = _SHARED * spread / np.maximum(light, 2.0**DARKEST) / np.log(2.0)
    shapes = depth - depth[:, [MID_GRAY]]
    guessed = _GUESSED * np.maximum(depth + unseen[:, None], 0.0)
    guessed = guessed - guessed[:, [MID_GRAY]]
    apart = max(mean_over(np.abs(shapes - shapes.mean(axis=0)), MID_CODES) - _ALIKE, 0.0)
    unlike = _UNLIKE * (unseen - unseen.min()) + _AS_UNLIKE * apart * unseen
    squares = 2.0 * _OF_ALL**2 + own**2 + own[:, [MID_GRAY]] ** 2 + guessed**2
    squares += unlike[:, None] ** 2
    return expected_of_deviation(np.sqrt(squares))


def _spreads(encoded: Float, residual: Float) -> tuple[Float, Float, Float]:
    """Centers, robust standard deviations and counts of the ranges of coverage, each (64,)."""
    size = COVERAGE_BINS
    bins = np.clip((encoded * size).astype(np.intp), 0, size - 1)
    counts = np.bincount(bins, minlength=size).astype(np.float64)
    spreads = np.array(
        [robust_deviation(residual[bins == b]) if counts[b] else 0 for b in range(size)]
    )
    return (np.arange(size) + 0.5) / size, spreads, counts
