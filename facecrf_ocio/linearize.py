"""From a photo and its estimate to a scene-linear EXR that says where it comes from."""

from __future__ import annotations

from pathlib import Path

from facecrf_ocio import __version__
from facecrf_ocio.apply import linear_rows, write_exr
from facecrf_ocio.lookup import curve_lookup
from facecrf_ocio.values import Estimate, Photo


def write_linear(
    path: Path,
    photo: Photo,
    estimate: Estimate,
    *,
    half: bool = True,
    compression: str = "zip",
    overwrite: bool = False,
) -> Path:
    """Send a photo through its estimated curve and write the result; see `apply.write_exr`.

    Raises
    ------
    NotCalibratedError
        If the estimate has no curve.
    OutputError
        If the file exists and `overwrite` is false, or it cannot be written.
    """
    provenance = {
        "outcome": str(estimate.outcome),
        "estimator": estimate.estimator,
        "version": __version__,
    }
    if estimate.confidence is not None:
        provenance["confidence"] = str(estimate.confidence.verdict)
    rows = linear_rows(photo, curve_lookup(estimate.curve), half=half)
    return write_exr(
        path,
        photo.encoded if photo.scene_linear else rows,
        photo,
        provenance=provenance,
        half=half,
        compression=compression,
        overwrite=overwrite,
    )
