"""Curves that need no photo: the answers every estimate must beat."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.color.srgb import decode_srgb
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.response.model import ResponseModel
from facecrf_ocio.values import Float

FIXED_CURVES = ("mean", "srgb", "gamma22", "identity")


def fixed_curve(name: str, encoded: Float, model: ResponseModel) -> Float:
    """Linear light (K,) at encoded values (K,) of a curve that does not look at the photo.

    Parameters
    ----------
    name
        `mean` (g0 of the response model), `srgb` (IEC 61966-2-1), `gamma22`, or `identity`.
    encoded
        (K,) encoded values in [0, 1].
    model
        The response model whose mean is asked for.
    """
    if name == "mean":
        return np.interp(encoded, model.grid, model.mean)
    if name == "srgb":
        return decode_srgb(encoded)
    if name == "gamma22":
        return np.asarray(encoded**2.2)
    if name == "identity":
        return np.asarray(encoded, dtype=np.float64)
    raise SettingsError(f"no fixed curve {name!r}; known: {', '.join(FIXED_CURVES)}")
