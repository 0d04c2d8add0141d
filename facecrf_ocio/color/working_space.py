"""From a photo's linear RGB to a working space: a 3 x 3 matrix."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from facecrf_ocio.color.adaptation import XY, bradford, rgb_to_xyz
from facecrf_ocio.color.primaries import CIE_XYZ, D65, KNOWN_PRIMARIES
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.values import Primaries

_NAMES = {
    "acescg": "AP1",
    "lin_rec709": "Rec.709",
    "lin_p3d65": "Display P3",
    "aces2065-1": "AP0",
}

WORKING_SPACES: dict[str, tuple[XY, XY, XY, XY]] = {
    space: KNOWN_PRIMARIES[name] for space, name in _NAMES.items()
}


def working_primaries(name: str) -> Primaries:
    """Primaries of a working space; SettingsError if it is not known."""
    if name not in WORKING_SPACES:
        raise SettingsError(f"no working space {name!r}; known: {', '.join(WORKING_SPACES)}")
    return Primaries(_NAMES[name], *WORKING_SPACES[name], "working space")


def working_space_matrix(primaries: Primaries | None, name: str) -> npt.NDArray[np.float64]:
    """Matrix from linear RGB of the given primaries to a working space.

    White maps to white: where the whites differ, the source is adapted with Bradford's matrix
    (linear, complete adaptation; ICC.1:2022, annex E), as the ACES configs of OpenColorIO do.

    Parameters
    ----------
    primaries
        Of the source; None, where the file does not tell, stands for Rec.709.
    name
        One of `WORKING_SPACES`: `acescg`, `lin_rec709`, `lin_p3d65`, `aces2065-1`.

    Returns
    -------
    numpy.ndarray
        (3, 3), to be multiplied with columns of RGB.

    Raises
    ------
    SettingsError
        If the working space is not known, or the primaries span no color space.
    """
    space = working_primaries(name)
    target, target_white = [space.red, space.green, space.blue], space.white
    if primaries is None:
        *source, source_white = KNOWN_PRIMARIES["Rec.709"]
    elif primaries.name == CIE_XYZ.name:
        return np.asarray(
            np.linalg.inv(bradford(target_white, D65) @ rgb_to_xyz(target, target_white))
        )
    else:
        source = [primaries.red, primaries.green, primaries.blue]
        source_white = primaries.white
    if (tuple(source), source_white) == (tuple(target), target_white):
        return np.eye(3)
    try:
        from_source = bradford(source_white, target_white) @ rgb_to_xyz(source, source_white)
        return np.asarray(np.linalg.solve(rgb_to_xyz(target, target_white), from_source))
    except (np.linalg.LinAlgError, ZeroDivisionError) as error:
        raise SettingsError(
            "the file's primaries span no color space; leave the working space out"
        ) from error
