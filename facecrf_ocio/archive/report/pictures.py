"""What is shown of one photo: small and large pictures, its curve, and what to expect of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from facecrf_ocio.archive.report.small_curves import DrawnCurve, drawn
from facecrf_ocio.archive.task import Thumbnail
from facecrf_ocio.archive.thumbnail import QUALITY, SIDE, light_of, shrunk, webps
from facecrf_ocio.photo.raster.pixels import Pixels
from facecrf_ocio.values import Estimate, InverseCRF
from facecrf_ocio.wording.next_steps import next_steps
from facecrf_ocio.wording.sentence import ARCHIVE, Surface, expected

LARGE_QUALITY = 78
"""Of WebP: large pictures are looked at three stops up, where a lower one shows its blocks."""


@dataclass(frozen=True, slots=True)
class Pictures:
    """What is shown of a photo.

    Attributes
    ----------
    small
        WebP, before and after; None where there is none.
    large
        The same at a size to compare them at; None where there is none.
    missing
        Why a picture is missing; empty if none is.
    curve
        The curve, if there is one.
    faces
        Number of faces used.
    expected
        [stop] Expected error over codes 64 to 235, and in the shadows; None where it is not known.
    line, steps
        What to expect of the curve; what to do next.
    files
        Names of the files that were written of the photo.
    """

    small: Thumbnail | None = None
    large: Thumbnail | None = None
    missing: str = ""
    curve: DrawnCurve | None = None
    faces: int = 0
    expected: tuple[float, float] | None = None
    line: str = ""
    steps: tuple[str, ...] = ()
    files: tuple[str, ...] = ()


def told(estimate: Estimate, files: tuple[str, ...] = (), surface: Surface = ARCHIVE) -> Pictures:
    """What an estimate says, still without pictures."""
    return Pictures(
        curve=_curve(estimate),
        faces=len(estimate.faces),
        expected=_in_stops(estimate),
        line=expected(estimate),
        steps=next_steps(estimate, surface),
        files=files,
    )


def with_images(
    shown: Pictures, encoded: Pixels, inverse: InverseCRF | None, *, linear: bool, large: int = 0
) -> Pictures:
    """Add the pictures.

    Parameters
    ----------
    shown
        What is told of the photo.
    encoded
        (H, W, 3) its values.
    inverse
        Its curve; None if it has none.
    linear
        Whether its values are linear light already.
    large
        [pixel] Longer side of the large pictures; 0 for none.
    """
    small = encoded if linear else shrunk(encoded, 2 * max(SIDE, large))
    light = light_of(small, inverse, linear=linear)
    both = None
    if large:
        both = Thumbnail(*webps(encoded, light, large, LARGE_QUALITY, linear=linear))
    kept = Thumbnail(*webps(encoded, light, SIDE, QUALITY, linear=linear))
    return replace(shown, small=kept, large=both)


def _curve(estimate: Estimate) -> DrawnCurve | None:
    if estimate.found is None or estimate.confidence is None:
        return None
    return drawn(estimate.found, estimate.confidence.sigma, estimate.confidence.in_stops)


def _in_stops(estimate: Estimate) -> tuple[float, float] | None:
    stops = None if estimate.confidence is None else estimate.confidence.in_stops
    return None if stops is None else (stops.mid, stops.shadows)
