"""The picture of a file, opened with OpenImageIO: of several the photo, of a JPEG what is sound."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any

import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.files.plain_text import complaint, plain_text
from facecrf_ocio.photo.containers.jpeg_segments import JpegParts, take_apart
from facecrf_ocio.photo.containers.suffixes import HEAD, RAW, Kind, kind_named, kind_of
from facecrf_ocio.photo.containers.tiff_pages import (
    Page,
    holds_raw,
    photo_page,
    with_photo_first,
)
from facecrf_ocio.photo.decoding.channels import rgb_channels
from facecrf_ocio.photo.tags.xmp import xmp_of

# Phones append a second picture (CIPA DC-007) or a film, and say so here or in what follows.
_FOLLOWING = ("MotionPhoto", "MicroVideo", "Container:Directory")


class PhotoFile:
    """A photo's file: its kind by content, and its parts, each read when it is asked for."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @cached_property
    def head(self) -> bytes:
        """Its first bytes."""
        with self.path.open("rb") as file:
            return file.read(HEAD)

    @cached_property
    def kind(self) -> Kind | None:
        """By the first bytes; by the suffix where they tell of none; None where that is wrong."""
        head = self.head
        told, named = kind_of(head), kind_named(self.path)
        if told is not None or named is None or named.reader == RAW or not named.starts:
            return told or named
        return named if named.name == "JPEG" and take_apart(head) is not None else None

    @property
    def is_raw(self) -> bool:
        """Whether it is camera raw by its content, or by a name that its content does not deny."""
        if self.kind is None or self.kind.name != "TIFF":
            return self.kind is not None and self.kind.reader == RAW
        named = kind_named(self.path)
        plain = named is not None and named.name == "TIFF"
        told = holds_raw(self.content)
        if told or plain:
            return told
        from facecrf_ocio.photo.decoding.raw import libraw_takes  # noqa: PLC0415 - LibRaw, for few photos

        return libraw_takes(self.path)

    @cached_property
    def content(self) -> bytes:
        """All of its bytes."""
        return self.path.read_bytes()

    @cached_property
    def jpeg(self) -> JpegParts | None:
        """Its parts, if it is a JPEG."""
        is_jpeg = self.kind is not None and self.kind.name == "JPEG"
        return take_apart(self.content) if is_jpeg else None

    @cached_property
    def xmp(self) -> str:
        """Its XMP, empty without."""
        return xmp_of(self.content, self.jpeg)

    def forget(self) -> None:
        """Let its bytes go."""
        self.__dict__.pop("content", None)
        self.__dict__.pop("jpeg", None)


FIRST_OF_SEVERAL = "the first of several pictures was read"
"""Note on a file that holds more, none of them the photo before the others."""

MENDED = "picture.jpg"
"""Name of the copy of a mended file, most of which are JPEGs, in a folder of its own."""

_BELOW = "the photo was read that lies below its first page, a thumbnail"
# Attributes that are of a page's own pixels, by what their names start with.
_OF_PIXELS = ("tiff", "oiio", "compression", "planarconfig")


@dataclass(slots=True)
class Picture:
    """An open picture; `close` it.

    Attributes
    ----------
    source
        OpenImageIO's input, at the photo among its pictures.
    page
        Index of that.
    notes
        What was mended or chosen, in clauses.
    """

    source: Any
    page: int = 0
    notes: tuple[str, ...] = ()
    kept: Any = None
    page_above: Any = None

    @property
    def spec(self) -> Any:
        """What OpenImageIO says of it, and of its camera where the page above it alone tells."""
        spec = oiio.ImageSpec(self.source.spec())
        for told in () if self.page_above is None else self.page_above.extra_attribs:
            of_pixels = told.name.partition(":")[0] in _OF_PIXELS
            if not of_pixels and spec.getattribute(told.name) is None:
                spec.attribute(told.name, told.type, told.value)
        return spec

    def close(self) -> None:
        """Let the file go, and the copy of it, if one was made."""
        self.source.close()
        if self.kept is not None:
            self.kept.cleanup()


def open_image(path: Path) -> tuple[Any | None, str]:
    """Open a file with OpenImageIO, colors not multiplied by alpha; None and why if it cannot be.

    Whoever opens need not ask OpenImageIO for its reason, which it else prints at exit, on stdout.
    """
    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)
    source = oiio.ImageInput.open(str(path), hints)
    said = complaint(oiio.geterror)
    return source, "" if source is not None else said or "no reason given"


def open_picture(file: PhotoFile) -> tuple[Picture | None, str]:
    """Open what is the photo in a file; None, and why, if OpenImageIO cannot."""
    if file.jpeg is not None and file.jpeg.picture != file.content:
        return _open_copy(file.jpeg.picture, tuple(_mended(file.jpeg, file.xmp)))
    source, why = open_image(file.path)
    if source is None:
        return None, why
    photo_first = _photo_first(file.path) if source.format_name() == "tiff" else None
    if photo_first is not None:
        return _open_copy(photo_first, (_BELOW,), source.spec())
    # OpenImageIO finds no way back to a WebP's first picture where there is no second.
    if source.spec().get_int_attribute("oiio:Movie") and file.content.count(b"ANMF") > 1:
        return Picture(source, 0, (FIRST_OF_SEVERAL,)), ""
    choose = {"tiff": _at_photo, "openexr": _at_colors, "gif": _at_first}
    return choose.get(source.format_name(), Picture)(source), ""


def _photo_first(path: Path) -> bytes | None:
    # Mapped: an EXR's header asks as well, while all pixels are in memory.
    with path.open("rb") as file, mmap(file.fileno(), 0, access=ACCESS_READ) as content:
        return with_photo_first(content)


def _open_copy(
    content: bytes, notes: tuple[str, ...], page: Any = None
) -> tuple[Picture | None, str]:
    """OpenImageIO reads files alone, and takes an appended gain map for a part of the pixels."""
    folder = tempfile.TemporaryDirectory(prefix="facecrf-")
    copy = Path(folder.name) / MENDED
    copy.write_bytes(content)
    source, why = open_image(copy)
    if source is None:
        folder.cleanup()
        return None, why
    return Picture(source, 0, notes, folder, page), ""


def _mended(jpeg: JpegParts, xmp: str) -> list[str]:
    notes = []
    if jpeg.stray:
        notes.append(f"{jpeg.stray} stray bytes before its pixels were left out")
    if not jpeg.ended:
        notes.append("the mark that ends the JPEG is missing, and no pixel with it")
    rest = jpeg.rest.strip(b"\0\xff")
    told = jpeg.contents(0xE2, b"MPF\0") or any(name in xmp for name in _FOLLOWING)
    if rest and not told and not rest.startswith(b"\xd8") and b"ftyp" not in rest[:64]:
        notes.append(f"{len(jpeg.rest)} bytes after the picture's end were left out")
    return notes


def _at_photo(source: Any) -> Picture:
    """A TIFF at the page that is the photo."""
    pages = [
        Page(spec.width * spec.height, spec.get_int_attribute("tiff:subfiletype"))
        for spec in _specs(source)
    ]
    chosen = photo_page(pages)
    source.seek_subimage(chosen, 0)
    several = chosen > 0 or sum(not page.is_aside for page in pages) > 1
    note = f"page {chosen + 1} of {len(pages)} was read, the largest that is no thumbnail"
    return Picture(source, chosen, (note,) if several else ())


def _at_colors(source: Any) -> Picture:
    """An EXR at the first of its parts that has colors; they may be layers, distances or views."""
    parts = [
        (spec.get_string_attribute("oiio:subimagename"), rgb_channels(spec) is not None)
        for spec in _specs(source)
    ]
    colored = [index for index, (_, has_colors) in enumerate(parts) if has_colors]
    chosen = next(iter(colored), 0)
    source.seek_subimage(chosen, 0)
    name = plain_text(parts[chosen][0]) or "without a name"
    note = f"part {chosen + 1} of {len(parts)} ({name}) was read, the first with R, G and B"
    return Picture(source, chosen, (note,) if chosen > 0 or len(colored) > 1 else ())


def _at_first(source: Any) -> Picture:
    """A picture that may move."""
    moves = source.seek_subimage(1, 0)
    complaint(source.geterror)
    source.seek_subimage(0, 0)
    return Picture(source, 0, (FIRST_OF_SEVERAL,) if moves else ())


def _specs(source: Any) -> Iterator[Any]:
    """What OpenImageIO says of each of a file's pictures."""
    number = 0
    while source.seek_subimage(number, 0):
        yield source.spec()
        number += 1
    complaint(source.geterror)  # that there is none after the last
