"""A file of curves for benches that read one, drawn instead of measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from facecrf_ocio.response.model import dorf_model, strictly_increasing


def write_drawn_curves(path: Path) -> Path:
    """Twelve curves from about each part of the shipped model's prior; returns the path."""
    model, generator = dorf_model(), np.random.default_rng(4)
    drawn = [
        generator.multivariate_normal(mean, 0.2 * covariance)
        for mean, covariance in zip(model.mixture.means, model.mixture.covariances, strict=True)
        for _ in range(12)
    ]
    np.savez(path, inverse=strictly_increasing(model.samples(np.array(drawn))))
    return path
