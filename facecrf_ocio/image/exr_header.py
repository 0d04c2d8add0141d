"""What a linear image says of itself: metadata of its source that still hold, and its color."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.color.primaries import CIE_XYZ
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.photo.decoding.orientation import QUARTER_TURNS, orientation_of
from facecrf_ocio.photo.decoding.picture import PhotoFile, open_picture
from facecrf_ocio.values import Photo, Primaries

# Color Interop Forum, recommendation 03; other primaries have no identifier.
_INTEROP_ID = {
    "Rec.709": "lin_rec709_scene",
    "Display P3": "lin_p3d65_scene",
    "Rec.2020": "lin_rec2020_scene",
    "Adobe RGB": "lin_adobergb_scene",
    "AP1": "lin_ap1_scene",
    "AP0": "lin_ap0_scene",
    CIE_XYZ.name: "lin_ciexyzd65_scene",
}
# What the source says of its own encoding, layout and upbringing, none of which is true of the
# EXR: its pixels are linear, upright and in other types. Maker notes hold offsets into the source.
# Then what OpenEXR says itself: a text of a PNG by such a name makes a file that nobody can read.
_NOT_KEPT = re.compile(
    r"(oiio|openexr|jpeg|png|tiff|gif|webp|dpx|cineon|psd|jpeg2000|heif|bmp|targa|ico|hdr|raw|"
    r"ICCProfile|ICCProfile:.*|photoshop|thumbnail.*)(:.*)?|"
    r"Exif:(ColorSpace|Gamma|Pixel[XY]Dimension|YCbCr.*|Compressed.*|Components.*|MakerNote|"
    r"Interoperability.*|WhitePoint|PrimaryChromaticities|TransferFunction)|"
    r"Orientation|compression|planarconfig|chromaticities|colorInteropID|whiteLuminance|"
    r"acesImageContainerFlag|screenWindow.*|textureformat|wrapmodes|CICP|.*thumbnail.*|"
    r"channels|chunkCount|dataWindow|displayWindow|lineOrder|name|preview|tiles|type|version|"
    r"PixelAspectRatio",
    re.IGNORECASE,
)

_LONGEST = 1 << 16
"""[characters] Of one text; EXIF has room for no more."""


_NARROWEST = 1e-6  # [1] ratio of a pixel's width to its height; OpenEXR writes no file below it
_PAIRS = 30.5  # [1/s] from which time codes count pairs of frames; 29.97 counts to 29


def exr_header(
    size: tuple[int, ...],
    channels: Sequence[str],
    photo: Photo,
    provenance: Mapping[str, str],
    kind: Any,
) -> oiio.ImageSpec:
    """Header of an EXR of (H, W) linear pixels of a photo; `kind` is one of OpenImageIO's."""
    height, width = size
    header = oiio.ImageSpec(width, height, len(channels), kind)
    header.channelnames = tuple(channels)
    if photo.path is not None:
        _keep_metadata(photo.path, header)
    header.attribute("Orientation", 1)
    if not header.get_string_attribute("DateTime"):
        # Else the writer puts the time of writing there, and no two files are equal.
        header.attribute("DateTime", "")
    tag_primaries(header, photo.primaries)
    notes = {"primaries": _primaries_note(photo.primaries), **provenance}
    for name, value in notes.items():
        header.attribute(f"facecrf:{name}", value)
    if "timecode" in provenance:
        digits = packed(provenance["timecode"], float(provenance["frames_per_second"]))
        header.attribute("smpte:TimeCode", oiio.TypeTimeCode, (digits, 0))
    return header


def packed(timecode: str, rate: float) -> int:
    """HH:MM:SS:FF as OpenEXR's `timeCode` holds it: decimal digits of four bits (SMPTE ST 12-1).

    Two bits are left for tens of frames, so that above 30 frames a second pairs are counted, as
    the standard has it.
    """
    hours, minutes, seconds, frames = map(int, timecode.split(":"))
    code = 0
    for part in (hours % 24, minutes, seconds, frames // 2 if rate > _PAIRS else frames):
        code = code << 8 | part // 10 << 4 | part % 10
    return code


def tag_primaries(header: oiio.ImageSpec, primaries: Primaries | None) -> None:
    """Say that the pixels are scene-linear and of these primaries, or, with None, nothing."""
    if primaries is None:
        tag_color_space(header, "unknown")
        header.erase_attribute("chromaticities")
        return
    tag_color_space(header, _INTEROP_ID.get(primaries.name, "unknown"))
    header.attribute("chromaticities", oiio.TypeDesc("float[8]"), _chromaticities(primaries))


def tag_color_space(header: oiio.ImageSpec, interop_id: str) -> None:
    """Say which color space of the Color Interop Forum the pixels are in, or `unknown`."""
    header.attribute("oiio:ColorSpace", interop_id)
    header.attribute("colorInteropID", interop_id)


def still_holds(attribute: str) -> bool:
    """Whether a source's attribute of this name is true of its upright linear pixels too."""
    return not _NOT_KEPT.fullmatch(attribute)


def _keep_metadata(path: Path, header: oiio.ImageSpec) -> None:
    file = PhotoFile(path)
    try:
        picture, _ = open_picture(file)
    except OSError:  # moved meanwhile
        return
    if picture is None:  # camera raw: nothing to keep
        return
    spec = picture.spec
    is_exr = picture.source.format_name() == "openexr"
    for item in spec.extra_attribs:
        if still_holds(item.name) and (is_exr or item.name != "envmap"):
            _copy_attribute(item, header)
    _keep_aspect(spec, header, file)
    is_upright = spec.get_int_attribute("Orientation", 1) == 1
    if is_exr and is_upright and (spec.width, spec.height) == (header.width, header.height):
        _keep_windows(spec, header)
    picture.close()


def _keep_aspect(spec: Any, header: oiio.ImageSpec, file: PhotoFile) -> None:
    """Say how wide pixels are, if they are not square, of the picture turned upright."""
    told = spec.get_float_attribute
    aspect, down = told("PixelAspectRatio", 1.0), told("YResolution", 0.0)
    if not _NARROWEST <= aspect <= 1.0 / _NARROWEST:
        header.erase_attribute("[XY]Resolution")
    elif aspect != 1.0 and orientation_of(spec, file.xmp) in QUARTER_TURNS:
        header.attribute("PixelAspectRatio", 1.0 / aspect)
        if down > 0.0:  # the writer finds the other one
            header.attribute("XResolution", down)
    elif aspect != 1.0:
        header.attribute("PixelAspectRatio", aspect)


def _keep_windows(spec: Any, header: oiio.ImageSpec) -> None:
    """Let the pixels lie in the frame where those of a source EXR do (data and display window)."""
    header.x, header.y = spec.x, spec.y
    header.full_x, header.full_y = spec.full_x, spec.full_y
    header.full_width, header.full_height = spec.full_width, spec.full_height


def _copy_attribute(item: Any, header: oiio.ImageSpec) -> None:
    # OpenImageIO drops short integers without a word; Python's own become 32-bit ones.
    name, value = plain_text(item.name), _plain(item.value)
    unsigned = isinstance(value, int) and value >= 1 << 31  # as Canon's ModelID is
    if isinstance(value, int | float | str) and not unsigned:
        header.attribute(name, value)
    else:
        header.attribute(name, item.type, value)


def _plain(value: Any) -> Any:
    """Texts as OpenImageIO takes them, which is UTF-8 alone; anything else as it is."""
    if isinstance(value, str):
        return plain_text(value, limit=_LONGEST, lines=True)
    return tuple(map(_plain, value)) if isinstance(value, tuple) else value


def _chromaticities(primaries: Primaries) -> tuple[float, ...]:
    return (*primaries.red, *primaries.green, *primaries.blue, *primaries.white)


def _primaries_note(primaries: Primaries | None) -> str:
    if primaries is None:
        return "unknown"
    if primaries.source == "assumed":
        return f"assumed {primaries.name}"
    return f"{primaries.name} by {primaries.source}"
