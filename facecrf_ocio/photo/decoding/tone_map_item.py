"""The derived item `tmap` of HEIF: a gain map that is an image of its own (ISO 21496-1)."""

from __future__ import annotations

from dataclasses import dataclass

from facecrf_ocio.photo.containers.heif_boxes import (
    item_content,
    items,
    made_of,
    meta_box,
    properties,
)
from facecrf_ocio.photo.tags.cicp import of_color_box
from facecrf_ocio.photo.tags.profile import primaries_from_icc
from facecrf_ocio.values import Primaries

_TONE_MAP = b"tmap"


@dataclass(frozen=True, slots=True)
class ToneMap:
    """What the item says.

    Attributes
    ----------
    numbers
        Metadata of ISO 21496-1, from its versions on.
    picture
        Number of the item that is the map; 0 where the file does not say.
    rendition
        Primaries of the HDR light; None where they have no name here.
    """

    numbers: bytes
    picture: int = 0
    rendition: Primaries | None = None


def tone_map_item(content: bytes) -> ToneMap | None:
    """The first `tmap` of a file; None where there is none, or one of another version."""
    try:
        whole = memoryview(content)
        meta = meta_box(whole)
        item = next(items(meta, _TONE_MAP), None)
        if item is None:
            return None
        said = bytes(item_content(whole, meta, item))
    except IndexError:
        return None
    if said[:1] != b"\0":  # version 0 of the item is the one there is
        return None
    try:
        sources = made_of(meta, item)
        color = _primaries(meta, item)
    except IndexError:
        sources, color = [], None
    return ToneMap(said[1:], sources[1] if len(sources) == 2 else 0, color)  # the photo, its map


def _primaries(meta: memoryview, item: int) -> Primaries | None:
    told = (bytes(held) for kind, held in properties(meta, item) if kind == b"colr")
    color = next(told, b"")
    if color[:4] in (b"prof", b"rICC"):
        return primaries_from_icc(color[4:])
    points = of_color_box(color)
    return points.named_primaries() if points else None
