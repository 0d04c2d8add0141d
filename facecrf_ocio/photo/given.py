"""What a caller may give for a photo: the photo, the path of its file, or its code values."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from facecrf_ocio.checks import unit_floats
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.values import Photo

GivenPhoto: TypeAlias = Photo | str | os.PathLike[str] | npt.NDArray[Any]


def photo_given(given: GivenPhoto) -> Photo:
    """Return the photo, which is read if a path is given.

    Raises
    ------
    PhotoError
        If it is none of them, or cannot be read.
    SettingsError
        If code values are integers of another kind than 8-bit and 16-bit ones.
    """
    if isinstance(given, Photo):
        return given
    if isinstance(given, np.ndarray):
        depth = 8 * given.itemsize if given.dtype.kind == "u" else None
        return Photo(encoded=unit_floats(given), bit_depth=depth)
    if isinstance(given, str | os.PathLike):
        return read_photo(Path(given))
    raise PhotoError(
        None, f"is given as {type(given).__name__}", "give a Photo, a path, or an array (H, W, 3)"
    )
