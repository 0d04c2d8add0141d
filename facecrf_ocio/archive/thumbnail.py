"""A photo as small pictures, as it is and as light by its curve: made once, kept, and shown."""

from __future__ import annotations

from io import BytesIO

import cv2
import numpy as np
from PIL import Image

from facecrf_ocio.archive.task import Thumbnail
from facecrf_ocio.color.srgb import encode_srgb
from facecrf_ocio.image.lookup import curve_lookup
from facecrf_ocio.photo.raster.halves import halved
from facecrf_ocio.photo.raster.pixels import Pixels, code_values
from facecrf_ocio.values import Estimate, InverseCRF, Outcome, Photo

SIDE = 96
"""[pixel] Longer side of a thumbnail."""

QUALITY = 60
"""Of WebP: at this size a better one cannot be told apart on a screen."""

EFFORT = 2
"""Of WebP, from 0 to 6, in trying what takes fewer bytes: 4 takes 3 % less, and twice the time."""


def is_linear(estimate: Estimate) -> bool:
    """Whether the photo's values are light as they are."""
    return estimate.outcome is Outcome.ALREADY_LINEAR


def thumbnail_of(photo: Photo, estimate: Estimate | None) -> Thumbnail:
    """The thumbnail of a photo, with its curve if there is one; empty if it cannot be made."""
    inverse = None if estimate is None else estimate.found
    linear = estimate is not None and is_linear(estimate)
    try:
        small = shrunk(_reduced(photo.pixels, 2 * SIDE), 2 * SIDE)
        return Thumbnail(*webps(small, light_of(small, inverse, linear=linear), linear=linear))
    except Exception:  # the report tries again; nobody's curve may be lost for it
        return Thumbnail(b"")


def light_of(encoded: Pixels, inverse: InverseCRF | None, *, linear: bool) -> Pixels | None:
    """(H, W, 3) linear light of a photo's values; None without a curve."""
    if linear:
        return encoded
    return None if inverse is None else curve_lookup(inverse).apply(encoded)


def webps(
    encoded: Pixels,
    light: Pixels | None,
    side: int = SIDE,
    quality: int = QUALITY,
    *,
    linear: bool,
) -> tuple[bytes, bytes]:
    """A photo before and after as WebP, the second empty without light.

    Parameters
    ----------
    encoded, light
        (H, W, 3) its values and its light.
    side
        [pixel] Longer side, unless the photo is smaller.
    quality
        Of WebP.
    linear
        Whether its values are light, so that both show the same.
    """
    after = b""
    if light is not None:
        after = _webp(encode_srgb(shrunk(light, side)).astype(np.float32), side, quality)
    return after if linear else _webp(encoded, side, quality), after


def shrunk(image: Pixels, side: int) -> Pixels:
    """Average over areas until the longer side is `side`; a smaller image stays as it is."""
    height, width = image.shape[:2]
    scale = side / max(height, width)
    if scale >= 1.0:
        return image
    size = (max(round(width * scale), 1), max(round(height * scale), 1))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), image.dtype)


def _reduced(image: Pixels, least: int) -> Pixels:
    """Halved while the longer side keeps `least`: a fifth of the time of `shrunk`."""
    times = max(0, (max(image.shape[:2]) // least).bit_length() - 1)
    largest = min(image.shape[:2]).bit_length() - 1  # of which a pixel is left
    return halved(image, min(times, largest))


def _webp(encoded: Pixels, side: int, quality: int) -> bytes:
    values = code_values(encoded, 8) if encoded.dtype == np.uint8 else encoded
    codes = np.rint(255.0 * np.clip(shrunk(values, side), 0.0, 1.0)).astype(np.uint8)
    content = BytesIO()
    Image.fromarray(codes).save(content, "WEBP", quality=quality, method=EFFORT)
    return content.getvalue()
