"""What a file says of its RGB primaries: ICC profile, file attributes, EXIF."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from io import BytesIO

import numpy as np
import numpy.typing as npt

from facecrf_ocio.values import Float, Primaries

D65 = (0.3127, 0.3290)
D50 = (0.3457, 0.3585)

# Red, green, blue, white as published: ITU-R BT.709, SMPTE EG 432-1, Adobe RGB (1998),
# ITU-R BT.2020, ISO 22028-2 (ROMM).
KNOWN_PRIMARIES = {
    "Rec.709": ((0.640, 0.330), (0.300, 0.600), (0.150, 0.060), D65),
    "Display P3": ((0.680, 0.320), (0.265, 0.690), (0.150, 0.060), D65),
    "Adobe RGB": ((0.640, 0.330), (0.210, 0.710), (0.150, 0.060), D65),
    "Rec.2020": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), D65),
    "ProPhoto": ((0.7347, 0.2653), (0.1596, 0.8404), (0.0366, 0.0001), D50),
}

# Profiles round their colorants to 1/65536 of XYZ and their makers' arithmetic differs by some
# 0.001 in xy, while no two sets above are nearer to each other than 0.04.
_SAME_XY = 0.004

BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)


def known_primaries(name: str, source: str) -> Primaries:
    """Primaries by name, one of `KNOWN_PRIMARIES`."""
    return Primaries(name, *KNOWN_PRIMARIES[name], source)


def name_primaries(chromaticities: npt.ArrayLike, source: str) -> Primaries:
    """Name the known set that (4, 2) CIE xy of red, green, blue, white belong to, or `custom`."""
    xy = np.asarray(chromaticities, float).reshape(4, 2)
    for name, known in KNOWN_PRIMARIES.items():
        if np.abs(xy - np.array(known)).max() < _SAME_XY:
            return known_primaries(name, source)
    red, green, blue, white = ((float(x), float(y)) for x, y in xy)
    return Primaries("custom", red, green, blue, white, source)


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
    adapted = np.array([colorant[0] for colorant in colorants if colorant is not None])
    candidates = [
        name_primaries(_unadapted(adapted, matrix), "ICC profile")
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
    media = _xyz(D50) if white is None else np.array(white[0], float)
    return [_bradford(media), _bradford(_xyz(D65))]


def _bradford(white: Float) -> Float:
    cones = (BRADFORD @ _xyz(D50)) / (BRADFORD @ white)
    return np.asarray(np.linalg.inv(BRADFORD) @ np.diag(cones) @ BRADFORD)


def _unadapted(adapted: Float, matrix: Float) -> Float:
    """(4, 2) xy of the three colorants (rows of XYZ) and of white before the adaptation."""
    xyz = np.linalg.solve(matrix, np.vstack([adapted, _xyz(D50)]).T).T
    return np.asarray(xyz[:, :2] / xyz.sum(axis=1, keepdims=True))


def _xyz(xy: tuple[float, float]) -> Float:
    x, y = xy
    return np.array([x / y, 1.0, (1 - x - y) / y])
