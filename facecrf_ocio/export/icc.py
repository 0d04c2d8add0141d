"""ICC input profile, version 2, with one 16-bit curve per channel (.icc).

For darktable, RawTherapee and GIMP. The format's curves are 16-bit: where the curve is nearly flat,
as it is near black, an entry is off by up to half of 1/65535 of white.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np

from facecrf_ocio.export.comments import one_line
from facecrf_ocio.export.recipe import Recipe
from facecrf_ocio.export.table import resample
from facecrf_ocio.export.working_space import bradford, rgb_to_xyz
from facecrf_ocio.profile import KNOWN_PRIMARIES
from facecrf_ocio.values import Float, InverseCRF, Primaries

# The profile connection space's white, X and Z with Y = 1 (ICC.1:2022, 7.2.16).
_D50 = np.array([0.9642, 1.0, 0.8249])
_HEADER_SIZE = 128


def icc_bytes(recipe: Recipe, comments: Sequence[str] = ()) -> bytes:
    """Return a profile's bytes (ICC.1:2001-04); primaries that are not known stand for Rec.709."""
    description = "Inverse camera response of one photo"
    text = "\n".join((description, *map(one_line, comments)))
    columns = colorants(recipe.primaries)
    tags = {
        b"desc": _description(description),
        b"cprt": _text("No copyright is claimed in these measurements\n" + text),
        b"wtpt": _xyz(_D50),
        **{name: _xyz(columns[:, i]) for i, name in enumerate((b"rXYZ", b"gXYZ", b"bXYZ"))},
        **dict(zip((b"rTRC", b"gTRC", b"bTRC"), _curves(recipe.curve), strict=True)),
    }
    return _assemble(tags)


def colorants(primaries: Primaries | None) -> Float:
    """Matrix (3, 3) from linear RGB to CIE XYZ of D50, adapted with Bradford's matrix."""
    if primaries is None:
        *rgb, white = KNOWN_PRIMARIES["Rec.709"]
    else:
        rgb, white = [primaries.red, primaries.green, primaries.blue], primaries.white
    total = float(_D50.sum())
    d50 = (float(_D50[0]) / total, float(_D50[1]) / total)
    return np.asarray(bradford(white, d50) @ rgb_to_xyz(rgb, white))


def curve_codes(curve: InverseCRF) -> Float:
    """(3, 4096) integers from 0 to 65535 that a profile's curves hold."""
    return np.asarray(np.rint(resample(curve) * 65535.0))


def _curves(curve: InverseCRF) -> list[bytes]:
    return [
        b"curv" + bytes(4) + struct.pack(">I", codes.size) + codes.astype(">u2").tobytes()
        for codes in curve_codes(curve)
    ]


def _xyz(values: Float) -> bytes:
    return b"XYZ " + bytes(4) + struct.pack(">3i", *(round(float(v) * 65536.0) for v in values))


def _text(text: str) -> bytes:
    return b"text" + bytes(4) + text.encode("ascii", "backslashreplace") + b"\0"


def _description(text: str) -> bytes:
    ascii_text = text.encode("ascii") + b"\0"
    return (
        b"desc" + bytes(4) + struct.pack(">I", len(ascii_text)) + ascii_text + bytes(4 + 4 + 3 + 67)
    )


def _assemble(tags: dict[bytes, bytes]) -> bytes:
    start = _HEADER_SIZE + 4 + 12 * len(tags)
    directory, body = struct.pack(">I", len(tags)), b""
    for signature, data in tags.items():
        directory += signature + struct.pack(">II", start + len(body), len(data))
        body += data + bytes(-len(data) % 4)
    header = (
        struct.pack(">I4sI", start + len(body), bytes(4), 0x02400000)
        + b"scnrRGB XYZ "
        + struct.pack(">6H", 2000, 1, 1, 0, 0, 0)  # fixed, so that equal curves make equal files
        + b"acsp"
        + bytes(28)
        + np.rint(_D50 * 65536.0).astype(">i4").tobytes()
    )
    return header.ljust(_HEADER_SIZE, b"\0") + directory + body
