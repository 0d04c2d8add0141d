"""From code values to linear light, by a curve or by any LUT file, and on to a scene-linear EXR."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.errors import LutError, OutputError, SettingsError
from facecrf_ocio.export.atomic import Draft, require_free, write_files
from facecrf_ocio.pixels import code_grid
from facecrf_ocio.profile import known_primaries
from facecrf_ocio.read import open_image
from facecrf_ocio.values import InverseCRF, Photo, Primaries

Float32 = npt.NDArray[np.float32]

HALF_MAX = 65504.0
_LARGEST_TABLE = 16  # [bit]

# Color Interop Forum, recommendation 03; other primaries have no identifier.
_INTEROP_ID = {
    "Rec.709": "lin_rec709_scene",
    "Display P3": "lin_p3d65_scene",
    "Rec.2020": "lin_rec2020_scene",
    "Adobe RGB": "lin_adobergb_scene",
}
# What the source says of its own encoding, layout and upbringing, none of which is true of the
# EXR: its pixels are linear, upright and in other types. Maker notes hold offsets into the source.
_NOT_KEPT = re.compile(
    r"(oiio|openexr|jpeg|png|tiff|gif|webp|dpx|cineon|psd|jpeg2000|heif|bmp|targa|ico|hdr|raw|"
    r"ICCProfile|ICCProfile:.*|photoshop|thumbnail.*)(:.*)?|"
    r"Exif:(ColorSpace|Gamma|Pixel[XY]Dimension|YCbCr.*|Compressed.*|Components.*|MakerNote|"
    r"Interoperability.*|WhitePoint|PrimaryChromaticities|TransferFunction)|"
    r"Orientation|compression|planarconfig|chromaticities|colorInteropID|whiteLuminance|"
    r"acesImageContainerFlag|screenWindow.*|textureformat|wrapmodes|CICP|.*thumbnail.*",
    re.IGNORECASE,
)


def linearize_photo(photo: Photo, curve: InverseCRF) -> Float32:
    """Map a photo's code values to relative linear light.

    Parameters
    ----------
    photo
        The photo; one that is scene-linear already is returned as it is.
    curve
        The inverse camera response.

    Returns
    -------
    numpy.ndarray
        (H, W, 3), equal to `curve.linearize(photo.encoded)`.
    """
    return photo.encoded if photo.scene_linear else _map_codes(photo, curve.linearize)


def apply_lut(photo: Photo, lut: str | Path) -> Float32:
    """Send a photo through a LUT file, as `oiiotool PHOTO --ociofiletransform LUT` does.

    Parameters
    ----------
    photo
        The photo, scene-linear or not.
    lut
        Any file OpenColorIO reads; used forward. Values outside of its domain are clamped.

    Returns
    -------
    numpy.ndarray
        (H, W, 3) what the LUT makes of the code values.

    Raises
    ------
    LutError
        If the file is missing, is not a LUT, or gives NaN or infinities.
    """
    lut = Path(lut)
    processor = lut_processor(lut)
    cpu = processor.getOptimizedCPUProcessor(ocio.OptimizationFlags.OPTIMIZATION_LOSSLESS)

    def transform(values: Float32) -> Float32:
        result = np.array(values, np.float32, order="C")
        cpu.applyRGB(result)
        return result

    separable = not processor.hasChannelCrosstalk()
    result = _map_codes(photo, transform) if separable else transform(photo.encoded)
    if not np.isfinite(result.sum(dtype=np.float64)):
        raise LutError(f"{lut}: gives NaN or infinite values; make the LUT again")
    return result


def write_exr(
    path: str | Path,
    linear: Float32,
    photo: Photo,
    *,
    provenance: Mapping[str, str],
    half: bool = True,
    compression: str = "zip",
    overwrite: bool = False,
) -> Path:
    """Write linear light as a scene-linear OpenEXR file, whole or not at all.

    Parameters
    ----------
    path
        The file, named .exr.
    linear
        (H, W, 3) relative linear light.
    photo
        Where it comes from: gives alpha (colors are multiplied by it, as OpenEXR has it),
        primaries, and the metadata of its file that still hold.
    provenance
        Written as attributes `facecrf:KEY`.
    half
        16-bit floats, values clamped to 65504, or 32-bit floats.
    compression
        Any of OpenEXR: `none`, `rle`, `zip`, `zips`, `piz`, `dwaa`, ...
    overwrite
        Replace an existing file. The photo itself is never replaced.

    Returns
    -------
    pathlib.Path
        The file written.

    Raises
    ------
    OutputError
        If it exists and `overwrite` is false, or cannot be written.
    """
    path = Path(path)
    if linear.shape != photo.encoded.shape:
        raise SettingsError(f"{linear.shape} pixels do not belong to a {photo.encoded.shape} photo")
    if path.suffix.lower() != ".exr":
        raise OutputError(f"{path}: is not named as OpenEXR; give it the suffix .exr")
    require_free(path, overwrite=overwrite)
    if photo.path is not None and path.exists() and path.samefile(photo.path):
        raise OutputError(f"{path}: is the photo itself; choose another name")
    pixels = _associated(linear, photo)
    if half:
        pixels = np.clip(pixels, -HALF_MAX, HALF_MAX)
    header = _header(pixels.shape, photo, provenance, oiio.HALF if half else oiio.FLOAT)
    header.attribute("compression", compression)
    content = _encode(path, header, np.ascontiguousarray(pixels))
    (written,) = write_files([Draft(path, content, _check_opens)], overwrite=overwrite)
    return written


def _map_codes(photo: Photo, transform: Callable[[Float32], Float32]) -> Float32:
    """Apply a transform of (..., 3) that keeps channels apart; once per code where codes are few.

    Photos with alpha may hold values between codes, where their file had them multiplied by it.
    """
    bits = photo.bit_depth
    if bits is None or bits > _LARGEST_TABLE or photo.alpha is not None:
        return transform(photo.encoded)
    grid = code_grid(bits)
    table = transform(np.repeat(grid[:, None], 3, axis=1))
    if bits == 8:
        codes = cv2.convertScaleAbs(photo.encoded, alpha=255)
        return np.asarray(cv2.LUT(codes, table[None]), np.float32)
    codes = np.rint(photo.encoded * np.float32(grid.size - 1)).astype(np.uint16)
    result = np.empty_like(photo.encoded)
    for channel in range(3):
        result[..., channel] = np.take(np.ascontiguousarray(table[:, channel]), codes[..., channel])
    return result


def lut_processor(lut: Path) -> Any:
    """The processor of one LUT file, as it is on the disk now."""
    if not lut.is_file():
        problem = (
            "is a folder; name a LUT file" if lut.is_dir() else "does not exist; check the name"
        )
        raise LutError(f"{lut}: {problem}")
    # OpenColorIO remembers files by name, and would give what the file held before; and it puts
    # the environment's variables into names, unless the context is an empty one.
    ocio.ClearAllCaches()
    source = str(lut.resolve())
    transform = ocio.FileTransform(src=source, interpolation=ocio.Interpolation.INTERP_BEST)
    try:
        processor = ocio.Config.CreateRaw().getProcessor(
            context=ocio.Context(),
            transform=transform,
            direction=ocio.TransformDirection.TRANSFORM_DIR_FORWARD,
        )
    except ocio.Exception as error:
        problem = " ".join(str(error).split()).replace(source, lut.name)[:240].strip(" .")
        raise LutError(
            f"{lut}: OpenColorIO cannot read it ({problem}); give a LUT file such as .spi1d, "
            ".cube or .clf"
        ) from error
    # OpenColorIO takes a table with NaN for the identity.
    tables = [
        part.getData() for part in processor.createGroupTransform() if hasattr(part, "getData")
    ]
    if not all(np.isfinite(table).all() for table in tables):
        raise LutError(f"{lut}: holds NaN or infinite values; make the LUT again")
    return processor


def _associated(linear: Float32, photo: Photo) -> Float32:
    """(H, W, 3), or (H, W, 4) with colors multiplied by alpha."""
    if photo.alpha is None:
        return linear
    alpha = photo.alpha[..., None]
    return np.concatenate([linear * alpha, alpha], axis=2)


def _header(
    shape: tuple[int, ...], photo: Photo, provenance: Mapping[str, str], kind: Any
) -> oiio.ImageSpec:
    height, width, count = shape
    header = oiio.ImageSpec(width, height, count, kind)
    header.channelnames = ("R", "G", "B", "A")[:count]
    if photo.path is not None:
        _keep_metadata(photo.path, header)
    header.attribute("Orientation", 1)
    primaries = photo.primaries or known_primaries("Rec.709", "assumed")
    interop_id = _INTEROP_ID.get(primaries.name, "unknown")
    header.attribute("oiio:ColorSpace", interop_id)
    header.attribute("colorInteropID", interop_id)
    header.attribute("chromaticities", oiio.TypeDesc("float[8]"), _chromaticities(primaries))
    notes = {"primaries": _primaries_note(primaries), **provenance}
    for name, value in notes.items():
        header.attribute(f"facecrf:{name}", value)
    return header


def _keep_metadata(path: Path, header: oiio.ImageSpec) -> None:
    source = open_image(path)
    if source is None:  # moved meanwhile, or camera raw: nothing to keep
        oiio.geterror()
        return
    for item in source.spec().extra_attribs:
        if not _NOT_KEPT.fullmatch(item.name):
            _copy_attribute(item, header)
    source.close()


def _copy_attribute(item: Any, header: oiio.ImageSpec) -> None:
    # OpenImageIO drops short integers without a word; Python's own become 32-bit ones.
    if isinstance(item.value, int | float | str):
        header.attribute(item.name, item.value)
    else:
        header.attribute(item.name, item.type, item.value)


def _chromaticities(primaries: Primaries) -> tuple[float, ...]:
    return (*primaries.red, *primaries.green, *primaries.blue, *primaries.white)


def _primaries_note(primaries: Primaries) -> str:
    if primaries.source == "assumed":
        return f"assumed {primaries.name}"
    return f"{primaries.name} by {primaries.source}"


def _encode(path: Path, header: oiio.ImageSpec, pixels: Float32) -> bytes:
    """The bytes of an EXR file, which OpenImageIO can write to a disk only."""
    try:
        with tempfile.TemporaryDirectory(prefix=".facecrf-", dir=path.parent) as folder:
            file = Path(folder) / "linear.exr"
            output: Any = oiio.ImageOutput.create("openexr")
            written = output.open(str(file), header) and output.write_image(pixels)
            if not (output.close() and written):
                problem = output.geterror().strip().partition("\n")[0]
                raise OutputError(
                    f"{path}: cannot be written ({problem}); check the free space of the disk"
                )
            return file.read_bytes()
    except OSError as error:
        problem = (error.strerror or str(error)).lower()
        raise OutputError(
            f"{path}: cannot be written ({problem}); choose a folder that exists, is yours to "
            "write to and has space left"
        ) from error


def _check_opens(path: Path) -> None:
    written = open_image(path)
    if written is None:
        raise OutputError(f"{path}: does not read back ({oiio.geterror()}); write it again")
    written.close()
