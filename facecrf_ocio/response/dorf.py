"""Reader of Columbia's Database of Response Functions (DoRF): measured curves, not shipped."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import scipy.io
from scipy.io.matlab import MatReadError

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.values import Float

GRID_SIZE = 1024  # samples of a DoRF curve, as the database has them


def read_dorf_inverse(path: str | Path) -> Float:
    """Read the DoRF curves and invert them.

    Parameters
    ----------
    path
        MATLAB file with `I` irradiance and `B` brightness, each (C, K), rows are curves.

    Returns
    -------
    numpy.ndarray
        (C, 1024) irradiance at uniform encoded values in [0, 1] (METHOD: linear interpolation).

    Raises
    ------
    PhotoError
        If the file is not a DoRF file.
    """
    try:
        content = scipy.io.loadmat(path)
        irradiance, brightness = content["I"], content["B"]
    except (OSError, KeyError, ValueError, IndexError, NotImplementedError, MatReadError) as error:
        raise PhotoError(
            Path(path), f"is not a DoRF file ({error})", "give a .mat file with I and B, 201 x 1024"
        ) from error
    encoded = np.linspace(0.0, 1.0, GRID_SIZE)
    return np.array([np.interp(encoded, b, i) for b, i in zip(brightness, irradiance, strict=True)])
