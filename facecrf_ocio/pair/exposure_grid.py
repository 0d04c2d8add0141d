"""Exposures as cameras make them: EXIF says 1/60 s where the shutter is open for 1/64 s.

Times, f-numbers and sensitivities stand on grids of 1/3 or 1/2 stop; what a camera writes are the
rounded names of their steps (ISO 2720 and ISO 12232; CIPA DC-008, annex C).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from facecrf_ocio.photo.shot import Shot
from facecrf_ocio.values import Float

_NEAR = 0.04  # [stop] between what a file says and the name of a step, for rounded fractions
_SAME = 1e-4  # [stop]

# Names of the steps as printed on cameras, and the stop of the first; each next is one step on.
_LONG = (30, 25, 20, 15, 13, 10, 8, 6, 5, 4, 3.2, 2.5, 2, 1.6, 1.3, 1, 0.8, 0.6, 0.5, 0.4, 0.3)
_SHORT = (  # [1/s] next steps of a third
    *(4, 5, 6, 8, 10, 13, 15, 20, 25, 30, 40, 50, 60, 80, 100, 125, 160, 200, 250, 320, 400, 500),
    *(640, 800, 1000, 1250, 1600, 2000, 2500, 3200, 4000, 5000, 6400, 8000),
)
_LONG_HALF = (30, 20, 15, 10, 8, 6, 4, 3, 2, 1.5, 1, 0.7, 0.5, 0.3)  # [s] steps of a half
_SHORT_HALF = (  # [1/s]
    *(4, 6, 8, 10, 15, 20, 30, 45, 60, 90, 125, 180, 250, 350, 500, 750, 1000, 1500, 2000, 3000),
    *(4000, 6000, 8000),
)
_APERTURES = (  # f-numbers, steps of a third
    *(1, 1.1, 1.2, 1.4, 1.6, 1.8, 2, 2.2, 2.5, 2.8, 3.2, 3.5, 4, 4.5, 5, 5.6, 6.3, 7.1, 8, 9, 10),
    *(11, 13, 14, 16, 18, 20, 22, 25, 29, 32),
)
_APERTURES_HALF = (  # f-numbers, steps of a half
    *(1, 1.2, 1.4, 1.8, 2, 2.5, 2.8, 3.5, 4, 4.5, 5.6, 6.7, 8, 9.5, 11, 13, 16, 19, 22, 27, 32),
)
_ISO = (  # ISO speed, steps of a third
    *(50, 64, 80, 100, 125, 160, 200, 250, 320, 400, 500, 640, 800, 1000, 1250, 1600, 2000, 2500),
    *(3200, 4000, 5000, 6400, 8000, 10000, 12800, 16000, 20000, 25600),
)


def exposure_stops(
    times: Sequence[float], apertures: Sequence[float], sensitivities: Sequence[float]
) -> Float:
    """log2 of the exposure of each shot of a set, on the camera's grid where EXIF names its steps.

    Parameters
    ----------
    times, apertures, sensitivities
        [s], f-numbers, ISO, as EXIF tells them. A factor that is alike in all shots, or not told
        (0) of one of them, says nothing and is left out.

    Returns
    -------
    numpy.ndarray
        (J,) stops; only differences mean something.
    """
    return np.asarray(
        _factor(times, _TIME_GRIDS)
        - 2.0 * _factor(apertures, _APERTURE_GRIDS)
        + _factor(sensitivities, _ISO_GRIDS)
    )


def stops_of_shots(shots: Sequence[Shot]) -> Float:
    """(J,) the same of what EXIF tells of the shots of a set."""
    return exposure_stops(
        [shot.exposure_s for shot in shots],
        [shot.aperture for shot in shots],
        [shot.iso for shot in shots],
    )


def _factor(values: Sequence[float], grids: Sequence[tuple[Float, Float]]) -> Float:
    given = np.asarray(values, dtype=np.float64)
    if (given <= 0.0).any():
        return np.zeros(given.size)
    stops = np.log2(given)
    if np.ptp(stops) < _SAME:
        return np.zeros(given.size)
    for names, exact in grids:
        nearest = np.abs(stops[:, None] - names).argmin(axis=1)
        if (np.abs(stops - names[nearest]) < _NEAR).all():
            return np.asarray(exact[nearest])
    return stops  # such as a phone's 1/1437 s, which is what it says


def _grid(names: Sequence[float], first: float, step: float) -> tuple[Float, Float]:
    """log2 of N names and of what they stand for, from the stop of the first on; each (N,)."""
    return np.log2(np.asarray(names, np.float64)), first + step * np.arange(len(names))


_TIME_GRIDS = (  # [stop] from 32 s on, which is called 30 s
    _grid((*_LONG, *(1.0 / n for n in _SHORT)), 5.0, -1.0 / 3.0),
    _grid((*_LONG_HALF, *(1.0 / n for n in _SHORT_HALF)), 5.0, -0.5),
)
# [log2 of f] a sixth is a third of a stop of light.
_APERTURE_GRIDS = (_grid(_APERTURES, 0.0, 1.0 / 6.0), _grid(_APERTURES_HALF, 0.0, 0.25))
_ISO_GRIDS = (_grid(_ISO, float(np.log2(50.0)), 1.0 / 3.0),)  # [stop]
