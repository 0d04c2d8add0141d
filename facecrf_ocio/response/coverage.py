"""How much of the evidence for a curve lies at or near each of its codes."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.values import Float

COVERAGE_BINS = 64  # of four codes each: skin spans tens of codes, a manifest keeps 192 numbers


def coverage_counts(encoded: Float) -> Float:
    """(64,) number of encoded values (N,) in each bin of [0, 1]."""
    counts = np.histogram(encoded, bins=COVERAGE_BINS, range=(0.0, 1.0))[0]
    return np.asarray(counts, np.float64)


def coverage_at(codes: Float, counts: Float) -> Float:
    """Evidence near each of the codes (K,), relative to where it is densest; counts are (64,)."""
    centers = (np.arange(COVERAGE_BINS) + 0.5) / COVERAGE_BINS
    return np.asarray(np.interp(codes, centers, counts / max(float(counts.max()), 1e-12)))
