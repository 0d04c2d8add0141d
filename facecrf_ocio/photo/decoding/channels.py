"""Which channels of an image are its color and which is alpha."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.photo.raster.pixels import Float32

_OF_SCANS = ["I", "I2", "I3"]
_DISTANCES = ("Z", "ZBACK", "DEPTH")  # from the camera, as renderers store them


def color_channels(path: Path, spec: Any) -> list[int]:
    """Indices of R, G, B by name, those without a layer's prefix first; or of one gray channel.

    Film scans need not say what their channels are: OpenImageIO calls them I, I2 and I3 then.

    Raises
    ------
    PhotoError
        If there are none, which names the channels that there are.
    """
    names = _names(spec)
    by_name = rgb_channels(spec)
    if by_name is not None:
        return by_name
    if names == _OF_SCANS:
        return [0, 1, 2]
    color = [index for index in range(spec.nchannels) if index != alpha_channel(spec)]
    if len(color) == 1 and names[color[0]].rpartition(".")[2] not in _DISTANCES:
        return color
    raise PhotoError(
        path,
        f"has the channels {plain_text(', '.join(spec.channelnames))}, but no R, G and B",
        "save its color channels as R, G, B",
    )


def rgb_channels(spec: Any) -> list[int] | None:
    """Indices of R, G, B by name, those without a layer's prefix first; None where there are none.

    None of a deep image either, whose pixels are lists.
    """
    names = [] if spec.deep else _names(spec)
    for layer in dict.fromkeys(["", *(name[: name.rfind(".") + 1] for name in names)]):
        if all(layer + channel in names for channel in "RGB"):
            return [names.index(layer + channel) for channel in "RGB"]
    return None


def _names(spec: Any) -> list[str]:
    return [name.upper() for name in spec.channelnames]


def shown(alpha: Float32 | None) -> tuple[Float32 | None, tuple[str, ...]]:
    """Alpha (H, W) that shows anything; none, and a note, where it would leave nothing but black.

    Programs that know no alpha leave zeros in its place, in BMP above all.
    """
    if alpha is None or alpha.any():
        return alpha, ()
    return None, ("its alpha is 0 everywhere, and was set aside",)


def alpha_channel(spec: Any) -> int | None:
    """Index of alpha; by name, because the GIF reader's `alpha_channel` is one too high."""
    return spec.channelnames.index("A") if "A" in spec.channelnames else None


def is_premultiplied(spec: Any, file_format: str) -> bool:
    """Whether colors are stored multiplied by alpha, which reading unassociated cannot undo."""
    told = spec.get_int_attribute("oiio:UnassociatedAlpha")
    return file_format == "openexr" or (file_format == "tiff" and not told)
