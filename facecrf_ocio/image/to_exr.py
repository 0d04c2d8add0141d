"""From a photo to a scene-linear EXR in one call."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.estimates import Estimate
from facecrf_ocio.image.linearize import write_linear
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.values import Photo


def linearize_photo(
    photo: Photo | str | Path,
    exr: str | Path,
    *,
    estimator: str = "auto",
    fallback: str = "none",
    prior: str = "auto",
    **options: Any,
) -> Estimate:
    """Calibrate one photo and write it as a scene-linear EXR.

    Parameters
    ----------
    photo
        As read by `read_photo`, or the path of its file.
    exr
        File to write.
    estimator, fallback, prior
        As `calibrate` takes them.
    options
        `space`, `exposure`, `half`, `compression`, `overwrite` and `uncertainty`, as `write_linear`
        takes them.

    Raises
    ------
    NotCalibratedError
        If the photo gives no curve; nothing is written.
    PhotoError, OutputError
        If the photo cannot be read, or the file cannot be written.
    """
    source = photo if isinstance(photo, Photo) else read_photo(photo)
    estimate = calibrate(source, estimator=estimator, fallback=fallback, prior=prior)
    write_linear(Path(exr), source, estimate, **options)
    return estimate
