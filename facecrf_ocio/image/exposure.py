"""An anchor for linear light, which one photo tells up to one factor only."""

from __future__ import annotations

import numpy as np

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.values import InverseCRF, Photo

GRAY = "gray"
_MIDDLE_GRAY = 0.18  # reflectance that meters take a scene to have on average (ISO 2720)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # Rec.709; other primaries differ by < 0.1 stops
_DARKEST = 2.0**-12  # of white: below it noise decides, and zero has no logarithm
_MOST_STOPS = 16.0  # half floats hold white up to there
_STEP = 4  # every so many pixels are enough for a mean


def exposure_stops(exposure: str, photo: Photo, curve: InverseCRF) -> float:
    """Return the stops by which linear light is to be multiplied.

    Parameters
    ----------
    exposure
        A number of stops; or `gray`, which brings the geometric mean of the luminance to 0.18.
    photo, curve
        Whose light it is.

    Raises
    ------
    SettingsError
        If it is neither, or more than 16 stops.
    """
    if exposure == GRAY:
        return float(np.log2(_MIDDLE_GRAY / _mean_luminance(photo, curve)))
    try:
        stops = float(exposure)
    except ValueError:
        stops = float("nan")
    if not abs(stops) <= _MOST_STOPS:
        raise SettingsError(
            f"no exposure {exposure!r}; give stops from -{_MOST_STOPS:.0f} to {_MOST_STOPS:.0f}, "
            f"or {GRAY}"
        )
    return stops


def _mean_luminance(photo: Photo, curve: InverseCRF) -> float:
    pixels = photo.encoded[::_STEP, ::_STEP]
    linear = pixels if photo.scene_linear else curve.linearize(pixels)
    luminance = np.maximum(linear @ LUMINANCE, _DARKEST)
    return float(np.exp(np.log(luminance).mean()))
