"""What a file says of its RGB primaries: ICC profile, file attributes, EXIF."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from io import BytesIO

import numpy as np

from facecrf_ocio.color.adaptation import adapted, white_xyz
from facecrf_ocio.color.primaries import D50, D65, name_primaries
from facecrf_ocio.values import Float, Primaries

_WHITE_XYZ = 0.05
"""[XYZ, white's Y is 1] by which the colorants' sum may miss white; makers round to 0.005."""

_OF_PHOTOS = ("RGB", "GRAY")
_BETWEEN = ("link", "abst", "nmcl")  # classes of profiles that no picture is in (ICC.1:2022, 7.2.5)


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
    try:
        return _primaries(profile) if profile else None
    except _UnusableError:
        return None


def profile_notes(profile: bytes, *, gray: bool = False) -> tuple[str, ...]:
    """Why a profile is of no use to a picture and was set aside, in a clause; empty if it is sound.

    `gray` is whether the picture has one channel.
    """
    try:
        if profile and _primaries(profile) is None and not gray:
            raise _UnusableError("it is of gray, and the picture is not")
    except _UnusableError as error:
        return (f"its ICC profile was set aside: {error}",)
    return ()


class _UnusableError(Exception):
    """A profile without sound primaries; says what is wrong with it."""


def _primaries(profile: bytes) -> Primaries | None:
    # Not needed by those who want the primaries' numbers alone.
    from PIL import ImageCms  # noqa: PLC0415

    try:
        icc = ImageCms.ImageCmsProfile(BytesIO(profile)).profile
        colorants = (icc.red_colorant, icc.green_colorant, icc.blue_colorant)
        chad, white = icc.chromatic_adaptation, icc.media_white_point
        space, kind = icc.xcolor_space.strip(), icc.device_class
    except (OSError, ImageCms.PyCMSError, ValueError, OverflowError) as error:
        raise _UnusableError("it is damaged") from error
    if kind in _BETWEEN or space not in _OF_PHOTOS:
        what = f"class {kind}" if kind in _BETWEEN else space or "no color"
        raise _UnusableError(f"it is of {what}, and no photo's")
    if space != "RGB":
        return None
    if any(colorant is None for colorant in colorants):
        raise _UnusableError("it tells of no primaries, but by tables")
    d50 = np.array([colorant[0] for colorant in colorants if colorant is not None], float)
    whites = [white_xyz(D50)] + ([] if white is None else [np.array(white[0], float)])
    if not any(np.abs(d50.sum(axis=0) - one).max() < _WHITE_XYZ for one in whites):
        raise _UnusableError("its primaries do not add up to white")
    candidates = [_named(d50, matrix) for matrix in _adaptations(chad, white)]
    sound = [found for found in candidates if found is not None]
    if not sound:
        raise _UnusableError("its matrix gives no primaries")
    return next((found for found in sound if found.name != "custom"), sound[0])


def _named(colorants: Float, matrix: Float) -> Primaries | None:
    """The primaries before an adaptation (3, 3); None where colorants (3, 3) are no three."""
    try:
        xy = _unadapted(colorants, matrix)
    except np.linalg.LinAlgError:
        return None
    return name_primaries(xy, "ICC profile")


def icc_tag(profile: bytes, signature: bytes) -> bytes:
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
    media = d50 if white is None or min(white[0]) <= 0 else np.array(white[0], float)
    return [adapted(media, d50), adapted(white_xyz(D65), d50)]


def _unadapted(colorants: Float, matrix: Float) -> Float:
    """(4, 2) xy of the three colorants (rows of XYZ) and of white before the adaptation."""
    xyz = np.linalg.solve(matrix, np.vstack([colorants, white_xyz(D50)]).T).T
    with np.errstate(divide="ignore", invalid="ignore"):  # of colorants that are none
        return np.asarray(xyz[:, :2] / xyz.sum(axis=1, keepdims=True))
