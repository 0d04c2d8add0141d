"""From a photo and its estimate to a scene-linear EXR that says where it comes from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from facecrf_ocio.color.primaries import known_primaries
from facecrf_ocio.color.working_space import working_primaries, working_space_matrix
from facecrf_ocio.image.apply import BEYOND_HALF, Pixels, Rows, WrittenExr, linear_rows, write_exr
from facecrf_ocio.image.compression import COMPRESSION
from facecrf_ocio.image.exposure import Exposure, find_exposure
from facecrf_ocio.image.lookup import curve_lookup
from facecrf_ocio.image.lut_lookup import lut_lookup
from facecrf_ocio.image.uncertainty import CHANNEL, sigma_rows
from facecrf_ocio.record.provenance import of_estimate, of_lut
from facecrf_ocio.values import Estimate, Photo, Primaries


def write_linear(
    path: Path,
    photo: Photo,
    estimate: Estimate,
    *,
    space: str = "",
    exposure: str | Exposure = "0",
    uncertainty: bool = False,
    half: bool = True,
    **file: Any,
) -> WrittenExr:
    """Send a photo through its estimated curve and write the result; see `apply.write_exr`.

    With `space`, one of `color.working_space.WORKING_SPACES`, a matrix from the photo's primaries
    (Rec.709 where they are not known) follows the curve. `exposure`, as `find_exposure` takes or
    gives it, scales the light; the curve stays as it is, and the file tells the stops. With
    `uncertainty` a channel more, `uncertainty.CHANNEL`, says how far each pixel's light may be off.
    `half` and `file` (`compression`, `overwrite`) are as `write_exr` takes them.

    Raises
    ------
    NotCalibratedError
        If the estimate has no curve.
    OutputError
        If the file exists and `overwrite` is false, or it cannot be written.
    SettingsError
        If the exposure is not known, or there is no uncertainty to write.
    PhotoError
        If the exposure is by a cheek and there is none.
    """
    provenance = of_estimate(photo, estimate)
    if isinstance(exposure, str):
        exposure = find_exposure(exposure, photo, estimate.curve)
    stops = exposure.stops
    # What is computed with further wants more than half floats.
    exact = half and not space and not stops
    rows = linear_rows(photo, curve_lookup(estimate.curve), half=exact)
    linear: Pixels | Rows = photo.encoded if photo.scene_linear else rows
    if stops:
        linear = _scaled(linear, 2.0**stops)
        provenance = {**provenance, "exposure": f"{stops:+.3f} stops ({exposure.told})"}
    if photo.named_curve:
        photo = photo.but(primaries=_of_display(photo))
    beside = {CHANNEL: sigma_rows(photo, estimate, 2.0**stops)} if uncertainty else None
    if space:
        linear, photo = _in_space(linear, photo, space)
    return write_exr(
        path,
        linear,
        photo,
        provenance=provenance,
        half=half,
        beside=beside,
        **file,
    )


def write_through_lut(
    path: Path,
    photo: Photo,
    lut: Path,
    *,
    direction: str | None = None,
    half: bool = True,
    compression: str = COMPRESSION,
    overwrite: bool = False,
) -> WrittenExr:
    """Send a photo through a LUT file and write the result; see `apply.write_exr`.

    Parameters
    ----------
    direction
        See `lut_lookup.lut_lookup`, which also says what color space comes out.

    Raises
    ------
    LutError
        As `lut_lookup.lut_lookup` does, or if codes become NaN or infinite.
    OutputError
        If the file exists and `overwrite` is false, or it cannot be written.
    """
    lookup = lut_lookup(lut, direction)
    written = write_exr(
        path,
        linear_rows(photo, lookup, half=half),
        photo.but(primaries=lookup.leads_to(photo.primaries)),
        provenance=of_lut(photo, lut, direction or "linearize"),
        half=half,
        compression=compression,
        overwrite=overwrite,
    )
    return replace(written, notes=(BEYOND_HALF,)) if lookup.has_cut else written


def _scaled(linear: Pixels | Rows, factor: float) -> Rows:
    def rows(begin: int, end: int) -> Pixels:
        band = linear(begin, end) if callable(linear) else linear[begin:end]
        return np.asarray(band * np.float32(factor))

    return rows


def _of_display(photo: Photo) -> Primaries:
    """Primaries under another name: no color space of scene light is to be told by them."""
    primaries = photo.primaries or known_primaries("Rec.709", "assumed")
    return replace(primaries, name=f"{primaries.name} ({photo.named_curve} light)")


def _in_space(linear: Pixels | Rows, photo: Photo, space: str) -> tuple[Rows, Photo]:
    """Rows in a working space, and the photo as if its primaries were that space's."""
    matrix = working_space_matrix(photo.primaries, space)

    def rows(begin: int, end: int) -> Pixels:
        band = linear(begin, end) if callable(linear) else linear[begin:end]
        return np.asarray(cv2.transform(band, matrix))

    before = "assumed Rec.709" if photo.primaries is None else photo.primaries.name
    primaries = replace(working_primaries(space), source=f"conversion from {before}")
    return rows, photo.but(primaries=primaries)
