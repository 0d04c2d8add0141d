"""XMP: what software wrote about a picture, as text, and single properties of it."""

from __future__ import annotations

import re

from facecrf_ocio.photo.containers.jpeg_segments import JpegParts

_PACKET = re.compile(rb"<x:xmpmeta.*?</x:xmpmeta>|<rdf:RDF.*?</rdf:RDF>", re.DOTALL)
_IN_JPEG = b"http://ns.adobe.com/xap/1.0/\0"
_MARK = b"<rdf:RDF"
_SPACES = {
    "tiff": "http://ns.adobe.com/tiff/1.0/",
    "crs": "http://ns.adobe.com/camera-raw-settings/1.0/",
    "hdrgm": "http://ns.adobe.com/hdr-gain-map/1.0/",
    "HDRGainMap": "http://ns.apple.com/HDRGainMap/1.0/",
}
"""Namespaces by their usual prefixes (XMP part 2), which a packet may call otherwise."""


def xmp_of(content: bytes, jpeg: JpegParts | None) -> str:
    """First XMP packet of a file's bytes; empty where there is none.

    In JPEG it is a segment (XMP part 3, 1.1.3); elsewhere it stands uncompressed (part 3, 1).
    """
    if jpeg is not None:
        return b"".join(jpeg.contents(0xE1, _IN_JPEG)[:1]).decode("utf-8", "replace")
    if _MARK not in content:
        return ""
    packet = _PACKET.search(content)
    return "" if packet is None else packet[0].decode("utf-8", "replace")


def values_of(xmp: str, name: str) -> list[str]:
    """Values of a property such as `tiff:Orientation`, written as attribute, element, or list."""
    if name.rpartition(":")[2] not in xmp:  # of most photos: three patterns need not be compiled
        return []
    name = _as_called_in(xmp, name)
    attribute = re.search(rf"""\b{re.escape(name)}\s*=\s*(?:"([^"]*)"|'([^']*)')""", xmp)
    if attribute is not None:
        return [(attribute[1] if attribute[1] is not None else attribute[2]).strip()]
    element = re.search(rf"<{re.escape(name)}\b[^>]*>(.*?)</{re.escape(name)}>", xmp, re.DOTALL)
    if element is None:
        return []
    items = re.findall(r"<rdf:li\b[^>]*>([^<]*)</rdf:li>", element[1])
    return [item.strip() for item in items or [element[1]]]


def _as_called_in(xmp: str, name: str) -> str:
    """A property's name with the prefix that a packet has for its namespace."""
    prefix, _, local = name.partition(":")
    space = _SPACES.get(prefix)
    if space is None or f"{prefix}:{local}" in xmp:
        return name
    bound = re.search(rf"""xmlns:([\w.-]+)\s*=\s*["']{re.escape(space)}["']""", xmp)
    return name if bound is None else f"{bound[1]}:{local}"


def value_of(xmp: str, name: str) -> str:
    """The one value of a property; empty where there is none."""
    return next(iter(values_of(xmp, name)), "")
