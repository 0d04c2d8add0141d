"""EXIF where OpenImageIO does not read the file: the camera, and Apple's maker notes."""

from __future__ import annotations

import struct
from typing import Any

from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.photo.tags.unwarned import unwarned
from facecrf_ocio.values import Camera

_EXIF_DIRECTORY, _MAKER_NOTES = 0x8769, 0x927C  # tags (EXIF 2.32, sec. 4.6)
_MAKE, _MODEL, _SOFTWARE, _BODY_SERIAL = 271, 272, 305, 0xA431  # tags (EXIF 2.32, sec. 4.6)
_CUSTOM_RENDERED = 0xA401  # tag (EXIF 2.32, sec. 4.6)
_APPLE, _APPLE_START = b"Apple iOS\0", 14  # [byte] then a directory, in the order of byte 12
_SIGNED_FRACTION = 10  # type SRATIONAL of TIFF 6.0


def load_exif(content: bytes) -> Any:
    """Pillow's tags of EXIF bytes; empty where they are damaged."""
    from PIL import Image  # noqa: PLC0415 - only where EXIF is asked for

    exif = Image.Exif()
    try:
        with unwarned():
            exif.load(content)
    except (OSError, SyntaxError, ValueError, struct.error):
        return Image.Exif()
    return exif


def camera_of(exif: Any) -> Camera:
    """What EXIF tells of the camera."""
    serial = _directory(exif).get(_BODY_SERIAL, "")
    told = (*(exif.get(tag, "") for tag in (_MAKE, _MODEL)), serial, exif.get(_SOFTWARE, ""))
    return Camera(*(plain_text(text) for text in told))


def custom_rendered(exif: Any) -> int:
    """What EXIF tells of processing beyond the usual; 0 is the usual."""
    told = _directory(exif).get(_CUSTOM_RENDERED, 0)
    return told if isinstance(told, int) else 0


def apple_headroom(exif: Any) -> float:
    """How many times as bright as white an iPhone's gain map gets; 0 where EXIF does not tell.

    Apple, "Applying Apple HDR effect to your photos": from the maker notes 33 and 48. Where one
    is missing, as 48 is on an iPhone 13 Pro, it counts as 0; so libultrahdr has it.
    """
    notes = _directory(exif).get(_MAKER_NOTES, b"")
    told = tuple(_apple_fraction(notes, tag) for tag in (33, 48))
    if told == (None, None):
        return 0.0
    first, second = (one or 0.0 for one in told)
    steep, flat = ((-20.0, 1.8), (-0.101, 1.601)) if first < 1 else ((-70.0, 3.0), (-0.303, 2.303))
    slope, start = steep if second <= 0.01 else flat
    return float(2 ** max(slope * second + start, 0.0))


def _directory(exif: Any) -> Any:
    try:
        return exif.get_ifd(_EXIF_DIRECTORY)
    except (OSError, SyntaxError, ValueError, struct.error, KeyError):
        return {}


def _apple_fraction(notes: object, tag: int) -> float | None:
    """A signed fraction of Apple's maker notes, whose offsets count from their start."""
    if not isinstance(notes, bytes) or not notes.startswith(_APPLE):
        return None
    order = "<" if notes[12:14] == b"II" else ">"
    try:
        (count,) = struct.unpack_from(order + "H", notes, _APPLE_START)
        for at in range(_APPLE_START + 2, _APPLE_START + 2 + 12 * count, 12):
            found, kind, _, place = struct.unpack_from(order + "HHII", notes, at)
            if (found, kind) == (tag, _SIGNED_FRACTION):
                top, bottom = struct.unpack_from(order + "ii", notes, place)
                return float(top / bottom) if bottom else None
    except struct.error:
        return None
    return None
