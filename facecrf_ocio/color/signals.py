"""Curves that files name, white of the signal being 1.

PQ and HLG are those of ITU-R BT.2100-2, tables 4 and 5; the logarithms those of ITU-T H.273, and
that of film scans Kodak's ("Conversion of 10-bit Log Film Data to 8-bit Linear or Video Data for
the Cineon Digital Film System", 1995).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float

_M1, _M2 = 2610 / 16384, 2523 / 4096 * 128  # of PQ, table 4
_C1, _C2, _C3 = 3424 / 4096, 2413 / 4096 * 32, 2392 / 4096 * 32  # of PQ, table 4
# Of a film scan: code values of 10 bits, density a code, and the contrast of negative film.
_SCAN_TOP, _SCAN_BLACK, _SCAN_DENSITY, _SCAN_GAMMA = 1023.0, 95.0, 0.002, 0.6
_A, _B, _C = 0.17883277, 0.28466892, 0.55991073  # of HLG, table 5


def decode_pq(encoded: npt.ArrayLike) -> Float:
    """Light of a display, 1 being 10,000 cd/m2, of code values in [0, 1]."""
    power = np.asarray(encoded, float) ** (1 / _M2)
    return np.asarray((np.maximum(power - _C1, 0) / (_C2 - _C3 * power)) ** (1 / _M1))


def decode_hlg(encoded: npt.ArrayLike) -> Float:
    """Light of the scene, 1 being the brightest, of code values in [0, 1]."""
    codes = np.asarray(encoded, float)
    return np.where(codes <= 0.5, codes**2 / 3, (np.exp((codes - _C) / _A) + _B) / 12)


def decode_log(encoded: npt.ArrayLike, decades: float) -> Float:
    """Light of the scene by a logarithm over so many decades below white (H.273, table 3)."""
    return np.asarray(10.0 ** (decades * (np.asarray(encoded, float) - 1.0)))


def decode_film_scan(encoded: npt.ArrayLike) -> Float:
    """Light of the scene of printing densities on a negative; none up to code 95 of 1023.

    A card that reflects 90 % lies at code 685, where light is 0.074 of that at code 1023.
    """
    codes = _SCAN_TOP * np.asarray(encoded, float)
    above_black = _light_of_codes(codes) - _light_of_codes(_SCAN_BLACK)
    return np.asarray(np.maximum(above_black, 0.0) / (1.0 - _light_of_codes(_SCAN_BLACK)))


def _light_of_codes(codes: npt.ArrayLike) -> Float:
    density = (np.asarray(codes, float) - _SCAN_TOP) * _SCAN_DENSITY
    return np.asarray(10.0 ** (density / _SCAN_GAMMA))
