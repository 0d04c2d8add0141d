"""What an image's header says of it, beside its pixels: kind, color, camera, and who made it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.color.primaries import known_primaries, name_primaries
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.photo.containers.png_chunks import chromaticities_told
from facecrf_ocio.photo.tags.cicp import LINEAR, of_numbers
from facecrf_ocio.photo.tags.edits import made_as_told
from facecrf_ocio.photo.tags.named_curve import is_other_curve
from facecrf_ocio.photo.tags.profile import primaries_from_icc
from facecrf_ocio.photo.tags.radiance import radiance_primaries
from facecrf_ocio.values import Camera, Primaries

PHOTOMETRIC = "tiff:PhotometricInterpretation"
"""Attribute of a TIFF that tells what its numbers mean."""

CONVERT = "convert it to JPEG, PNG, TIFF or EXR"
"""What helps where OpenImageIO reads a file that is no picture of ours."""

_FULL_RANGE = "export it with code values of the full range"
# Where generators of pictures leave their recipe: chunks of PNG, and EXIF.
_BESIDE = ("parameters", "prompt", "Exif:UserComment")
_INTEGERS = {oiio.UINT8, oiio.INT8, oiio.UINT16, oiio.INT16, oiio.UINT32, oiio.INT32}
# TIFF 6.0 and supplements: separated inks; CIELab, ICCLab, ITULab.
_SEPARATED, _LAB = 5, (8, 9, 10)
_NOT_READ = 24  # [bit] of floats that OpenImageIO takes for others
_ENCODED_SPACE = re.compile(r"srgb|g\d\d|gamma|log|pq|hlg|bt1886|itu709")
_SPACE_PRIMARIES = {"p3d65": "Display P3", "rec2020": "Rec.2020", "adobergb": "Adobe RGB"}


def check_kind(path: Path, spec: Any, file_format: str) -> None:
    """Refuse what is no photograph in RGB or gray.

    Raises
    ------
    PhotoError
        Which says what it is, and what to take instead.
    """
    photometric = spec.get_int_attribute(PHOTOMETRIC)
    spaces = [spec.get_string_attribute(f"{prefix}:ColorSpace") for prefix in ("jpeg", "tiff")]
    spaces.append(spec.get_string_attribute("psd:ColorMode"))
    if photometric == _SEPARATED or {"CMYK", "YCbCrK", "YCCK"} & set(spaces):
        raise PhotoError(
            path,
            "is CMYK, an encoding for print that no camera wrote",
            "use the RGB original from the camera",
        )
    told = of_numbers(spec.getattribute("CICP"))
    if told is not None and not told.full_range:
        raise PhotoError(path, "has code values of video's narrow range", _FULL_RANGE)
    if photometric in _LAB:
        raise PhotoError(path, "is CIELab, not RGB", "use the RGB original from the camera")
    if file_format == "null" or spec.deep or spec.depth > 1:
        kind = "a deep image" if spec.deep else "a volume" if spec.depth > 1 else "no image"
        raise PhotoError(path, f"is {kind}", CONVERT)
    if spec.format == oiio.FLOAT and spec.get_int_attribute("oiio:BitsPerSample") == _NOT_READ:
        raise PhotoError(
            path,
            "holds floating point of 24 bits, which is not read here",
            "save it as floating point of 16 or 32 bits",
        )
    if file_format == "openexr" and spec.channelformat(0).basetype in _INTEGERS:
        raise PhotoError(
            path,
            "holds whole numbers, by which renderers name objects, and no light",
            "use the EXR with the picture's colors",
        )


def bit_depth_of(spec: Any, bits: int) -> int | None:
    """Bits of the code values; palettes tell those of their indices instead, so 8 at least."""
    return max(bits, 8) if spec.format.basetype in _INTEGERS else None


def is_scene_linear(spec: Any, icc: bytes, curve: str) -> bool:
    """What curve and color space say, else linear for floating point and encoded for integers."""
    if curve or is_other_curve(icc):
        return curve == LINEAR
    space = spec.get_string_attribute("oiio:ColorSpace").lower()
    if space.startswith("lin") or spec.format.basetype in _INTEGERS:
        return bool(space.startswith("lin"))
    return _ENCODED_SPACE.search(space) is None


def icc_profile(spec: Any) -> bytes:
    """Bytes of an image's profile, empty where it has none."""
    profile = spec.getattribute("ICCProfile")
    return b"" if profile is None else bytes(bytearray(profile))


def primaries_of(spec: Any, icc: bytes, content: bytes = b"") -> Primaries | None:
    """Primaries by ICC profile, else file attributes, else EXIF; None where none of them tells."""
    by_profile = primaries_from_icc(icc)
    if by_profile is not None:
        return by_profile
    told = of_numbers(spec.getattribute("CICP"))
    by_numbers = None if told is None else told.named_primaries()
    if by_numbers is not None:
        return by_numbers
    chromaticities = spec.getattribute("chromaticities") or chromaticities_told(content)
    chromaticities = chromaticities or radiance_primaries(content)
    if chromaticities is not None and len(chromaticities) == 8:
        return name_primaries(chromaticities, "file attribute")
    space = spec.get_string_attribute("oiio:ColorSpace").lower()
    for part, name in _SPACE_PRIMARIES.items():
        if part in space:
            return known_primaries(name, "file attribute")
    # EXIF 2.32, tag 0xA001: 1 is sRGB; DCF 2.0 marks Adobe RGB by its interoperability index.
    color_space = spec.get_int_attribute("Exif:ColorSpace")
    if color_space == 2 or spec.get_string_attribute("Exif:InteroperabilityIndex") == "R03":
        return known_primaries("Adobe RGB", "EXIF")
    return known_primaries("Rec.709", "EXIF") if color_space == 1 else None


def made_by(spec: Any, content: bytes, camera: Camera) -> tuple[str, ...]:
    """What says that no camera, or more than one, made the picture; see `edits.made_as_told`."""
    rendered = spec.get_int_attribute("Exif:CustomRendered")
    beside = " ".join(spec.get_string_attribute(name) for name in _BESIDE)
    return made_as_told(content, camera, rendered, beside)


def camera_of(spec: Any) -> Camera:
    """What EXIF tells of the camera and of the software."""
    names = ("Make", "Model", "Exif:BodySerialNumber", "Software")
    return Camera(*(plain_text(spec.get_string_attribute(name)) for name in names))
