"""ICC input profile, version 2, with one 16-bit curve per channel (.icc).

For darktable, RawTherapee and GIMP. The format's curves are 16-bit: where the curve is nearly flat,
as it is near black, an entry is off by up to half of 1/65535 of white. `icc_v4` adds floats.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence

import numpy as np

from facecrf_ocio.color.adaptation import bradford, rgb_to_xyz
from facecrf_ocio.color.primaries import KNOWN_PRIMARIES
from facecrf_ocio.lut.comments import remark
from facecrf_ocio.lut.table import resample
from facecrf_ocio.lut.transform import LutTransform
from facecrf_ocio.values import Float, InverseCRF, Primaries

# The profile connection space's white, X and Z with Y = 1 (ICC.1:2022, 7.2.16).
CONNECTION_WHITE = np.array([0.9642, 1.0, 0.8249])
DESCRIPTION = "Inverse camera response of one photo"
COPYRIGHT = "No copyright is claimed in these measurements"
_HEADER_SIZE = 128  # [byte] by ICC.1, 7.2


def icc_bytes(transform: LutTransform, comments: Sequence[str] = ()) -> bytes:
    """Return a profile's bytes (ICC.1:2001-04); primaries that are not known stand for Rec.709."""
    text = "\n".join((COPYRIGHT, DESCRIPTION, *map(remark, comments)))
    tags = {
        b"desc": _description(DESCRIPTION),
        b"cprt": _text(text),
        b"wtpt": xyz_tag(CONNECTION_WHITE),
        **matrix_and_curves(transform),
    }
    return assemble(tags, version=0x02400000)


def colorants(primaries: Primaries | None) -> Float:
    """Matrix (3, 3) from linear RGB to CIE XYZ of D50, adapted with Bradford's matrix."""
    if primaries is None:
        *rgb, white = KNOWN_PRIMARIES["Rec.709"]
    else:
        rgb, white = [primaries.red, primaries.green, primaries.blue], primaries.white
    return np.asarray(adaptation(primaries) @ rgb_to_xyz(rgb, white))


def adaptation(primaries: Primaries | None) -> Float:
    """Bradford's matrix (3, 3) from the primaries' white to the connection space's."""
    white = KNOWN_PRIMARIES["Rec.709"][3] if primaries is None else primaries.white
    total = float(CONNECTION_WHITE.sum())
    d50 = (float(CONNECTION_WHITE[0]) / total, float(CONNECTION_WHITE[1]) / total)
    return np.asarray(bradford(white, d50))


def curve_codes(curve: InverseCRF) -> Float:
    """(3, 4096) integers from 0 to 65535 that a profile's curves hold."""
    return np.asarray(np.rint(resample(curve) * 65535.0))


def matrix_and_curves(transform: LutTransform) -> dict[bytes, bytes]:
    """The tags of a matrix profile, by which every reader of ICC profiles can go."""
    columns = colorants(transform.primaries)
    return {
        **{name: xyz_tag(columns[:, i]) for i, name in enumerate((b"rXYZ", b"gXYZ", b"bXYZ"))},
        **dict(zip((b"rTRC", b"gTRC", b"bTRC"), _curves(transform.curve), strict=True)),
    }


def xyz_tag(values: Float) -> bytes:
    """One CIE XYZ, (3,), as a tag's content."""
    return b"XYZ " + bytes(4) + fixed_point(values)


def fixed_point(values: Float) -> bytes:
    """Numbers as s15Fixed16, in the array's order."""
    return bytes(np.rint(np.ravel(values) * 65536.0).astype(">i4").tobytes())


def assemble(tags: Mapping[bytes, bytes], version: int) -> bytes:
    """A profile of tags by signature; equal contents are stored once, as the standard allows."""
    start = _HEADER_SIZE + 4 + 12 * len(tags)
    places: dict[bytes, int] = {}
    directory, body = struct.pack(">I", len(tags)), b""
    for signature, data in tags.items():
        if data not in places:
            places[data] = start + len(body)
            body += data + bytes(-len(data) % 4)
        directory += signature + struct.pack(">II", places[data], len(data))
    header = (
        struct.pack(">I4sI", start + len(body), bytes(4), version)
        + b"scnrRGB XYZ "
        + struct.pack(">6H", 2000, 1, 1, 0, 0, 0)  # fixed, so that equal curves make equal files
        + b"acsp"
        + bytes(28)
        + fixed_point(CONNECTION_WHITE)
    )
    return header.ljust(_HEADER_SIZE, b"\0") + directory + body


def _curves(curve: InverseCRF) -> list[bytes]:
    return [
        b"curv" + bytes(4) + struct.pack(">I", codes.size) + codes.astype(">u2").tobytes()
        for codes in curve_codes(curve)
    ]


def _text(text: str) -> bytes:
    return b"text" + bytes(4) + text.encode("ascii", "backslashreplace") + b"\0"


def _description(text: str) -> bytes:
    ascii_text = text.encode("ascii") + b"\0"
    return (
        b"desc" + bytes(4) + struct.pack(">I", len(ascii_text)) + ascii_text + bytes(4 + 4 + 3 + 67)
    )
