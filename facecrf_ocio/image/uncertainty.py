"""How far each pixel's light may be off, as a channel of an EXR: the band at the pixel's codes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.image.apply import Pixels, Rows, linear_rows
from facecrf_ocio.image.lookup import Lookup
from facecrf_ocio.values import Estimate, Float, Photo

CHANNEL = "facecrf.sigma"


def sigma_rows(photo: Photo, estimate: Estimate, factor: float = 1.0) -> Rows:
    """Standard deviation of each pixel's light, a band of rows at a time.

    Parameters
    ----------
    photo, estimate
        The photo, and its curve with a band.
    factor
        By which its light is scaled.

    Returns
    -------
    Rows
        Gives (end - begin, W): root mean square over the channels of what the band allows at their
        codes, in units of the linear light that the curve gives, before any matrix, and multiplied
        by alpha as colors are. It is that of the curve alone: noise and clipping are not in it.

    Raises
    ------
    SettingsError
        If the estimate has no band, or the photo needs no curve.
    """
    if photo.scene_linear or estimate.confidence is None:
        why = "is scene-linear" if photo.scene_linear else f"was not estimated ({estimate.outcome})"
        raise SettingsError(f"no uncertainty to write: the photo {why}; leave it out")
    of_channels = linear_rows(photo, _sigma_lookup(estimate, estimate.confidence.sigma), half=False)

    def rows(begin: int, end: int) -> Pixels:
        found: npt.NDArray[np.float32] = of_channels(begin, end)
        sigma = np.float32(factor) * np.sqrt((found**2).mean(axis=2))
        return np.asarray(sigma if photo.alpha is None else sigma * photo.alpha[begin:end])

    return rows


def _sigma_lookup(estimate: Estimate, sigma: Float) -> Lookup:
    encoded = estimate.curve.encoded

    def transform(values: npt.NDArray[np.float32], out: Pixels) -> None:
        for channel, row in enumerate(np.nan_to_num(sigma)):
            out[..., channel] = np.interp(values[..., channel], encoded, row)

    return Lookup(transform)
