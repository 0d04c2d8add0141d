"""What a file says was done to a photo after the camera: its curve is then the editor's too."""

from __future__ import annotations

import re
from collections.abc import Sequence

from facecrf_ocio.photo.tags.xmp import value_of
from facecrf_ocio.values import Camera

# Programs that render light and color anew, by how they sign in EXIF's Software or XMP's
# CreatorTool. Those that only file, crop or transfer are left out.
_EDITORS = re.compile(
    r"photoshop|lightroom|camera raw|capture one|darktable|rawtherapee|dxo|luminar|affinity photo|"
    r"gimp|snapseed|instagram|vsco|picsart|facetune|beautyplus|meitu|faceapp|prisma|photomatix|"
    r"aurora hdr|polarr|pixelmator|paint\.net|picasa|topaz",
    re.IGNORECASE,
)
# Programs that make pictures of words, by their names in the same places.
_GENERATORS = re.compile(
    r"midjourney|stable diffusion|dall.?e\b|novelai|comfyui|invokeai|adobe firefly", re.IGNORECASE
)
# What generators write beside a PNG's pixels (automatic1111; ComfyUI).
_RECIPE = re.compile(r"\bSteps: \d+, |\"class_type\"")
# IPTC's code for where a picture comes from, in XMP and in C2PA's manifests. Of its terms those
# that leave a camera's curve out, in whole or in part (cv.iptc.org/newscodes/digitalsourcetype).
_SOURCE = b"/digitalsourcetype/"
_NO_CAMERA = (
    *("trainedAlgorithmicMedia", "algorithmicMedia", "compositeSynthetic", "dataDrivenMedia"),
    *("compositeWithTrainedAlgorithmicMedia", "virtualRecording", "screenCapture"),
    *("digitalArt", "digitalCreation", "composite"),
)
# EXIF's CustomRendered as Apple has it (ExifTool, "EXIF Tags", 0xa401); 4 is the one exposure that
# is kept beside an HDR picture.
_OF_APPLE = {
    2: "HDR",
    3: "HDR",
    6: "a panorama",
    7: "portrait mode with HDR",
    8: "portrait mode",
}
# Adobe's settings that treat places of a picture unlike each other.
_LOCAL = (
    *("Clarity2012", "Texture", "Dehaze", "Highlights2012", "Shadows2012", "FillLight"),
    *("HighlightRecovery", "LocalContrast", "Clarity"),
)
_PARTS = ("GradientBasedCorrections", "PaintBasedCorrections", "MaskGroupBasedCorrections")


def edits_told(xmp: str, software: str, made: Sequence[str] = ()) -> tuple[str, ...]:
    """Clauses on edits that the file tells of, beside how it was made; empty where of none."""
    edits: list[str] = []
    for said in (software, value_of(xmp, "xmp:CreatorTool")):
        if _GENERATORS.search(said) and not (edits or made):
            edits.append(f"no camera took it ({said[:60]})")
        if _EDITORS.search(said) and not edits:
            edits.append(f"it was edited ({said[:60]})")
    local = [name for name in _LOCAL if value_of(xmp, f"crs:{name}").strip("+-0. ")]
    local += [name for name in _PARTS if f"<crs:{name}" in xmp]
    if local:
        edits.append(f"places were developed unlike each other ({', '.join(local)})")
    return (*made, *edits)


def made_as_told(
    content: bytes, camera: Camera, rendered: int = 0, beside: str = ""
) -> tuple[str, ...]:
    """Clauses on how a picture came to be, where no camera's one curve did it.

    Parameters
    ----------
    content
        The file's bytes.
    camera
        What it tells of the camera.
    rendered
        EXIF's CustomRendered.
    beside
        Text of a PNG beside its pixels.
    """
    made = [f"no camera took it, or not all of it ({name})" for name in _sources(content)[:1]]
    if not made and _RECIPE.search(beside):
        made.append("no camera took it (a generator's recipe is beside it)")
    how = _OF_APPLE.get(rendered) if camera.make == "Apple" else None
    if how is not None:
        made.append(f"the camera treated places unlike each other ({how})")
    return tuple(made)


def _sources(content: bytes) -> list[str]:
    """IPTC's terms that a file has, of those that leave a camera out."""
    found, at = [], content.find(_SOURCE)
    while at >= 0:
        start = at + len(_SOURCE)
        term = re.match(rb"\w+", content[start : start + 64])
        name = term[0].decode("ascii", "replace") if term else ""
        found += [name] if name in _NO_CAMERA else []
        at = content.find(_SOURCE, start)
    return found
