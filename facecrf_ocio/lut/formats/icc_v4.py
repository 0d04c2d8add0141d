"""ICC input profile, version 4, that also holds the curve in 32-bit floats (.v4.icc).

Its 16-bit curves and matrix are those of version 2, for readers that know no more (darktable,
OpenColorIO). Tags D2B0 to D2B3 (ICC.1:2022, 10.16) hold curve and matrix as floats; littleCMS
prefers them, whatever the pixels' type, and with them is within 3.3e-7 of white where the 16-bit
curves are 2e-5 off (of a power of 2.4, at code 2 of 255, 1e-7 of the value instead of 0.7). Neither
parametric curves, which no measured response follows, nor AToB tables, whose 16-bit curves would
precede a power function (1e-3), come near.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Sequence

from facecrf_ocio.lut.comments import remark
from facecrf_ocio.lut.formats.icc import (
    CONNECTION_WHITE,
    COPYRIGHT,
    DESCRIPTION,
    adaptation,
    assemble,
    colorants,
    fixed_point,
    matrix_and_curves,
    xyz_tag,
)
from facecrf_ocio.lut.table import lut_table
from facecrf_ocio.lut.transform import LutTransform
from facecrf_ocio.values import Float, InverseCRF, Primaries


def icc_v4_bytes(transform: LutTransform, comments: Sequence[str] = ()) -> bytes:
    """Return a profile's bytes (ICC.1:2022); primaries that are not known stand for Rec.709."""
    floats = _elements(transform.curve, transform.primaries)
    text = "\n".join((COPYRIGHT, *map(remark, comments)))
    tags = {
        b"desc": _localized(DESCRIPTION),
        b"cprt": _localized(text),
        b"wtpt": xyz_tag(CONNECTION_WHITE),
        b"chad": b"sf32" + bytes(4) + fixed_point(adaptation(transform.primaries)),
        **matrix_and_curves(transform),
        # All intents are alike: absolute and relative differ by the media's white, here D50.
        **dict.fromkeys((b"D2B0", b"D2B1", b"D2B2", b"D2B3"), floats),
    }
    return _identified(assemble(tags, version=0x04400000))


def _elements(curve: InverseCRF, primaries: Primaries | None) -> bytes:
    """Curves, then a matrix to CIE XYZ, as multiProcessElementsType."""
    curves = [_segmented(channel) for channel in lut_table(curve).T]
    steps = [
        _with_positions(b"cvst" + bytes(4) + struct.pack(">HH", 3, 3), curves),
        b"matf"
        + bytes(4)
        + struct.pack(">HH", 3, 3)
        + colorants(primaries).astype(">f4").tobytes()
        + bytes(12),
    ]
    return _with_positions(b"mpet" + bytes(4) + struct.pack(">HHI", 3, 3, len(steps)), steps)


def _segmented(table: Float) -> bytes:
    """A curve: 0 up to code 0, the table up to code 1, then 1."""
    samples = table[1:].astype(">f4")  # the first is the end of the segment before
    return (
        b"curf"
        + bytes(4)
        + struct.pack(">HHff", 3, 0, 0.0, 1.0)
        + _constant(0.0)
        + b"samf"
        + bytes(4)
        + struct.pack(">I", samples.size)
        + samples.tobytes()
        + _constant(1.0)
    )


def _constant(value: float) -> bytes:
    """The formula (0 x + 0)^1 + value."""
    return b"parf" + bytes(4) + struct.pack(">HHffff", 0, 0, 1.0, 0.0, 0.0, value)


def _with_positions(head: bytes, parts: Sequence[bytes]) -> bytes:
    """A head, the parts' offsets from its start and sizes, then the parts."""
    positions, body = b"", b""
    start = len(head) + 8 * len(parts)
    for part in parts:
        positions += struct.pack(">II", start + len(body), len(part))
        body += part + bytes(-len(part) % 4)
    return head + positions + body


def _localized(text: str) -> bytes:
    """One text in American English, as multiLocalizedUnicodeType."""
    encoded = text.encode("utf-16-be", "backslashreplace")
    return b"mluc" + bytes(4) + struct.pack(">II4sII", 1, 12, b"enUS", len(encoded), 28) + encoded


def _identified(profile: bytes) -> bytes:
    """The profile with its ID: the MD5 of all but flags, intent and the ID (7.2.18)."""
    blank = bytearray(profile)
    for start, end in ((44, 48), (64, 68), (84, 100)):
        blank[start:end] = bytes(end - start)
    digest = hashlib.md5(blank, usedforsecurity=False).digest()
    return profile[:84] + digest + profile[100:]
