"""From a photo to a scene-linear EXR in one call."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from facecrf_ocio.calibrate import calibrate
from facecrf_ocio.checks import typed
from facecrf_ocio.estimates import Estimate
from facecrf_ocio.image.compression import COMPRESSION
from facecrf_ocio.image.linearize import write_linear
from facecrf_ocio.photo.given import GivenPhoto, photo_given


@typed
def linearize_photo(
    photo: GivenPhoto,
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
        As `calibrate` takes it.
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
    SettingsError
        If an argument is none that is known.
    """
    how = _options(**options)
    source = photo_given(photo)
    estimate = calibrate(source, estimator=estimator, fallback=fallback, prior=prior)
    write_linear(Path(exr), source, estimate, **how)
    return estimate


@typed
def _options(
    *,
    space: str = "",
    exposure: str | float = "0",
    half: bool = True,
    compression: str = COMPRESSION,
    overwrite: bool = False,
    uncertainty: bool = False,
) -> dict[str, Any]:
    return {**locals(), "exposure": str(exposure)}
