"""JPEGs with gain maps, written byte by byte from the published layouts."""

from __future__ import annotations

import struct
from io import BytesIO
from typing import Any

import numpy as np
import numpy.typing as npt
from photo_files import segment, with_segments
from PIL import Image

_XMP = b"http://ns.adobe.com/xap/1.0/\0"
_ISO = b"urn:iso:std:iso:ts:21496:-1\0"


def jpeg(codes: npt.NDArray[np.uint8], icc: bytes = b"", *, sampling: str = "4:4:4") -> bytes:
    """Of the best quality; phones write color differences halved in both directions (4:2:0)."""
    out = BytesIO()
    profile = {"icc_profile": icc} if icc else {}
    Image.fromarray(codes).save(out, "JPEG", quality=100, subsampling=sampling, **profile)
    return out.getvalue()


def xmp(attributes: str, body: str = "") -> bytes:
    names = " ".join(
        f'xmlns:{name}="{uri}"'
        for name, uri in {
            "hdrgm": "http://ns.adobe.com/hdr-gain-map/1.0/",
            "Container": "http://ns.google.com/photos/1.0/container/",
            "Item": "http://ns.google.com/photos/1.0/container/item/",
            "HDRGainMap": "http://ns.apple.com/HDRGainMap/1.0/",
            "apdi": "http://ns.apple.com/pixeldatainfo/1.0/",
        }.items()
    )
    packet = (
        '<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-'
        f'syntax-ns#"><rdf:Description rdf:about="" {names} {attributes}>{body}</rdf:Description>'
        "</rdf:RDF></x:xmpmeta>"
    )
    return segment(0xE1, _XMP + packet.encode())


def ultra_hdr_numbers(**numbers: Any) -> bytes:
    """XMP of an Ultra HDR map; a list makes one number a channel."""
    said = {"Version": "1.0", "HDRCapacityMin": 0, "HDRCapacityMax": 3, **numbers}
    single = {name: value for name, value in said.items() if not isinstance(value, list)}
    lists = "".join(
        f"<hdrgm:{name}><rdf:Seq>{''.join(f'<rdf:li>{v}</rdf:li>' for v in values)}</rdf:Seq>"
        f"</hdrgm:{name}>"
        for name, values in said.items()
        if isinstance(values, list)
    )
    return xmp(" ".join(f'hdrgm:{name}="{value}"' for name, value in single.items()), lists)


def iso_numbers(
    channels: list[tuple[float, ...]], *, common: bool = False, base_space: bool = True
) -> bytes:
    """ISO 21496-1 of (low, high, gamma, base offset, offset) for one channel or three."""
    flags = 0x40 * base_space | 0x80 * (len(channels) == 3) | 0x08 * common
    said = _ISO + struct.pack(">HHB", 0, 0, flags)
    unit = 1 << 16
    if common:
        said += struct.pack(">III", unit, 0, 3 * unit)
        for numbers in channels:
            said += struct.pack(">iiIii", *(round(number * unit) for number in numbers))
        return segment(0xE2, said)
    said += struct.pack(">IIII", 0, 1, 3, 1)
    for numbers in channels:
        tops = [round(number * unit) for number in numbers]
        said += struct.pack(">iIiIIIiIiI", *(part for top in tops for part in (top, unit)))
    return segment(0xE2, said)


def with_gain_map(
    base: npt.NDArray[np.uint8],
    values: npt.NDArray[np.uint8],
    numbers: bytes,
    *,
    base_icc: bytes = b"",
    map_icc: bytes = b"",
    sampling: str = "4:4:4",
) -> bytes:
    """An Ultra HDR JPEG: two pictures, and segments that say so (CIPA DC-007, Google's XMP)."""
    gain_map = with_segments(jpeg(values, map_icc), numbers)
    encoded = jpeg(base, base_icc, sampling=sampling)
    container = xmp(
        'hdrgm:Version="1.0"',
        "<Container:Directory><rdf:Seq>"
        '<rdf:li rdf:parseType="Resource"><Container:Item Item:Semantic="Primary" '
        'Item:Mime="image/jpeg"/></rdf:li>'
        '<rdf:li rdf:parseType="Resource"><Container:Item Item:Semantic="GainMap" '
        f'Item:Mime="image/jpeg" Item:Length="{len(gain_map)}"/></rdf:li>'
        "</rdf:Seq></Container:Directory>",
    )
    plain = with_segments(encoded, container)
    size = len(plain) + 4 + 86
    first = with_segments(encoded, container, _mpf(size, len(gain_map), 2 + len(container) + 8))
    assert len(first) == size
    return first + gain_map


def _mpf(first: int, second: int, origin: int) -> bytes:
    """Multi-picture format: two pictures, the second right after the first."""
    entries = struct.pack(">IIIHH", 0x030000, first, 0, 0, 0)
    entries += struct.pack(">IIIHH", 0, second, first - origin, 0, 0)
    directory = struct.pack(">H", 3)
    directory += struct.pack(">HHI4s", 0xB000, 7, 4, b"0100")
    directory += struct.pack(">HHII", 0xB001, 4, 1, 2)
    directory += struct.pack(">HHII", 0xB002, 7, 32, 8 + 2 + 36 + 4)
    body = b"MM\0*" + struct.pack(">I", 8) + directory + bytes(4) + entries
    return segment(0xE2, b"MPF\0" + body)
