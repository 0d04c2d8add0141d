"""From a photo and its estimate to a scene-linear EXR that says where it comes from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from facecrf_ocio import __version__
from facecrf_ocio.color.working_space import working_primaries, working_space_matrix
from facecrf_ocio.image.apply import Pixels, Rows, linear_rows, write_exr
from facecrf_ocio.image.lookup import curve_lookup
from facecrf_ocio.values import Estimate, Photo
from facecrf_ocio.wording.sentence import sentence


def write_linear(
    path: Path,
    photo: Photo,
    estimate: Estimate,
    *,
    space: str = "",
    half: bool = True,
    compression: str = "zip",
    overwrite: bool = False,
) -> Path:
    """Send a photo through its estimated curve and write the result; see `apply.write_exr`.

    With `space`, one of `color.working_space.WORKING_SPACES`, a matrix from the photo's primaries
    (Rec.709 where they are not known) follows the curve.

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
        provenance["summary"] = sentence(estimate)
    # A matrix wants more than half floats of what it is given.
    rows = linear_rows(photo, curve_lookup(estimate.curve), half=half and not space)
    linear: Pixels | Rows = photo.encoded if photo.scene_linear else rows
    if space:
        linear, photo = _in_space(linear, photo, space)
    return write_exr(
        path,
        linear,
        photo,
        provenance=provenance,
        half=half,
        compression=compression,
        overwrite=overwrite,
    )


def _in_space(linear: Pixels | Rows, photo: Photo, space: str) -> tuple[Rows, Photo]:
    """Rows in a working space, and the photo as if its primaries were that space's."""
    matrix = working_space_matrix(photo.primaries, space)

    def rows(begin: int, end: int) -> Pixels:
        band = linear(begin, end) if callable(linear) else linear[begin:end]
        return np.asarray(cv2.transform(band, matrix))

    before = "assumed Rec.709" if photo.primaries is None else photo.primaries.name
    primaries = replace(working_primaries(space), source=f"conversion from {before}")
    return rows, replace(photo, primaries=primaries)
