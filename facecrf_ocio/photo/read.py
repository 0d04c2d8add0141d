"""From a photo file to a `Photo`: what the file says, and nothing added."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.color.primaries import known_primaries, name_primaries
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import complaint, plain_text
from facecrf_ocio.files.threads import OtherThread
from facecrf_ocio.photo.channels import alpha_channel, color_channels, is_premultiplied
from facecrf_ocio.photo.cicp import LINEAR, of_numbers
from facecrf_ocio.photo.decode import (
    PHOTOMETRIC,
    decode,
    decode_by_bands,
    is_plain_16_bits,
    one_line,
)
from facecrf_ocio.photo.edits import edits_told, made_as_told
from facecrf_ocio.photo.gain_map import jpeg_gain_map
from facecrf_ocio.photo.heif import read_heif
from facecrf_ocio.photo.integrity import COPY_AGAIN, check_file, check_size, photo_sha256
from facecrf_ocio.photo.named_curve import curve_of_scan, is_other_curve, named_curve
from facecrf_ocio.photo.no_photo import no_photo
from facecrf_ocio.photo.orientation import orientation_of, upright
from facecrf_ocio.photo.picture import PhotoFile, Picture, open_image, open_picture
from facecrf_ocio.photo.pixels import (
    Pixels,
    code_values,
    holds_codes,
    is_gray,
    three_channels,
    unpremultiplied,
)
from facecrf_ocio.photo.png_chunks import has_void_gamma
from facecrf_ocio.photo.profile import primaries_from_icc, profile_notes
from facecrf_ocio.photo.suffixes import HEIF
from facecrf_ocio.values import Camera, Photo, Primaries, frozen

_EXPORT = "convert it to DNG, or export a 16-bit TIFF"
_CONVERT = "convert it to JPEG, PNG, TIFF or EXR"
# Where generators of pictures leave their recipe: chunks of PNG, and EXIF.
_BESIDE = ("parameters", "prompt", "Exif:UserComment")
_AS_8_BIT = "save it with 8 bits a channel"
_FULL_RANGE = "export it with code values of the full range"
_COPY_OR_CONVERT = f"if it should be one, {COPY_AGAIN}; else {_CONVERT}"
_INTEGERS = {oiio.UINT8, oiio.INT8, oiio.UINT16, oiio.INT16, oiio.UINT32, oiio.INT32}
# TIFF 6.0 and supplements: separated inks; CIELab, ICCLab, ITULab.
_SEPARATED, _LAB = 5, (8, 9, 10)
_NOT_READ = 24  # [bit] of floats that OpenImageIO takes for others
_ENCODED_SPACE = re.compile(r"srgb|g\d\d|gamma|log|pq|hlg|bt1886|itu709")
_SPACE_PRIMARIES = {"p3d65": "Display P3", "rec2020": "Rec.2020", "adobergb": "Adobe RGB"}


def read_photo(path: str | Path) -> Photo:
    """Read one photo: JPEG, PNG, TIFF, camera raw, EXR, and whatever else OpenImageIO reads.

    What a file is, its content says before its suffix. The result is upright (orientation of EXIF,
    else of XMP, applied), with alpha kept aside. Of a TIFF with several pages the largest that is
    no thumbnail is read, of any other file with several images the first.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Photo
        Integer files: code values divided by their maximum, as they stand in the file. Floating
        point and camera raw: linear light, `scene_linear` set. Its `notes` tell what was mended,
        chosen, or set aside.

    Raises
    ------
    PhotoError
        If the file is missing, unreadable, damaged, larger than `integrity.MAX_MEGAPIXELS`,
        neither RGB nor gray, or holds NaN or infinities.
    """
    path = Path(path)
    check_file(path)
    with OtherThread() as other:  # which hashes while this one decodes
        return _read(PhotoFile(path), other.begin(partial(photo_sha256, path)))


def _read(file: PhotoFile, ask_sha256: Callable[[], str]) -> Photo:
    if file.kind is not None and file.kind.reader == HEIF:
        return read_heif(file, ask_sha256())
    if file.is_raw:
        return _read_raw(file, ask_sha256(), "is not camera raw that LibRaw knows", _EXPORT)
    picture = open_picture(file)
    if picture is None:
        problem = one_line(complaint(oiio.geterror), file.path)
        problem = f"is not an image that can be read ({problem.partition('. Is it a file')[0]})"
        told = no_photo(file.head) or (problem, _COPY_OR_CONVERT)
        return _read_raw(file, ask_sha256(), *told)
    try:
        return _read_image(file, picture, ask_sha256)
    finally:
        picture.close()


def _read_raw(file: PhotoFile, sha256: str, problem: str, remedy: str) -> Photo:
    """What LibRaw reads; the problem is told if it does not know the file."""
    from facecrf_ocio.photo.raw import decode_raw  # noqa: PLC0415 - LibRaw, for few photos

    file.forget()
    linear = decode_raw(file.path)
    if linear is None:
        raise PhotoError(file.path, problem, remedy)
    header = open_image(file.path)
    complaint(oiio.geterror)
    encoded = code_values(linear, 16)
    encoded.flags.writeable = False  # or the photo would copy it
    return Photo(
        encoded,
        scene_linear=True,
        primaries=known_primaries("Rec.709", "camera raw decoding"),
        camera=Camera() if header is None else _camera(header.spec()),
        path=file.path,
        sha256=sha256,
    )


def _read_image(file: PhotoFile, picture: Picture, ask_sha256: Callable[[], str]) -> Photo:
    path, source, spec = file.path, picture.source, picture.spec
    file_format = source.format_name()
    check_size(path, spec.width, spec.height)
    _check_kind(path, spec, file_format)
    channels, transparency = color_channels(path, spec), alpha_channel(spec)
    icc = icc_profile(spec)
    curve = named_curve(of_numbers(spec.getattribute("CICP")), icc)
    curve = curve or curve_of_scan(file_format, spec.get_string_attribute("dpx:Transfer"))
    scene_linear = _is_scene_linear(spec, icc, curve) and not has_void_gamma(file.content)
    bits = spec.get_int_attribute("oiio:BitsPerSample", 8 * spec.format.size())
    turn = orientation_of(spec, file.xmp)
    gain_map, set_aside = (None, ()) if file.jpeg is None else jpeg_gain_map(file.jpeg, turn)
    camera, alpha = _camera(spec), None
    edits = edits_told(file.xmp, camera.software, _made(spec, file.content, camera))
    file.forget()

    if turn == 1 and is_plain_16_bits(spec, channels):
        pixels: Pixels = decode_by_bands(path, source, bits)
    else:
        codes = decode(path, picture)
        if transparency is not None:
            alpha = frozen(code_values(upright(codes[..., transparency], turn), bits), np.float32)
        # The largest arrays of all: each is let go when the next is there, and none is copied.
        color = three_channels(upright(_select(codes, channels), turn))
        del codes
        plain = color.dtype == np.uint8 and alpha is None
        pixels = np.ascontiguousarray(color) if plain else code_values(color, bits)
        del color
    if alpha is not None and is_premultiplied(spec, file_format):
        pixels = unpremultiplied(pixels, alpha)
        pixels = pixels if scene_linear else np.minimum(pixels, np.float32(1))
    if scene_linear and holds_codes(pixels):
        raise PhotoError(path, "holds code values up to 255 as floating point, no light", _AS_8_BIT)
    pixels.flags.writeable = False
    told: dict[str, Any] = {
        "scene_linear": scene_linear,
        "named_curve": "" if scene_linear else curve,
        "grayscale": len(channels) == 1 or is_gray(pixels),
        "primaries": primaries_of(spec, icc),
        "camera": camera,
        "path": path,
        "sha256": ask_sha256(),
        "gain_map": gain_map,
        "edits": edits,
        "notes": (*picture.notes, *profile_notes(icc), *set_aside),
    }
    if pixels.dtype == np.uint8:
        return Photo.of_codes(pixels, **told)
    # Filters of renderers overshoot a little; colors are divided by what the file has.
    alpha = None if alpha is None else frozen(alpha.clip(0.0, 1.0), np.float32)
    return Photo(pixels, bit_depth=_bit_depth(spec, bits), alpha=alpha, **told)


def _check_kind(path: Path, spec: Any, file_format: str) -> None:
    """Refuse what is no photograph in RGB or gray."""
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
        raise PhotoError(path, f"is {kind}", _CONVERT)
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


def _select(codes: Pixels, channels: Sequence[int]) -> Pixels:
    """(H, W, 3), or (H, W) of a single channel."""
    if len(channels) == 1:
        return codes[..., channels[0]]
    return codes if codes.shape[2] == 3 and channels == [0, 1, 2] else codes[..., channels]


def _bit_depth(spec: Any, bits: int) -> int | None:
    """Bits of the code values; palettes tell those of their indices instead, so 8 at least."""
    return max(bits, 8) if spec.format.basetype in _INTEGERS else None


def _is_scene_linear(spec: Any, icc: bytes, curve: str) -> bool:
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


def primaries_of(spec: Any, icc: bytes) -> Primaries | None:
    """Primaries by ICC profile, else file attributes, else EXIF; None where none of them tells."""
    by_profile = primaries_from_icc(icc)
    if by_profile is not None:
        return by_profile
    told = of_numbers(spec.getattribute("CICP"))
    by_numbers = None if told is None else told.named_primaries()
    if by_numbers is not None:
        return by_numbers
    chromaticities = spec.getattribute("chromaticities")
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


def _made(spec: Any, content: bytes, camera: Camera) -> tuple[str, ...]:
    rendered = spec.get_int_attribute("Exif:CustomRendered")
    beside = " ".join(spec.get_string_attribute(name) for name in _BESIDE)
    return made_as_told(content, camera, rendered, beside)


def _camera(spec: Any) -> Camera:
    names = ("Make", "Model", "Exif:BodySerialNumber", "Software")
    return Camera(*(plain_text(spec.get_string_attribute(name)) for name in names))
