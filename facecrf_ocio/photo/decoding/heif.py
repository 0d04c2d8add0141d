"""HEIC by pillow-heif, the extra `heif`, and AVIF by Pillow; OpenImageIO's wheels read neither."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.photo.containers.heif_boxes import child, with_primary, without_brand
from facecrf_ocio.photo.containers.integrity import COPY_AGAIN, check_size
from facecrf_ocio.photo.decoding.channels import shown
from facecrf_ocio.photo.decoding.gain_map import APPLE, GainMapError, apple_numbers, item_numbers
from facecrf_ocio.photo.decoding.orientation import upright
from facecrf_ocio.photo.decoding.picture import FIRST_OF_SEVERAL, PhotoFile
from facecrf_ocio.photo.decoding.tone_map_item import ToneMap, tone_map_item
from facecrf_ocio.photo.raster.pixels import is_gray, three_channels
from facecrf_ocio.photo.tags.adapted import adapted_by
from facecrf_ocio.photo.tags.cicp import LINEAR, CodePoints, of_boxes, of_nclx
from facecrf_ocio.photo.tags.edits import edits_told, made_as_told
from facecrf_ocio.photo.tags.exif import apple_headroom, camera_of, custom_rendered, load_exif
from facecrf_ocio.photo.tags.named_curve import named_curve
from facecrf_ocio.photo.tags.profile import primaries_from_icc, profile_notes
from facecrf_ocio.photo.tags.unwarned import unwarned
from facecrf_ocio.values import GainMap, Photo, frozen

INSTALL = "install the extra (pip install 'facecrf-ocio[heif]'), or convert it to JPEG or TIFF"
# What decoders raise; the last one of a file in which pillow-heif finds no image.
_DAMAGE = (RuntimeError, ValueError, EOFError, OSError, SyntaxError, IndexError)
_AVIF = (b"avif", b"avis")
_STILL = "it moves: its still picture was read"
_GAIN_MAP = ":aux:hdrgainmap"  # ends the names that Apple and Samsung give it


@dataclass(frozen=True, slots=True, eq=False)
class _Decoded:
    """(H, W, C) codes, upright, of so many bits, and what the file says beside them."""

    codes: npt.NDArray[Any]
    bits: int
    exif: bytes
    icc: bytes
    told: CodePoints | None = None
    gain_map: GainMap | None = None
    notes: tuple[str, ...] = ()


def read_heif(file: PhotoFile, sha256: str) -> Photo:
    """Read HEIC or AVIF.

    Raises
    ------
    PhotoError
        If the extra is not installed, or the file is damaged or too large.
    """
    content = file.content
    decoded = _read_avif(file) if content[8:12] in _AVIF else _read_heic(file)
    scale = np.float32(2**decoded.bits - 1)
    encoded = np.divide(three_channels(_color(decoded.codes)), scale, dtype=np.float32)
    encoded.flags.writeable = False
    has_alpha = decoded.codes.shape[2] in (2, 4)
    alpha, unseen = shown(decoded.codes[..., -1].astype(np.float32) / scale if has_alpha else None)
    told, icc = decoded.told, decoded.icc
    primaries = primaries_from_icc(icc) or (None if told is None else told.named_primaries())
    # A profile goes before the color box (ISO 23008-12, 6.5.5).
    curve = named_curve(None if icc else told, icc)
    exif = load_exif(decoded.exif)
    camera = camera_of(exif)
    made = made_as_told(content, camera, custom_rendered(exif))
    edits = edits_told(file.xmp, camera.software, made)
    adapted = adapted_by(decoded.exif.removeprefix(b"Exif\0\0"))
    file.forget()
    return Photo(
        encoded,
        bit_depth=decoded.bits,
        scene_linear=curve == LINEAR,
        named_curve="" if curve == LINEAR else curve,
        grayscale=is_gray(encoded),
        alpha=None if alpha is None else frozen(alpha, np.float32),
        primaries=primaries,
        camera=camera,
        path=file.path,
        sha256=sha256,
        gain_map=decoded.gain_map,
        edits=edits,
        adapted=adapted,
        notes=(*decoded.notes, *profile_notes(icc, gray=decoded.codes.shape[2] < 3), *unseen),
    )


def _read_heic(file: PhotoFile) -> _Decoded:
    try:
        import pillow_heif  # noqa: PLC0415 - the extra `heif`
    except ImportError:
        raise PhotoError(file.path, "is HEIC, which needs pillow-heif", INSTALL) from None
    moves = _moves(file.content)
    if moves and not child(memoryview(file.content), b"meta"):
        problem = "is HEIC that moves, without a still picture"
        raise PhotoError(file.path, problem, "export one of its frames as PNG")
    try:
        heif = pillow_heif.open_heif(file.path, convert_hdr_to_8bit=False, hdr_to_16bit=False)
        check_size(file.path, *heif.size)  # the header alone was read
        # Turned by libheif as the file's boxes say; EXIF's orientation, if any, repeats them.
        codes = np.asarray(heif)
    except _DAMAGE as error:
        raise _damaged(file, error) from error
    bits = int(heif.info.get("bit_depth", 8)) if codes.dtype == np.uint16 else 8
    exif = heif.info.get("exif") or b""
    gain_map, notes = _gain_map(heif, load_exif(exif), file.content)
    if moves:
        notes = (*notes, _STILL)
    if len(heif) > 1:
        notes = (*notes, f"of {len(heif)} pictures the one was read that the file calls its first")
    icc, told = heif.info.get("icc_profile") or b"", of_nclx(heif.info.get("nclx_profile"))
    return _Decoded(_planes(codes), bits, exif, icc, told, gain_map, notes)


def _gain_map(heif: Any, exif: Any, content: bytes) -> tuple[GainMap | None, tuple[str, ...]]:
    """A phone's gain map: an auxiliary image as Apple's, or what an item `tmap` is made of."""
    auxiliary = heif.info.get("aux", {})
    name = next((name for name in auxiliary if name.endswith(_GAIN_MAP) and auxiliary[name]), "")
    if name == APPLE:
        return _set_aside_or(lambda: _of_apple(heif.get_aux_image(auxiliary[name][0]), exif))
    told = tone_map_item(content)
    if told is None or not (name or told.picture):
        return None, ()

    def picture() -> Any:
        import pillow_heif  # noqa: PLC0415 - the extra `heif`

        if name:
            return np.asarray(heif.get_aux_image(auxiliary[name][0]))
        return np.asarray(pillow_heif.open_heif(BytesIO(with_primary(content, told.picture))))

    return _set_aside_or(lambda: _of_item(told, picture(), heif.size))


def _set_aside_or(found: Callable[[], GainMap]) -> tuple[GainMap | None, tuple[str, ...]]:
    """A gain map; or none, and a note with the reason."""
    try:
        return found(), ()
    except (GainMapError, PhotoError, ZeroDivisionError, struct.error, *_DAMAGE) as error:
        return None, (f"its gain map was set aside: {plain_text(error)}",)


def _of_apple(picture: Any, exif: Any) -> GainMap:
    return GainMap(_shares(np.asarray(picture)), *apple_numbers("", apple_headroom(exif)))


def _of_item(told: ToneMap, picture: Any, size: tuple[int, int]) -> GainMap:
    """Of an item `tmap` and its map, for a photo of some width and height."""
    numbers = item_numbers(told.numbers, told.rendition)
    values = _shares(picture)
    if values.shape[0] > size[1] or values.shape[1] > size[0]:  # as coarse as the photo, at most
        values = np.asarray(cv2.resize(values, size, interpolation=cv2.INTER_AREA))
    return replace(GainMap(values, *numbers), centered=True)


def _shares(codes: Any) -> npt.NDArray[np.float32]:
    """(h, w, 3) of 8-bit codes."""
    colors = three_channels(_color(_planes(codes)))
    return np.divide(colors, np.float32(255), dtype=np.float32)


def _read_avif(file: PhotoFile) -> _Decoded:
    from PIL import features  # noqa: PLC0415

    if not features.check("avif"):
        raise PhotoError(file.path, "is AVIF, which needs Pillow 11.3 or newer", INSTALL)
    try:
        codes, exif, icc = _picture_of_avif(file)
    except _DAMAGE as error:
        raise _damaged(file, error) from error
    gain_map, notes = _map_of_avif(file, codes.shape)
    if _moves(file.content):
        notes = (*notes, FIRST_OF_SEVERAL)
    if _is_deep_avif(file.content):
        notes = (*notes, "its more than 8 bits were read as 8")
    return _Decoded(codes, 8, exif, icc, of_boxes(file.content), gain_map, notes)


def _picture_of_avif(file: PhotoFile) -> tuple[npt.NDArray[Any], bytes, bytes]:
    """The photo, though libavif may not like its gain map."""
    try:
        return _by_pillow(file.path, file.path)
    except _DAMAGE:
        plain = without_brand(file.content, b"tmap")
        if plain == file.content:
            raise
        return _by_pillow(BytesIO(plain), file.path)


def _map_of_avif(file: PhotoFile, shape: Sequence[int]) -> tuple[GainMap | None, tuple[str, ...]]:
    told = tone_map_item(file.content)
    if told is None or not told.picture:
        return None, ()

    def found() -> GainMap:
        picture = BytesIO(with_primary(file.content, told.picture))
        return _of_item(told, _by_pillow(picture, file.path)[0], (shape[1], shape[0]))

    return _set_aside_or(found)


def _by_pillow(source: Any, path: Path) -> tuple[npt.NDArray[Any], bytes, bytes]:
    """(H, W, C) codes of an AVIF's picture, upright; its EXIF and profile."""
    from PIL import Image  # noqa: PLC0415

    with unwarned(), Image.open(source) as image:
        check_size(path, *image.size)
        exif = image.info.get("exif") or b""
        codes, icc = np.asarray(image), image.info.get("icc_profile") or b""
    return upright(_planes(codes), int(load_exif(exif).get(274, 1))), exif, icc


def _planes(codes: Any) -> Any:
    return codes if codes.ndim == 3 else codes[..., None]


def _color(codes: Any) -> Any:
    """Without alpha."""
    return codes[..., :3] if codes.shape[2] >= 3 else codes[..., 0]


def _moves(content: bytes) -> bool:
    """Whether there is a sequence of images (ISO 23008-12, clause 7)."""
    return bool(child(memoryview(content), b"moov"))


def _is_deep_avif(content: bytes) -> bool:
    """Whether AV1's configuration says `high_bitdepth` (AV1 in ISOBMFF, 2.3.3)."""
    at = content.find(b"av1C")
    return at >= 0 and len(content) > at + 6 and bool(content[at + 6] & 0x40)


def _damaged(file: PhotoFile, error: Exception) -> PhotoError:
    if isinstance(error, PhotoError):
        return error
    return PhotoError(file.path, f"is cut short or damaged ({plain_text(error)})", COPY_AGAIN)
