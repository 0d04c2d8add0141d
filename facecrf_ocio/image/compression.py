"""How EXRs are compressed: OpenEXR's schemes by OpenImageIO's names, and levels of those with one.

OpenImageIO takes a name or level that it does not know for ZIP of OpenEXR's own level, and says
nothing. Read without the libraries for images, since the command line offers these names.
"""

from __future__ import annotations

from facecrf_ocio.errors import SettingsError

COMPRESSION = "zip:1"
"""Of every EXR: without loss, read by all, in little time.

OpenEXR's own level (4) takes 1.3 to 1.7 times as long to write, for files 2 to 8 % smaller
(`docs/evidence/speed.md`).
"""
COMPRESSIONS = (
    *("none", "rle", "zip", "zips", "piz"),
    *("pxr24", "b44", "b44a", "dwaa", "dwab"),
)
_DEFLATE = range(1, 10)  # [level] what OpenImageIO tells from a level that it does not know
_LOSS = range(1, 501)  # [level] OpenEXR's own is 45; at 500 a photo errs by 1 % of white
LEVELS = {"zip": _DEFLATE, "zips": _DEFLATE, "dwaa": _LOSS, "dwab": _LOSS}
"""Of schemes that have them: effort of deflate, or how much may be lost."""


def require_compression(name: str) -> str:
    """Return the name of a compression, such as `piz` or, with a level, `zip:1`.

    Raises
    ------
    SettingsError
        If OpenEXR has none such.
    """
    scheme, colon, level = name.partition(":")
    if scheme not in COMPRESSIONS:
        raise SettingsError(f"{name!r} is not one of {', '.join(COMPRESSIONS)}")
    levels = LEVELS.get(scheme)
    if colon and levels is None:
        raise SettingsError(f"{name!r}: {scheme} has no levels; leave out {colon + level!r}")
    if colon and levels is not None and level not in map(str, levels):
        raise SettingsError(f"{name!r}: give a level from {levels[0]} to {levels[-1]}")
    return name
