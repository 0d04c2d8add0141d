"""What is shown of one photo: small and large pictures, its curve, and what to expect of it."""

from __future__ import annotations

import base64
from dataclasses import dataclass, replace
from io import BytesIO

import cv2
import numpy as np
from PIL import Image

from facecrf_ocio.archive.report.small_curves import DrawnCurve, drawn
from facecrf_ocio.color.srgb import encode_srgb
from facecrf_ocio.image.lookup import curve_lookup
from facecrf_ocio.photo.pixels import Pixels, code_values
from facecrf_ocio.values import Estimate, InverseCRF, Outcome
from facecrf_ocio.wording.next_steps import next_steps
from facecrf_ocio.wording.sentence import ARCHIVE, Surface, expected, sentence

SIDE = 96
"""[pixel] Longer side of a thumbnail."""

QUALITY = 60
"""Of WebP: at this size a better one cannot be told apart on a screen."""

LARGE_QUALITY = 78
"""Of WebP: large pictures are looked at three stops up, where a lower one shows its blocks."""


@dataclass(frozen=True, slots=True)
class Pictures:
    """What is shown of a photo.

    Attributes
    ----------
    before, after
        Base64 of WebP; empty where there is none.
    large
        The same at a size to compare them at; empty where there is none.
    missing
        Why a picture is missing; empty if none is.
    curve
        The curve, if there is one.
    faces
        Number of faces used.
    expected
        [stop] Expected error over codes 64 to 235, and in the shadows; None where it is not known.
    line, sentence, steps
        What to expect of the curve; the same with what would make it surer; what to do next.
    files
        Names of the files that were written of the photo.
    """

    before: str = ""
    after: str = ""
    large: tuple[str, str] | None = None
    missing: str = ""
    curve: DrawnCurve | None = None
    faces: int = 0
    expected: tuple[float, float] | None = None
    line: str = ""
    sentence: str = ""
    steps: tuple[str, ...] = ()
    files: tuple[str, ...] = ()


def told(estimate: Estimate, files: tuple[str, ...] = (), surface: Surface = ARCHIVE) -> Pictures:
    """What an estimate says, still without pictures."""
    return Pictures(
        curve=_curve(estimate),
        faces=len(estimate.faces),
        expected=_in_stops(estimate),
        line=expected(estimate),
        sentence=sentence(estimate, surface),
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
    light = encoded if linear else None
    if inverse is not None and light is None:
        light = curve_lookup(inverse).apply(_shrunk(encoded, 2 * max(SIDE, large)))

    def pair(side: int, quality: int) -> tuple[str, str]:
        after = "" if light is None else _shown_light(light, side, quality)
        return after if linear else _webp(encoded, side, quality), after

    before, after = pair(SIDE, QUALITY)
    both = pair(large, LARGE_QUALITY) if large else None
    return replace(shown, before=before, after=after, large=both)


def _curve(estimate: Estimate) -> DrawnCurve | None:
    if estimate.found is None or estimate.confidence is None:
        return None
    return drawn(estimate.found, estimate.confidence.sigma, estimate.confidence.in_stops)


def _in_stops(estimate: Estimate) -> tuple[float, float] | None:
    stops = None if estimate.confidence is None else estimate.confidence.in_stops
    return None if stops is None else (stops.mid, stops.shadows)


def is_linear(estimate: Estimate) -> bool:
    """Whether the photo's values are light as they are."""
    return estimate.outcome is Outcome.ALREADY_LINEAR


def _shown_light(light: Pixels, side: int, quality: int) -> str:
    return _webp(encode_srgb(_shrunk(light, side)).astype(np.float32), side, quality)


def _shrunk(image: Pixels, side: int) -> Pixels:
    """Average over areas until the longer side is `side`; a smaller image stays as it is."""
    height, width = image.shape[:2]
    scale = side / max(height, width)
    if scale >= 1.0:
        return image
    size = (max(round(width * scale), 1), max(round(height * scale), 1))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), image.dtype)


def _webp(encoded: Pixels, side: int, quality: int) -> str:
    values = code_values(encoded, 8) if encoded.dtype == np.uint8 else encoded
    codes = np.rint(255.0 * np.clip(_shrunk(values, side), 0.0, 1.0)).astype(np.uint8)
    content = BytesIO()
    Image.fromarray(codes).save(content, "WEBP", quality=quality, method=4)
    return base64.b64encode(content.getvalue()).decode()
