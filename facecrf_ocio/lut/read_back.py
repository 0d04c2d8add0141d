"""Reading a LUT file back through OpenColorIO and comparing it with its curve."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import LutError
from facecrf_ocio.lut.encoding import Encoding
from facecrf_ocio.lut.format_table import LutFormat, format_of
from facecrf_ocio.lut.ocio_processor import RefusedError, exact_cpu, ocio_processor
from facecrf_ocio.lut.table import LUT_LENGTH
from facecrf_ocio.lut.transform import LutTransform, expected
from facecrf_ocio.values import Float, InverseCRF, frozen

TOLERANCE = 1e-6  # [linear] a few steps of single precision at white
# OCIO finds the place between two entries in float32: near white, to half a unit of 2**-23.
_CODE_RESOLUTION = 2.0**-24


def require_curve(path: Path, curve: InverseCRF, *, name: Path | None = None) -> None:
    """Check that OpenColorIO makes of a LUT file what the curve says.

    Compared are all entries and, between them, all 16-bit codes.

    Parameters
    ----------
    path
        The file.
    curve
        What it should hold.
    name
        What to call the file in an error, where it is not yet at its place.

    Raises
    ------
    LutError
        If OpenColorIO cannot read the file, or differs from the curve by more than 1e-6 of white
        beyond what the float32 resolution of code values makes of a step.
    """
    row = format_of(path if name is None else name)
    require_transform(path, LutTransform(curve), row, name=name)


def require_transform(
    path: Path, transform: LutTransform, row: LutFormat, *, name: Path | None = None
) -> None:
    """Check that OpenColorIO makes of a file what its transform says; see `require_curve`.

    Raises
    ------
    LutError
        If it cannot read the file, or errs by more than the tolerance.
    """
    name = path if name is None else name
    reader = _reader(path, row, name)
    if row.profile or transform.matrix is not None:
        error, tolerance = _error_beside_matrix(reader, transform, row)
    else:
        kind = row.encoding if transform.encodes else Encoding.UNIFORM
        error, tolerance = _error_of(reader, transform.curve, transform.direction, kind), TOLERANCE
    if not error <= tolerance:
        raise LutError(
            f"{name}: OpenColorIO reads it back with an error of {error:.3g}; nothing was written, "
            "please report this"
        )


@cache
def _places() -> npt.NDArray[np.float32]:
    """Return gray input (N, 3): the table's entries and all 16-bit codes."""
    lengths = (LUT_LENGTH, 65536)
    codes = np.concatenate([np.linspace(0.0, 1.0, n, dtype=np.float32) for n in lengths])
    return frozen(np.repeat(codes[:, None], 3, axis=1), np.float32)


def _gain(matrix: Float) -> float:
    return float(np.abs(matrix).sum(axis=1).max())


@dataclass(frozen=True, slots=True)
class _Reader:
    """A file as OpenColorIO read it.

    Attributes
    ----------
    identity
        Its own name for all that it does to pixels, by which it keeps processors itself: with
        digests of all numbers of a table, and without the file's name or format.
    cpu
        What maps pixels.
    """

    identity: str
    cpu: Any = field(compare=False)

    def maps(self, given: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        """(N, 3) what it makes of (N, 3) pixels."""
        pixels = np.ascontiguousarray(given).copy()
        self.cpu.applyRGB(pixels)
        return pixels


def _reader(path: Path, row: LutFormat, name: Path) -> _Reader:
    try:
        # OCIO takes a profile's own direction, from the connection space to the device, as forward.
        cpu = exact_cpu(ocio_processor(path, inverse=row.profile, curve=not row.profile))
    except RefusedError as error:
        problem = f"OpenColorIO cannot read it back: {error}"
        raise LutError(f"{name}: {problem}; write to another folder") from error
    return _Reader(cpu.getCacheID(), cpu)


@lru_cache(maxsize=2)  # of one photo's files, most of which OpenColorIO reads as the same
def _error_of(reader: _Reader, curve: InverseCRF, direction: str, encoding: Encoding) -> float:
    """How far a file without a matrix is from its curve."""
    found: Float = reader.maps(_places()).T.astype(np.float64, order="C")
    error = float(np.abs(found - _held(curve, direction, encoding)).max())
    if error <= TOLERANCE:  # mostly, and then it is no larger within the code resolution
        return error
    return _worst_error(found, *_bounds(curve, direction, encoding, _CODE_RESOLUTION))


def _error_beside_matrix(
    reader: _Reader, transform: LutTransform, row: LutFormat
) -> tuple[float, float]:
    """How far a file with a matrix is from its curve once that is undone, and how far it may be."""
    places, tolerance, resolution = _places(), TOLERANCE, _CODE_RESOLUTION
    matrix = transform.matrix
    if matrix is not None and transform.encodes:
        places = (places @ matrix.T).astype(np.float32)
        resolution *= 4.0 * _gain(matrix) * _gain(np.linalg.inv(matrix))
    found: Float = reader.maps(places).T.astype(np.float64, order="C")
    if matrix is not None and not transform.encodes:
        found = np.linalg.solve(matrix, found)
        tolerance *= _gain(np.linalg.inv(matrix))
    elif row.profile:
        # It goes on to XYZ; what black and the three primaries become is the way back.
        primaries = reader.maps(np.eye(3, dtype=np.float32))
        found = np.linalg.solve(primaries.T, found)
        tolerance *= 20.0  # entries are rounded to 1/65535, the colorants' inverse is near 3
    kind = row.encoding if transform.encodes else Encoding.UNIFORM
    bounds = _bounds(transform.curve, transform.direction, kind, resolution)
    return _worst_error(found, *bounds), tolerance


def _bounds(
    curve: InverseCRF, direction: str, encoding: Encoding, resolution: float
) -> tuple[Float, Float]:
    """(C, N) least and greatest of what a format holds, as seen within the code resolution."""
    low, high = (_held(curve, direction, encoding, by) for by in (-resolution, resolution))
    return low, high


@lru_cache(maxsize=4)  # of one photo's files, most of which hold the same curve
def _held(curve: InverseCRF, direction: str, encoding: Encoding, shift: float = 0.0) -> Float:
    """(C, N) what a format holds at all places, shifted; C is 1 where channels are alike."""
    nodes, values = expected(LutTransform(curve, direction), encoding)
    at = _places()[:, 0].astype(np.float64) + shift
    channels = range(_different(nodes, values))
    return np.array([np.interp(at, nodes[c], values[c]) for c in channels])


def _different(nodes: Float, values: Float) -> int:
    """How many channels (of rows (3, K)) there are to look at: one where the others are like it."""
    alike = all((rows == rows[0]).all() for rows in (nodes, values))
    return 1 if alike else len(nodes)


def _worst_error(found: Float, low: Float, high: Float) -> float:
    """Return by how much (3, N) `found` leaves its bounds."""
    # NaN must not pass: np.max keeps it, and the caller's comparison refuses it.
    return float(np.max([0.0, np.max(low - found), np.max(found - high)]))
