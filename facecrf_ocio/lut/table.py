"""The table of numbers that every LUT file holds, and how its numbers are written."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float, InverseCRF

LUT_LENGTH = 4096  # entries: as many as a curve has samples, so that none is lost
# OpenColorIO 2.6 refuses files with numbers that are subnormal in float32.
_SMALLEST = np.finfo(np.float32).tiny


def resample(curve: InverseCRF) -> Float:
    """Sample a curve uniformly over [0, 1].

    The curve is linear between its samples, so this is exact for a curve that has its samples at
    the same codes, and increasing for every curve.

    Returns
    -------
    numpy.ndarray
        (3, 4096) float64.
    """
    nodes = np.linspace(0.0, 1.0, LUT_LENGTH)
    return np.stack([np.interp(nodes, curve.encoded, linear) for linear in curve.linear])


def lut_table(curve: InverseCRF) -> npt.NDArray[np.float32]:
    """Return the entries of a curve's LUT.

    Returns
    -------
    numpy.ndarray
        (4096, 3) float32, never decreasing along the first axis. Steps that float32 cannot tell
        apart become equal; values below its smallest normal number, 1.2e-38, become 0.
    """
    table = resample(curve).T.astype(np.float32)
    table[table < _SMALLEST] = 0.0
    return table


@lru_cache(maxsize=1)  # the formats of one photo hold the same rows, one after the other
def table_rows(curve: InverseCRF) -> str:
    """Write a curve's LUT as one line "R G B" per entry."""
    return rows_of(lut_table(curve))


def rows_of(table: npt.NDArray[np.float32]) -> str:
    """Write (K, 3) as lines "R G B"; nine digits make float32 exact."""
    if (table == table[:, :1]).all():
        numbers = ("%.9g\n" * len(table) % tuple(table[:, 0].tolist())).split()
        return "".join([f"{number} {number} {number}\n" for number in numbers])
    return "%.9g %.9g %.9g\n" * len(table) % tuple(table.ravel().tolist())
