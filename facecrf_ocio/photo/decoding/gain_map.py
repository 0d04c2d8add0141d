"""The gain map of a photo: found in the file, and what it says taken at its word or set aside.

Ultra HDR and Adobe describe it in XMP, ISO 21496-1 in bytes, Apple in XMP and maker notes.
"""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import cv2
import numpy as np

from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.photo.containers.integrity import MAX_MEGAPIXELS
from facecrf_ocio.photo.containers.jpeg_segments import JpegParts, take_apart
from facecrf_ocio.photo.decoding.orientation import upright
from facecrf_ocio.photo.raster.pixels import code_values, three_channels
from facecrf_ocio.photo.tags.exif import apple_headroom, load_exif
from facecrf_ocio.photo.tags.profile import primaries_from_icc
from facecrf_ocio.photo.tags.xmp import value_of, values_of, xmp_of
from facecrf_ocio.values import Float, GainMap, Primaries

_ISO = b"urn:iso:std:iso:ts:21496:-1\0"
APPLE = "urn:com:apple:photo:2020:aux:hdrgainmap"
# Flags of ISO 21496-1, annex C, as libultrahdr has them.
_SEVERAL, _BASE_SPACE, _COMMON_DENOMINATOR = 0x80, 0x40, 0x08
_MOST_PICTURES = 8  # looked at in what follows the photo; phones append two or three
_MOST_STOPS = 16.0
"""[stop] of gain; float16 ends at 16, and phones write 2 to 6."""
_MOST_OFFSET = 64.0  # [white] a map of Adobe's has 6.7


class GainMapError(ValueError):
    """A map is there, but of no use; says why."""


def jpeg_gain_map(jpeg: JpegParts, orientation: int) -> tuple[GainMap | None, tuple[str, ...]]:
    """Gain map among the pictures after a JPEG's first, and a note if it was set aside.

    Parameters
    ----------
    jpeg
        The file.
    orientation
        By which the photo, and so the map, is turned upright.
    """
    exif = b"".join(jpeg.contents(0xE1, b"Exif\0\0")[:1])
    try:
        for picture in _pictures_after(jpeg):
            numbers = _numbers(picture, exif)
            if numbers is not None:
                found = GainMap(upright(_decoded(picture), orientation), *numbers)
                return replace(found, base=jpeg.picture, orientation=orientation), ()
    except struct.error:
        return None, ("its gain map was set aside: its numbers are cut short",)
    except ZeroDivisionError:
        return None, ("its gain map was set aside: its numbers make no sense",)
    except (GainMapError, ValueError, cv2.error) as error:
        return None, (f"its gain map was set aside: {plain_text(error)}",)
    return None, _missed(jpeg)


def _missed(jpeg: JpegParts) -> tuple[str, ...]:
    """What to say of a map that is announced, and not there or without its numbers."""
    if any(value_of(xmp_of(b"", one), "hdrgm:Version") for one in _pictures_after(jpeg)):
        return ("its gain map was set aside: it does not say how far it brightens",)
    if re.search(r"""Semantic\s*=\s*["']GainMap["']""", xmp_of(b"", jpeg)):
        return ("the gain map that it announces is missing: cut off, or left out by a program",)
    return ()


def _pictures_after(jpeg: JpegParts) -> Iterator[JpegParts]:
    rest = jpeg.rest
    for _ in range(_MOST_PICTURES):
        start = rest.find(b"\xff\xd8\xff")
        parts = take_apart(rest[start:]) if start >= 0 else None
        if parts is None:
            return
        yield parts
        rest = parts.rest


def _decoded(picture: JpegParts) -> Any:
    width, height = picture.size
    if width * height == 0 or width * height > MAX_MEGAPIXELS * 1e6:
        raise GainMapError(f"it claims {width} x {height} pixels")
    flags = cv2.IMREAD_ANYCOLOR | cv2.IMREAD_IGNORE_ORIENTATION
    if not picture.ended:
        raise GainMapError("it is cut short")
    codes = cv2.imdecode(np.frombuffer(picture.picture, np.uint8), flags)
    if codes is None:
        raise GainMapError("it is damaged")
    colors = three_channels(np.asarray(codes))
    return code_values(np.ascontiguousarray(colors[..., ::-1]), 8)


def _numbers(picture: JpegParts, exif: bytes) -> tuple[Any, ...] | None:
    """All of a `GainMap` but its values; None where the picture is no gain map."""
    binary = picture.contents(0xE2, _ISO)
    if binary and len(binary[0]) > 4:
        own = _primaries(picture)
        applied = None if binary[0][4] & _BASE_SPACE else own
        return (*_of_iso(binary[0]), "ISO 21496-1", applied, own)
    xmp = xmp_of(b"", picture)
    if values_of(xmp, "hdrgm:GainMapMax"):
        return (*_of_xmp(xmp), "Ultra HDR", None, _primaries(picture))
    if APPLE in xmp:
        told = value_of(xmp, "HDRGainMap:HDRGainMapHeadroom")
        return apple_numbers(told, 0.0 if told else apple_headroom(load_exif(exif)))
    return None


def _primaries(picture: JpegParts) -> Primaries | None:
    """Those of the rendition, which the profile of the map tells."""
    profiles = picture.contents(0xE2, b"ICC_PROFILE\0")
    return primaries_from_icc(profiles[0][2:]) if profiles else None


def _of_xmp(xmp: str) -> tuple[Float, ...]:
    """Adobe's gain map specification 1.0, XMP; what is left out has a default there."""
    if value_of(xmp, "hdrgm:BaseRenditionIsHDR").lower() == "true":
        raise GainMapError("the photo itself is the HDR rendition")

    def three(name: str, default: float) -> Float:
        return _three([float(text) for text in values_of(xmp, f"hdrgm:{name}")] or [default])

    return _checked(
        three("GainMapMin", 0.0),
        three("GainMapMax", math.nan),
        three("Gamma", 1.0),
        three("OffsetSDR", 1 / 64),
        three("OffsetHDR", 1 / 64),
    )


def _of_iso(said: bytes) -> tuple[Float, ...]:
    """ISO 21496-1, annex C: versions, flags, headrooms, and five fractions a channel."""
    least, flags = struct.unpack_from(">HxxB", said)
    if least:
        raise GainMapError(f"it asks for readers of version {least}")
    count = 3 if flags & _SEVERAL else 1
    if flags & _COMMON_DENOMINATOR:
        common, base, _ = struct.unpack_from(">3I", said, 5)
        kinds = struct.unpack_from(">" + "iiIii" * count, said, 17)
        fractions = [number / common for number in kinds]
    else:
        base = struct.unpack_from(">I", said, 5)[0]
        pairs = struct.unpack_from(">" + "iIiIIIiIiI" * count, said, 21)
        fractions = [top / bottom for top, bottom in zip(pairs[::2], pairs[1::2], strict=True)]
    if base:
        raise GainMapError("the photo itself is the HDR rendition")
    columns = np.reshape(fractions, (count, 5)).T
    return _checked(*(_three(column) for column in columns))


def item_numbers(said: bytes, rendition: Primaries | None) -> tuple[Any, ...]:
    """All of a `GainMap` but its values, by what the item `tmap` of a HEIF says."""
    numbers = _of_iso(said)
    return (*numbers, "ISO 21496-1", None if said[4] & _BASE_SPACE else rendition, rendition)


def apple_numbers(told: str, headroom: float) -> tuple[Any, ...]:
    """Apple's map, from the headroom that its XMP tells, else from that of the maker notes."""
    white = float(told) if told else headroom
    if not 1.0 < white < 2**_MOST_STOPS:
        raise GainMapError("nothing tells how bright it makes white")
    stops = np.full(3, math.log2(white))
    zero, one = np.zeros(3), np.ones(3)
    return zero, stops, one, zero, zero, "Apple"


def _three(numbers: Any) -> Float:
    values = np.asarray(numbers, float)
    if values.size not in (1, 3):
        raise GainMapError(f"it has {values.size} numbers where one or three belong")
    return np.broadcast_to(values, (3,)).copy()


def _checked(*given: Float) -> tuple[Float, ...]:
    low, high, gamma, base_offset, offset = numbers = np.array(given)
    sound = np.isfinite(numbers).all() and (gamma > 0).all() and (high >= low).all()
    # Below 0 libultrahdr refuses offsets.
    sound &= min(base_offset.min(), offset.min()) >= 0 and base_offset.max() <= _MOST_OFFSET
    if not sound or np.abs([low, high]).max() > _MOST_STOPS:
        raise GainMapError("its numbers make no sense")
    if ((1 + base_offset) * 2**high <= offset).any():
        raise GainMapError("it leaves nothing of the light")
    return given
