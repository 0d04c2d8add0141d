"""What a LUT file shall do: a curve, in one direction, alone or with a matrix behind it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from facecrf_ocio.color.working_space import working_space_matrix
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.lut.encoding import Encoding
from facecrf_ocio.lut.table import LUT_LENGTH, lut_table, resample, rows_of, table_rows
from facecrf_ocio.values import Float, InverseCRF, Primaries

DIRECTIONS = ("linearize", "encode")
ENCODE_LENGTH = 65536  # entries: one for each code of 16 bits


@dataclass(frozen=True, slots=True, eq=False)
class LutTransform:
    """What a LUT file shall do.

    Attributes
    ----------
    curve
        Encoded to linear, R, G, B.
    direction
        `linearize`: the curve, then the matrix. `encode`: the inverse of that.
    space
        Working space, one of `WORKING_SPACES`, that linear light is in; empty for the photo's own.
    primaries
        The photo's; None, where the file does not tell, stands for Rec.709.
    """

    curve: InverseCRF
    direction: str = "linearize"
    space: str = ""
    primaries: Primaries | None = None

    def __post_init__(self) -> None:
        if self.direction not in DIRECTIONS:
            raise SettingsError(f"no direction {self.direction!r}; known: {', '.join(DIRECTIONS)}")

    @property
    def encodes(self) -> bool:
        """Whether the file goes from linear light to code values."""
        return self.direction == "encode"

    @property
    def matrix(self) -> npt.NDArray[np.float64] | None:
        """(3, 3) from the photo's linear RGB to the working space; None where there is none."""
        return working_space_matrix(self.primaries, self.space) if self.space else None


def encode_nodes(half_domain: bool) -> Float:
    """Linear light at which an encoding table has its entries, increasing from 0 to 1.

    A uniform table is (65536,) and coarse in the shadows. One over all half floats (those from 0
    to 1 are (15361,)) has steps of 2**-11 of the value and follows every curve there.
    """
    if half_domain:
        return np.arange(15361, dtype=np.uint16).view(np.float16).astype(np.float64)
    return np.linspace(0.0, 1.0, ENCODE_LENGTH)


def encode_table(curve: InverseCRF, nodes: Float) -> npt.NDArray[np.float32]:
    """Return (K, 3) code values of linear light (K,): the inverse of what `resample` gives."""
    codes = np.linspace(0.0, 1.0, LUT_LENGTH)
    columns = [np.interp(nodes, linear, codes) for linear in resample(curve)]
    return np.stack(columns, axis=1).astype(np.float32)


def uniform_rows(transform: LutTransform) -> tuple[int, str]:
    """Return length and rows "R G B" of the table over [0, 1] of formats that know no other."""
    if not transform.encodes:
        return LUT_LENGTH, table_rows(transform.curve)
    table = encode_table(transform.curve, encode_nodes(half_domain=False))
    return len(table), rows_of(table)


def expected(transform: LutTransform, encoding: Encoding) -> tuple[Float, Float]:
    """Return nodes (3, K) and values (3, K) of the piecewise linear curve a format holds."""
    if not transform.encodes:
        values = resample(transform.curve)
        return np.tile(np.linspace(0.0, 1.0, LUT_LENGTH), (3, 1)), values
    if encoding is Encoding.EXACT:
        linear = lut_table(transform.curve).T.astype(np.float64)
        return linear, np.tile(np.linspace(0.0, 1.0, LUT_LENGTH), (3, 1))
    nodes = encode_nodes(half_domain=encoding is Encoding.HALF_DOMAIN)
    return np.tile(nodes, (3, 1)), encode_table(transform.curve, nodes).T.astype(np.float64)
