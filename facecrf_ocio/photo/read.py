"""From a photo file to a `Photo`: what the file says, and nothing added."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from facecrf_ocio.checks import typed
from facecrf_ocio.color.primaries import known_primaries
from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.threads import OtherThread
from facecrf_ocio.photo.containers.integrity import COPY_AGAIN, check_file, check_size, photo_sha256
from facecrf_ocio.photo.containers.jxl_header import moves
from facecrf_ocio.photo.containers.no_photo import no_photo
from facecrf_ocio.photo.containers.png_chunks import has_void_gamma, is_animated, profile_told
from facecrf_ocio.photo.containers.suffixes import HEIF, kind_of
from facecrf_ocio.photo.decoding.channels import (
    alpha_channel,
    color_channels,
    is_premultiplied,
    shown,
)
from facecrf_ocio.photo.decoding.decode import (
    decode,
    decode_by_bands,
    first_line,
    is_plain_16_bits,
)
from facecrf_ocio.photo.decoding.gain_map import jpeg_gain_map
from facecrf_ocio.photo.decoding.heif import read_heif
from facecrf_ocio.photo.decoding.left_over import tail_of, units_left_over
from facecrf_ocio.photo.decoding.orientation import as_stored, orientation_of, upright
from facecrf_ocio.photo.decoding.picture import (
    FIRST_OF_SEVERAL,
    PhotoFile,
    Picture,
    open_image,
    open_picture,
)
from facecrf_ocio.photo.raster.pixels import (
    Pixels,
    code_values,
    holds_codes,
    is_gray,
    three_channels,
    unpremultiplied,
)
from facecrf_ocio.photo.tags.adapted import adapted_by
from facecrf_ocio.photo.tags.cicp import of_numbers
from facecrf_ocio.photo.tags.edits import edits_told
from facecrf_ocio.photo.tags.header import (
    CONVERT,
    bit_depth_of,
    camera_of,
    check_kind,
    icc_profile,
    is_scene_linear,
    made_by,
    primaries_of,
)
from facecrf_ocio.photo.tags.maker_notes import exif_of
from facecrf_ocio.photo.tags.named_curve import curve_of_scan, named_curve
from facecrf_ocio.photo.tags.profile import profile_notes
from facecrf_ocio.photo.tags.radiance import radiance_notes
from facecrf_ocio.values import Camera, Photo, frozen

# OpenImageIO decodes all frames of a JPEG XL one over the other.
_LAST_OF_SEVERAL = "the last of several pictures was read"
_EXPORT = "convert it to DNG, or export a 16-bit TIFF"
_AS_8_BIT = "save it with 8 bits a channel"
_AS_RGB = "save it with R, G and B for each pixel"  # of an EXR of luminance and chroma
_COPY_OR_CONVERT = f"if it should be one, {COPY_AGAIN}; else {CONVERT}"


@typed
def read_photo(path: str | Path) -> Photo:
    """Read one photo: JPEG, PNG, TIFF, camera raw, EXR, and whatever else OpenImageIO reads.

    What a file is, its content says before its suffix. The result is upright (orientation of EXIF,
    else of XMP, applied), with alpha kept aside. Of a TIFF with several pages the largest that is
    no thumbnail is read, of an EXR's parts the first with R, G and B, of any other file the first.

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
    picture, why = open_picture(file)
    if picture is None:
        reason = first_line(why, file.path).partition(". Is it a file")[0]
        return _read_raw(file, ask_sha256(), *_unread(file, reason))
    try:
        return _read_image(file, picture, ask_sha256)
    finally:
        picture.close()


def _unread(file: PhotoFile, reason: str) -> tuple[str, str]:
    """What is told of a file that OpenImageIO does not open, and what to do about it."""
    told, kind = no_photo(file.head), kind_of(file.head)
    if told is not None:
        return told
    if kind is None:
        return f"is not an image that can be read ({reason})", _COPY_OR_CONVERT
    problem = f"begins as {kind.name}, but cannot be read ({reason})"
    return problem, _AS_RGB if "Subsampled channels" in reason else f"{COPY_AGAIN}, or {CONVERT}"


def _read_raw(file: PhotoFile, sha256: str, problem: str, remedy: str) -> Photo:
    """What LibRaw reads; the problem is told if it does not know the file."""
    from facecrf_ocio.photo.decoding.raw import decode_raw  # noqa: PLC0415 - LibRaw, for few photos

    file.forget()
    linear = decode_raw(file.path)
    if linear is None:
        raise PhotoError(file.path, problem, remedy)
    header, _ = open_image(file.path)
    encoded = code_values(linear, 16)
    encoded.flags.writeable = False  # or the photo would copy it
    return Photo(
        encoded,
        scene_linear=True,
        primaries=known_primaries("Rec.709", "camera raw decoding"),
        camera=Camera() if header is None else camera_of(header.spec()),
        path=file.path,
        sha256=sha256,
    )


def _read_image(file: PhotoFile, picture: Picture, ask_sha256: Callable[[], str]) -> Photo:
    path, source, spec = file.path, picture.source, picture.spec
    if file.jpeg is not None and not file.jpeg.complete:
        problem = "is cut short (scans of a progressive JPEG are missing)"
        raise PhotoError(path, problem, f"{COPY_AGAIN}, or save it anew as it is")
    file_format = source.format_name()
    check_size(path, spec.width, spec.height)
    check_kind(path, spec, file_format)
    channels, icc = color_channels(path, spec), icc_profile(spec) or profile_told(file.content)
    curve = named_curve(of_numbers(spec.getattribute("CICP")), icc)
    curve = curve or curve_of_scan(file_format, spec.get_string_attribute("dpx:Transfer"))
    scene_linear = is_scene_linear(spec, icc, curve) and not has_void_gamma(file.content)
    bits = spec.get_int_attribute("oiio:BitsPerSample", 8 * spec.format.size())
    turn = orientation_of(spec, file.xmp)
    gain_map, set_aside = (None, ()) if file.jpeg is None else jpeg_gain_map(file.jpeg, turn)
    camera = camera_of(spec)
    edits = edits_told(file.xmp, camera.software, made_by(spec, file.content, camera))
    adapted = () if scene_linear else adapted_by(exif_of(file.content, file.jpeg))
    primaries = primaries_of(spec, icc, file.content)
    profile_noted = profile_notes(icc, gray=len(channels) == 1) if icc else _profile_lost(file)
    moving = (FIRST_OF_SEVERAL,) if is_animated(file.content) else ()
    moving = (_LAST_OF_SEVERAL,) if moves(file.content) else moving
    scaled = radiance_notes(file.content)
    tail = None if file.jpeg is None else tail_of(file.jpeg)
    file.forget()
    pixels, alpha = _decoded(path, picture, channels, turn, bits)
    if tail is not None and units_left_over(tail, as_stored(pixels, turn)):
        problem = "is damaged within its pixels (blocks are left over when the picture is full)"
        raise PhotoError(path, problem, COPY_AGAIN)
    alpha, unseen = shown(alpha)
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
        "primaries": primaries,
        "camera": camera,
        "path": path,
        "sha256": ask_sha256(),
        "gain_map": gain_map,
        "edits": edits,
        "adapted": adapted,
        "notes": (*picture.notes, *moving, *scaled, *profile_noted, *set_aside, *unseen),
    }
    if pixels.dtype == np.uint8:
        return Photo.of_codes(pixels, **told)
    # Filters of renderers overshoot a little; colors are divided by what the file has.
    alpha = None if alpha is None else frozen(alpha.clip(0.0, 1.0), np.float32)
    return Photo(pixels, bit_depth=bit_depth_of(spec, bits), alpha=alpha, **told)


def _profile_lost(file: PhotoFile) -> tuple[str, ...]:
    """A note on a JPEG of whose ICC profile not all segments are there."""
    begun = file.jpeg is not None and file.jpeg.contents(0xE2, b"ICC_PROFILE\0")
    return ("its ICC profile was set aside: it is not whole",) if begun else ()


def _decoded(
    path: Path, picture: Picture, channels: Sequence[int], turn: int, bits: int
) -> tuple[Pixels, Pixels | None]:
    """Upright pixels, three channels each, and the transparency (H, W) of a picture that has one.

    The largest arrays of all: each is let go when the next is there, and none is copied.
    """
    if turn == 1 and is_plain_16_bits(picture.spec, channels):
        return decode_by_bands(path, picture.source, bits), None
    codes, transparency, alpha = decode(path, picture), alpha_channel(picture.spec), None
    if transparency is not None:
        alpha = frozen(code_values(upright(codes[..., transparency], turn), bits), np.float32)
    color = three_channels(upright(_select(codes, channels), turn))
    del codes
    plain = color.dtype == np.uint8 and alpha is None
    return np.ascontiguousarray(color) if plain else code_values(color, bits), alpha


def _select(codes: Pixels, channels: Sequence[int]) -> Pixels:
    """(H, W, 3), or (H, W) of a single channel."""
    if len(channels) == 1:
        return codes[..., channels[0]]
    return codes if codes.shape[2] == 3 and channels == [0, 1, 2] else codes[..., channels]
