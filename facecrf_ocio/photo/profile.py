"""What a file says of its RGB primaries: ICC profile, file attributes, EXIF."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from io import BytesIO

import numpy as np

from facecrf_ocio.color.adaptation import adapted, white_xyz
from facecrf_ocio.color.primaries import D50, D65, name_primaries
from facecrf_ocio.values import Float, Primaries


def primaries_from_icc(profile: bytes) -> Primaries | None:
    """Primaries of a matrix profile as they were before adaptation to the profile's D50.

    Parameters
    ----------
    profile
        The ICC profile's bytes.

    Returns
    -------
    Primaries or None
        None where the profile is damaged or has no RGB matrix (gray, CMYK, tables only).
    """
    # Not needed by those who want the primaries' numbers alone.
    from PIL import ImageCms  # noqa: PLC0415

    try:
        icc = ImageCms.ImageCmsProfile(BytesIO(profile)).profile
    except (OSError, ImageCms.PyCMSError):
        return None
    colorants = (icc.red_colorant, icc.green_colorant, icc.blue_colorant)
    if icc.xcolor_space.strip() != "RGB" or any(colorant is None for colorant in colorants):
        return None
    d50 = np.array([colorant[0] for colorant in colorants if colorant is not None])
    candidates = [
        name_primaries(_unadapted(d50, matrix), "ICC profile")
        for matrix in _adaptations(icc.chromatic_adaptation, icc.media_white_point)
    ]
    return next((found for found in candidates if found.name != "custom"), candidates[0])


def icc_is_linear(profile: bytes) -> bool | None:
    """Whether a matrix profile's red curve is the identity; None where it has no such curve."""
    curve = _tag(profile, b"rTRC")
    try:
        if curve[:4] == b"curv":
            (count,) = struct.unpack_from(">I", curve, 8)
            samples = np.array(struct.unpack_from(f">{count}H", curve, 12))
            if count < 2:  # none is the identity, one is a gamma in 1/256
                return bool((samples == 256).all())
            return bool(np.abs(samples / 65535 - np.linspace(0, 1, count)).max() < 1e-3)
        if curve[:4] == b"para":
            kind, _, gamma = struct.unpack_from(">HHi", curve, 8)
            return bool(kind == 0 and gamma == 65536)
    except struct.error:
        pass
    return None


def _tag(profile: bytes, signature: bytes) -> bytes:
    """Contents of one tag of an ICC profile (ICC.1:2022, 7.3); empty where there is none."""
    entries = profile[132 : 132 + 12 * int.from_bytes(profile[128:132], "big")]
    for start in range(0, len(entries) - 11, 12):
        if entries[start : start + 4] == signature:
            offset, size = struct.unpack_from(">II", entries, start + 4)
            return profile[offset : offset + size]
    return b""


def _adaptations(
    chad: Sequence[object] | None, white: Sequence[Sequence[float]] | None
) -> list[Float]:
    """Matrices that may have brought the colorants to D50, likeliest first.

    Version 4 records the matrix (`chad`). Version 2 does not: there the media white is the true
    one and Bradford is customary, but some makers write D50 for D65.
    """
    if chad is not None:
        return [np.array(chad[0], float).reshape(3, 3)]
    d50 = white_xyz(D50)
    media = d50 if white is None else np.array(white[0], float)
    return [adapted(media, d50), adapted(white_xyz(D65), d50)]


def _unadapted(colorants: Float, matrix: Float) -> Float:
    """(4, 2) xy of the three colorants (rows of XYZ) and of white before the adaptation."""
    xyz = np.linalg.solve(matrix, np.vstack([colorants, white_xyz(D50)]).T).T
    return np.asarray(xyz[:, :2] / xyz.sum(axis=1, keepdims=True))
