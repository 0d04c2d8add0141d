"""What a fit of the light of points rests on: a number a point and a frame, and weights."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.clip.light_parts import Placed
from facecrf_ocio.clip.point_values import centered
from facecrf_ocio.response.robust import biweight_of_squares, robust_deviation
from facecrf_ocio.values import Float, Index

ROUNDS = 3  # of places on the curve
REWEIGHTED = 2  # times a round
ALIKE = 3.0  # values that count as one beside what is known beforehand
TILES = 7  # parts of the picture, a side, that err each in their own way
_LEAST_SCALE = 0.1  # of residuals to the noise that was expected
# A point's own noise is taken from its values, beside so many of the usual: those at edges, and
# where light moves, count less.
_USUAL = 5.0
_MOST_NOISE = 9.0  # [usual variance] that one value counts in that
_LOOSE = 1e-2  # precision of a frame's exposure, of which nothing is known


def beside_frames(
    columns: Float, weights: Float, placed: Placed, first: Index
) -> tuple[Float, Float]:
    """Columns less what one number a point and one a frame explain of them, and those of frames.

    `first` (P,) is the place of each point's first value.
    """
    shown: Float = np.zeros((len(columns), placed.frames))
    shown[np.arange(len(columns)), placed.frame] = 1.0
    shown, apart = centered(shown, weights, first), centered(columns, weights, first)
    heavy = shown * weights[:, None]
    normal = shown.T @ heavy + _LOOSE * np.eye(placed.frames)
    of_frames = np.linalg.solve(normal, heavy.T @ apart)
    return apart - shown @ of_frames, of_frames


def weights_of(standard: Float, first: Index) -> Float:
    """(V, K) of residuals (V, K) in units of the noise that was expected.

    By their scale, by each point's own noise, and robustly; K values at a time are of one kind.
    """
    scale = max(robust_deviation(standard), _LEAST_SCALE)
    standard = standard / scale
    count = np.diff(first, append=len(standard))
    squares = np.minimum(standard**2, _MOST_NOISE).mean(axis=1)
    own = np.add.reduceat(squares, first)
    variance = np.repeat((_USUAL + own) / (_USUAL + count), count)[:, None]
    return np.asarray(biweight_of_squares(standard**2 / variance) / (variance * scale**2))
