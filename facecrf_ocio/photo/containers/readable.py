"""Which kinds of photo files can be read with what is installed here."""

from __future__ import annotations

from importlib.util import find_spec

import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.photo.containers.suffixes import HEIF, KINDS, RAW


def readable_kinds() -> tuple[tuple[str, bool], ...]:
    """Name of every kind, and whether its files can be read here."""
    listed = str(oiio.get_string_attribute("extension_list"))
    known = {suffix for entry in listed.split(";") for suffix in entry.partition(":")[2].split(",")}
    found = []
    for kind in KINDS:
        if kind.reader == HEIF:
            can = find_spec("pillow_heif") is not None
        else:
            can = kind.reader == RAW or any(s.lstrip(".") in known for s in kind.suffixes)
        found.append((kind.name, can))
    return tuple(found)
