"""What a file says was done to a photo after the camera: its curve is then the editor's too."""

from __future__ import annotations

import re

from facecrf_ocio.photo.xmp import value_of

# Programs that render light and color anew, by how they sign in EXIF's Software or XMP's
# CreatorTool. Those that only file, crop or transfer are left out.
_EDITORS = re.compile(
    r"photoshop|lightroom|camera raw|capture one|darktable|rawtherapee|dxo|luminar|affinity photo|"
    r"gimp|snapseed|instagram|vsco|picsart|facetune|beautyplus|meitu|faceapp|prisma|photomatix|"
    r"aurora hdr|polarr|pixelmator|paint\.net|picasa|topaz",
    re.IGNORECASE,
)
# Adobe's settings that treat places of a picture unlike each other.
_LOCAL = (
    *("Clarity2012", "Texture", "Dehaze", "Highlights2012", "Shadows2012", "FillLight"),
    *("HighlightRecovery", "LocalContrast", "Clarity"),
)
_PARTS = ("GradientBasedCorrections", "PaintBasedCorrections", "MaskGroupBasedCorrections")


def edits_told(xmp: str, software: str) -> tuple[str, ...]:
    """Clauses on edits that the file tells of; empty where it tells of none."""
    edits: list[str] = []
    for said in (software, value_of(xmp, "xmp:CreatorTool")):
        if _EDITORS.search(said) and not edits:
            edits.append(f"it was edited ({said[:60]})")
    local = [name for name in _LOCAL if value_of(xmp, f"crs:{name}").strip("+-0. ")]
    local += [name for name in _PARTS if f"<crs:{name}" in xmp]
    if local:
        edits.append(f"places were developed unlike each other ({', '.join(local)})")
    return tuple(edits)
