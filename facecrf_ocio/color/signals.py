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
# Of a film scan: 0.002 in density for each of 1,023 codes, on negative film of contrast 0.6; and
# the code that is black.
_SCAN_DECADES, _SCAN_BLACK = 1023 * 0.002 / 0.6, 95 / 1023
_A, _B, _C = 0.17883277, 0.28466892, 0.55991073  # of HLG, table 5


def decode_pq(encoded: npt.ArrayLike) -> Float:
    """Light (...) of a display, 1 being 10,000 cd/m2, of code values (...) in [0, 1]."""
    power = np.asarray(encoded, float) ** (1 / _M2)
    return np.asarray((np.maximum(power - _C1, 0) / (_C2 - _C3 * power)) ** (1 / _M1))


def decode_hlg(encoded: npt.ArrayLike) -> Float:
    """Light (...) of the scene, 1 being the brightest, of code values (...) in [0, 1]."""
    codes = np.asarray(encoded, float)
    return np.where(codes <= 0.5, codes**2 / 3, (np.exp((codes - _C) / _A) + _B) / 12)


def decode_log(encoded: npt.ArrayLike, decades: float) -> Float:
    """Light of the scene by a logarithm over so many decades below white (H.273, table 3)."""
    return np.asarray(10.0 ** (decades * (np.asarray(encoded, float) - 1.0)))


def decode_film_scan(encoded: npt.ArrayLike) -> Float:
    """Light (...) of the scene of printing densities on a negative; none up to code 95 of 1023.

    A card that reflects 90 % lies at code 685, where light is 0.074 of that at code 1023.
    """
    black = decode_log(_SCAN_BLACK, _SCAN_DECADES)
    return np.asarray(np.maximum(decode_log(encoded, _SCAN_DECADES) - black, 0.0) / (1.0 - black))
