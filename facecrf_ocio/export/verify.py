"""Reading a LUT file back through OpenColorIO and comparing it with its curve."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import numpy.typing as npt
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.errors import LutError
from facecrf_ocio.export.table import LUT_LENGTH, resample
from facecrf_ocio.values import Float, InverseCRF

TOLERANCE = 1e-6
# OCIO finds the place between two entries in float32: near white, to half a unit of 2**-23.
_CODE_RESOLUTION = 2.0**-24


def verify_lut(path: Path, curve: InverseCRF, *, name: Path | None = None) -> None:
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
    name = path if name is None else name
    codes = np.concatenate(
        [np.linspace(0.0, 1.0, n, dtype=np.float32) for n in (LUT_LENGTH, 65536)]
    )
    found = _read_through_ocio(path, codes, name)
    error = _worst_error(found, codes, resample(curve))
    if not error <= TOLERANCE:
        raise LutError(
            f"{name}: OpenColorIO reads it back with an error of {error:.3g}; nothing was written, "
            "please report this"
        )


def _read_through_ocio(
    path: Path, codes: npt.NDArray[np.float32], name: Path
) -> npt.NDArray[np.float32]:
    """Return (N, 3) what OCIO maps the (N,) codes to."""
    pixels = np.repeat(codes[:, None], 3, axis=1)
    try:
        transform = ocio.FileTransform(os.path.abspath(path))  # noqa: PTH100 - resolves no links
        # An empty context keeps OCIO from expanding $HOME and the like in the folder's name.
        processor = ocio.Config.CreateRaw().getProcessor(
            ocio.Context(), transform, ocio.TRANSFORM_DIR_FORWARD
        )
        processor.getOptimizedCPUProcessor(
            ocio.BIT_DEPTH_F32, ocio.BIT_DEPTH_F32, ocio.OPTIMIZATION_LOSSLESS
        ).applyRGB(pixels)
    except ocio.Exception as error:
        problem = " ".join(str(error).split())
        raise LutError(f"{name}: OpenColorIO cannot read it back: {problem}") from error
    except TypeError as error:  # how its binding meets a path that is not Unicode
        raise LutError(
            f"{name}: OpenColorIO cannot read from a folder whose name is not Unicode; "
            "choose another folder"
        ) from error
    finally:
        # It keeps every file it ever read, by path: a batch would fill the memory, and a file
        # that is written again would be read as it was.
        ocio.ClearAllCaches()
    return pixels


def _worst_error(
    found: npt.NDArray[np.float32], codes: npt.NDArray[np.float32], linear: Float
) -> float:
    """Return by how much (N, 3) `found` leaves the curve as seen within the code resolution."""
    nodes = np.linspace(0.0, 1.0, LUT_LENGTH)
    places = codes.astype(np.float64)
    worst = 0.0
    for channel, values in enumerate(linear):
        low = np.interp(places - _CODE_RESOLUTION, nodes, values)
        high = np.interp(places + _CODE_RESOLUTION, nodes, values)
        given = found[:, channel].astype(np.float64)
        # NaN must not pass: np.max keeps it, and the caller's comparison refuses it.
        worst = float(np.max([worst, np.max(low - given), np.max(given - high)]))
    return worst
