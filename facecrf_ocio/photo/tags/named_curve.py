"""The curve that a file names for its code values: nothing is left to be estimated then."""

from __future__ import annotations

import struct
from collections.abc import Callable

import numpy as np

from facecrf_ocio.color.signals import decode_hlg, decode_pq
from facecrf_ocio.photo.tags.cicp import HLG, LINEAR, PQ, CodePoints
from facecrf_ocio.photo.tags.profile import icc_tag
from facecrf_ocio.values import Float

_CURVES: dict[str, Callable[[Float], Float]] = {LINEAR: np.array, PQ: decode_pq, HLG: decode_hlg}
CINEON = "Cineon log"
"""Of printing densities, as scans of negatives hold them."""
_SAME = 2e-3
"""[light, white is 1] by which a profile's table may differ from the curve it is taken for."""


def named_curve(told: CodePoints | None, icc: bytes) -> str:
    """One of `cicp.TRANSFERS`, or empty where the file names none of them.

    cICP goes before the profile (PNG, third edition, 4.3), and in the profile its tag before its
    curves (ICC.1:2022, 9.2.17).
    """
    if told is not None:
        return told.curve
    tag = icc_tag(icc, b"cicp")
    if len(tag) >= 12:
        return CodePoints(tag[8], tag[9]).curve
    return curve_of_profile(icc)


def curve_of_profile(icc: bytes) -> str:
    """Which of the curves all three of a profile's are, if any."""
    grid = np.linspace(0.0, 1.0, 257)
    curves = [_decoded(icc_tag(icc, name), grid) for name in (b"rTRC", b"gTRC", b"bTRC")]
    if any(curve is None for curve in curves):
        return ""
    for name, curve in _CURVES.items():
        if all(np.abs(light - curve(grid)).max() < _SAME for light in curves if light is not None):
            return name
    return ""


def curve_of_scan(file_format: str, transfer: str) -> str:
    """`Cineon log` of a film scan, else empty.

    Parameters
    ----------
    file_format
        As OpenImageIO calls it.
    transfer
        What a DPX says of itself (SMPTE ST 268-1, field 31). `Logarithmic` leaves the rest to who
        wrote it, who in practice meant this one.
    """
    told = file_format == "dpx" and transfer in ("Printing density", "Logarithmic")
    return CINEON if told or file_format == "cineon" else ""


def is_other_curve(icc: bytes) -> bool:
    """Whether a profile has curves, and they are none of those named here."""
    return bool(icc_tag(icc, b"rTRC")) and not curve_of_profile(icc)


def _decoded(tag: bytes, codes: Float) -> Float | None:
    """Light (K,) that a curve of a profile gives to code values (K,); None where it is damaged."""
    try:
        if tag[:4] == b"curv":
            light = _table(tag, codes)
        elif tag[:4] == b"para":
            light = _formula(tag, codes)
        else:
            return None
    except struct.error:
        return None
    return light if np.isfinite(light).all() else None


def _table(tag: bytes, codes: Float) -> Float:
    """`curv` (ICC.1:2022, 10.6): the identity, a gamma in 1/256, or samples."""
    (count,) = struct.unpack_from(">I", tag, 8)
    if count == 0:
        return codes
    if count == 1:
        return np.asarray(codes ** (struct.unpack_from(">H", tag, 12)[0] / 256))
    if len(tag) < 12 + 2 * count:
        raise struct.error("the table is cut short")
    samples = np.frombuffer(tag, ">u2", count, offset=12) / 65535
    return np.interp(codes, np.linspace(0, 1, count), samples)


def _formula(tag: bytes, codes: Float) -> Float:
    """`para` (ICC.1:2022, table 68): a power, offset and joined to a line."""
    (kind,) = struct.unpack_from(">H", tag, 8)
    count = {0: 1, 1: 3, 2: 4, 3: 5, 4: 7}.get(kind, 0)
    if count == 0:
        raise struct.error("a kind of formula that there is not")
    numbers = np.array(struct.unpack_from(f">{count}i", tag, 12)) / 65536
    g, a, b, c, d, e, f = (*numbers, *np.zeros(7 - count)) if count > 1 else (*numbers, 1, *[0] * 5)
    if kind in (1, 2):
        d = -b / a if a else np.inf
        c, e, f = 0.0, c if kind == 2 else 0.0, c if kind == 2 else 0.0
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        curved = np.maximum(a * codes + b, 0) ** g + e
    return np.asarray(np.where(codes >= d, curved, c * codes + f))
