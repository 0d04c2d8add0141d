"""`facecrf-oiio`: one image file through a LUT into another."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.errors import (
    FaceCRFError,
    LutError,
    OutputError,
    PhotoError,
    SettingsError,
)
from facecrf_ocio.files.atomic import require_free
from facecrf_ocio.files.plain_text import one_line
from facecrf_ocio.image.compression import COMPRESSION, require_compression
from facecrf_ocio.image.lookup import Lookup
from facecrf_ocio.image.lut_lookup import lut_lookup
from facecrf_ocio.image.output import write_image_file
from facecrf_ocio.lut.transform import DIRECTIONS
from facecrf_ocio.photo.containers.integrity import COPY_AGAIN, check_file, check_size
from facecrf_ocio.photo.decoding.channels import alpha_channel, is_premultiplied
from facecrf_oiio.buffer import color_of, fill, linearize

_CODES = {OutputError: 1, SettingsError: 2, PhotoError: 3, LutError: 3}
_FORMATS = {".exr": "openexr", ".tif": "tiff", ".tiff": "tiff"}
_GEOMETRY = re.compile(r"(\d+)x(\d+)([+-]\d+)([+-]\d+)")
_FINE = (oiio.UINT8, oiio.HALF)  # types that half floats hold as they are


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; exits with its code."""
    sys.exit(run(arguments))


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code; problems are told in one line on stderr."""
    given = _parser().parse_args(arguments)
    try:
        _convert(given)
    except (FaceCRFError, MemoryError) as error:
        print(f"facecrf-oiio: {one_line(_told(error))}", file=sys.stderr)
        return next((code for kind, code in _CODES.items() if isinstance(error, kind)), 1)
    return 0


def _told(error: Exception) -> str:
    if isinstance(error, FaceCRFError):
        return error.on_command_line()
    return "not enough memory; use a smaller image or --roi"


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(2, f"facecrf-oiio: {message}; see facecrf-oiio --help\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="facecrf-oiio", description="Send an image file through a LUT.")
    parser.add_argument("image", type=Path, help="any image OpenImageIO reads")
    parser.add_argument("--lut", type=Path, required=True, help="any LUT OpenColorIO reads")
    parser.add_argument(
        "--direction",
        choices=DIRECTIONS,
        help="toward light or away from it; needed for a LUT that encodes",
    )
    parser.add_argument("-o", dest="output", type=Path, required=True, help=".exr or .tif")
    parser.add_argument("-d", dest="dtype", choices=("half", "float"), default="half")
    parser.add_argument(
        "--compression",
        default=COMPRESSION,
        help=f"as OpenImageIO names it, with a level or without; by default {COMPRESSION}",
    )
    parser.add_argument("--roi", metavar="WxH+X+Y", help="region to write; by default all")
    parser.add_argument(
        "--colorspace", default="auto", help="what to tag the result with, e.g. lin_ap1_scene"
    )
    parser.add_argument("--overwrite", action="store_true", help="replace an existing file")
    return parser


def _convert(given: argparse.Namespace) -> None:
    image, output = given.image, given.output
    if output.suffix.lower() not in _FORMATS:
        raise OutputError(f"{output}: cannot hold linear light; name it .exr or .tif")
    require_free(output, overwrite=given.overwrite)
    if _FORMATS[output.suffix.lower()] == "openexr":
        require_compression(given.compression)
    roi = _roi(given.roi)
    check_file(image)
    if output.exists() and output.samefile(image):
        raise OutputError(f"{output}: is the image itself; choose another name")
    lookup = lut_lookup(given.lut, given.direction)
    parts, file_format = _parts(image), _FORMATS[output.suffix.lower()]
    finished = [
        _finished(
            part, lookup, given.dtype, roi, given.colorspace, file_format, alone=len(parts) == 1
        )
        for part in parts
    ]
    for part in finished:
        part.image.specmod().attribute("compression", given.compression)
    write_image_file(output, partial(_write, finished, file_format), overwrite=given.overwrite)


def _roi(geometry: str | None) -> oiio.ROI | None:
    if geometry is None:
        return None
    found = _GEOMETRY.fullmatch(geometry)
    if found is None:
        raise SettingsError(f"{geometry!r} is no region; give WIDTHxHEIGHT+X+Y")
    width, height, x, y = (int(number) for number in found.groups())
    return oiio.ROI(x, x + width, y, y + height)


def _parts(path: Path) -> list[_Part]:
    """All images of a file, in memory, colors not multiplied by alpha where the file's are not."""
    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(str(path), hints)
    if source is None:
        problem = oiio.geterror().strip().partition("\n")[0]
        raise PhotoError(path, f"is not an image that can be read ({problem})", COPY_AGAIN)
    parts = []
    while source.seek_subimage(len(parts), 0):
        parts.append(_read(path, source, len(parts)))
    source.geterror()
    source.close()
    return parts


def _read(path: Path, source: Any, number: int) -> _Part:
    # Not by ImageBuf.read, which is silent about files that are cut short.
    spec = source.spec()
    check_size(path, spec.width, spec.height)
    if spec.deep:
        raise PhotoError(path, "is a deep image", "flatten it first (oiiotool --flatten)")
    pixels = source.read_image(number, 0, 0, spec.nchannels, spec.format)
    problem = source.geterror().strip().partition("\n")[0].replace(f'("{path}")', "").strip()
    if problem or pixels is None or pixels.size == 0:
        raise PhotoError(path, f"is cut short or damaged ({problem or 'no pixels'})", COPY_AGAIN)
    types = tuple(spec.channelformat(channel) for channel in range(spec.nchannels))
    header = oiio.ImageSpec(spec)
    header.channelformats = ()
    told = 0 if is_premultiplied(spec, source.format_name()) else 1
    header.attribute("oiio:UnassociatedAlpha", told)
    if "rec709" in header.get_string_attribute("oiio:ColorSpace"):
        header.erase_attribute("oiio:ColorSpace")  # said of all files that tell nothing
    image = oiio.ImageBuf(header)
    fill(image, pixels)
    return _Part(path, image, types)


@dataclass(frozen=True)
class _Part:
    """One image of a file and the type of each channel there."""

    path: Path
    image: oiio.ImageBuf
    types: tuple[Any, ...]


def _finished(
    part: _Part,
    lookup: Lookup,
    dtype: str,
    roi: oiio.ROI | None,
    colorspace: str,
    file_format: str,
    *,
    alone: bool,
) -> _Part:
    """A linear image as it goes into the file, colors multiplied by alpha, and its types there."""
    spec, types = part.image.spec(), part.types
    try:
        color = color_of(spec, part.path)
    except PhotoError:  # depth, normals and the like
        if alone:
            raise
        return replace(part, image=_region_of(part.image, roi))
    keeping = [index for index in range(spec.nchannels) if index not in color]
    wanted = oiio.TypeDesc(dtype)
    mixed = file_format == "openexr" and any(types[i].basetype not in _FINE for i in keeping)
    mixed = mixed and dtype == "half"
    linear = linearize(
        part.image,
        lookup,
        dtype=oiio.FLOAT if mixed else wanted.basetype,
        roi=roi,
        colorspace=colorspace,
    )
    if spec.get_int_attribute("oiio:UnassociatedAlpha") and alpha_channel(spec) is not None:
        oiio.ImageBufAlgo.premult(linear, linear)
    linear.specmod().erase_attribute("oiio:UnassociatedAlpha")
    written = (
        _file_type(kind) if mixed and index in keeping else wanted
        for index, kind in enumerate(types)
    )
    return _Part(part.path, linear, tuple(written))


def _file_type(kind: Any) -> Any:
    """The type an EXR file holds a channel in that is no color: no coarser than it was."""
    if kind.basetype in _FINE:
        return oiio.TypeDesc(oiio.HALF)
    return oiio.TypeDesc(oiio.UINT32 if kind.basetype == oiio.UINT32 else oiio.FLOAT)


def _region_of(part: oiio.ImageBuf, roi: oiio.ROI | None) -> oiio.ImageBuf:
    if roi is None:
        return part
    return oiio.ImageBufAlgo.crop(part, oiio.intersection(roi, part.roi))


def _write(parts: Sequence[_Part], file_format: str, path: Path) -> str:
    """Write all parts; OpenImageIO's complaint if it cannot."""
    headers = []
    for part in parts:
        header = oiio.ImageSpec(part.image.spec())
        header.set_format(part.types[0])
        header.channelformats = part.types if len(set(map(str, part.types))) > 1 else ()
        headers.append(header)
    output: Any = oiio.ImageOutput.create(file_format)
    together = len(parts) > 1 and output.supports("multiimage")
    done = output.open(str(path), headers) if together else output.open(str(path), headers[0])
    for number, part in enumerate(parts):
        if done and number:
            done = output.open(str(path), headers[number], "AppendSubimage")
        done = done and part.image.write(output)
    problem = output.geterror() or "".join(part.image.geterror() for part in parts)
    done = output.close() and done
    return "" if done else problem or output.geterror() or "no reason given"
