"""An ImageBuf through a LUT."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy.typing as npt
import OpenImageIO as oiio  # noqa: N813

from facecrf_ocio.color.primaries import known_primaries
from facecrf_ocio.errors import PhotoError, SettingsError
from facecrf_ocio.image.exr_header import still_holds, tag_color_space, tag_primaries
from facecrf_ocio.image.lookup import Lookup
from facecrf_ocio.image.lut_lookup import LutLookup, lut_lookup
from facecrf_ocio.photo.decoding.channels import alpha_channel, color_channels
from facecrf_ocio.photo.tags.header import icc_profile, primaries_of
from facecrf_ocio.values import Primaries
from facecrf_oiio.store import can_store, store

_LINEAR = (oiio.HALF, oiio.FLOAT)
_GRAY = ("Y", "I", "L", "GRAY", "LUMINANCE")
_AS_THEY_ARE = (oiio.UINT8, oiio.UINT16, oiio.HALF)
# True here, since nothing is turned and parts stay what they are.
_KEPT = {"Orientation", "PixelAspectRatio", "compression", "name"}


def linearize(
    image: oiio.ImageBuf,
    lut: str | Path | Lookup,
    *,
    dtype: Any = oiio.HALF,
    roi: oiio.ROI | None = None,
    unpremult: bool | None = None,
    colorspace: str = "auto",
    out: oiio.ImageBuf | None = None,
) -> oiio.ImageBuf:
    """Send an image's colors through a LUT.

    Parameters
    ----------
    image
        Of any pixel type but deep; not changed.
    lut
        A LUT file, or what `facecrf_ocio.image.lut_lookup.lut_lookup` made of it, where one that
        encodes can be given a direction.
    dtype
        `OpenImageIO.HALF` or `OpenImageIO.FLOAT`. In half, colors are clamped to 65504.
    roi
        Region to compute, in pixels; what lies outside of the image is left out. Colors beyond its
        channels keep their values. The whole image by default.
    unpremult
        Whether colors are multiplied by alpha. By default they are if there is an alpha channel
        and the image does not say `oiio:UnassociatedAlpha`. They are so in the result as well.
    colorspace
        What to tag the result with; `auto` is the linear RGB that the LUT's own records name, else
        that of the source's primaries, or `unknown` where those are not known or the LUT mixes
        channels. That a file is sRGB, which OpenImageIO says of every JPEG, is no knowledge; that
        an image in memory is, whoever made it knows.
    out
        A half or float image to write into instead of making one. It must hold the region and have
        as many channels.

    Returns
    -------
    OpenImageIO.ImageBuf
        The region; `out` if that was given. All channels are there.

    Raises
    ------
    PhotoError
        If the image cannot be read, is deep, or has neither R, G and B nor one gray channel.
    LutError
        If the LUT cannot be read, encodes, or makes NaN or infinities of codes.
    SettingsError
        If the region or `out` does not fit the image.
    """
    name = Path(image.name or "ImageBuf")
    _require_pixels(image, name)
    lookup = lut if isinstance(lut, Lookup) else lut_lookup(lut)
    spec = image.spec()
    region = _region(image, roi)
    color, alpha = color_of(spec, name), alpha_channel(spec)
    if unpremult is None:
        unpremult = not spec.get_int_attribute("oiio:UnassociatedAlpha")
    color_space = _color_space(colorspace, image, lookup)
    if dtype not in _LINEAR:
        raise SettingsError(f"linear light needs half or float, not {dtype}")
    if out is None:
        result = oiio.ImageBuf(_header(spec, region, dtype), zero=False)
    else:
        result = _fitting(out, region, spec.nchannels)
    _tag(result.specmod(), color_space)
    kind = spec.format.basetype if spec.format.basetype in _AS_THEY_ARE else oiio.FLOAT
    wanted = range(region.chbegin, region.chend)
    untouched = [channel for channel in color if roi is not None and channel not in wanted]
    region.chbegin, region.chend = 0, spec.nchannels

    def make(band: oiio.ROI, linear: npt.NDArray[Any]) -> None:
        pixels = image.get_pixels(kind, band)
        lookup.apply(
            pixels.reshape(band.height, band.width, spec.nchannels),
            out=linear,
            color=color,
            alpha=alpha if unpremult else None,
        )
        if untouched:
            before = image.get_pixels(oiio.FLOAT, band).reshape(linear.shape)
            linear[..., untouched] = before[..., untouched]

    try:
        store(result, region, make)
    except MemoryError as error:
        problem = f"cannot be worked on ({error})"
        raise PhotoError(name, problem, "free some memory") from error
    return result


def color_of(spec: oiio.ImageSpec, name: Path) -> list[int]:
    """Indices of R, G and B, or of one gray channel.

    Raises
    ------
    PhotoError
        If there are neither: depth, normals and other channels that are no color.
    """
    channels = color_channels(name, spec)
    only = spec.channelnames[channels[0]]
    if len(channels) == 1 and only.rpartition(".")[2].upper() not in _GRAY:
        problem = f"has no R, G and B and no gray, but the channel {only}"
        raise PhotoError(name, problem, "name color channels R, G, B, or Y")
    return channels


def fill(image: oiio.ImageBuf, pixels: npt.NDArray[Any]) -> None:
    """Set all pixels of an image, (H, W, C), on all cores."""
    spec = image.spec()
    if not can_store(image):
        image.set_pixels(image.roi, pixels)
        return
    shaped = pixels.reshape(spec.depth, spec.height, spec.width, spec.nchannels)

    def make(band: oiio.ROI, out: npt.NDArray[Any]) -> None:
        out[...] = shaped[band.zbegin - spec.z, band.ybegin - spec.y : band.yend - spec.y]

    store(image, image.roi, make)


def _require_pixels(image: oiio.ImageBuf, name: Path) -> None:
    spec = image.spec()
    if not image.initialized or not spec.nchannels or image.has_error:
        problem = image.geterror().strip().partition("\n")[0] or "no pixels"
        raise PhotoError(name, f"is not an image that can be read ({problem})", "check the file")
    if spec.deep:
        raise PhotoError(name, "is a deep image", "flatten it first (oiiotool --flatten)")


def _region(image: oiio.ImageBuf, roi: oiio.ROI | None) -> oiio.ROI:
    if roi is None or not roi.defined:
        return image.roi.copy()
    region = oiio.intersection(roi, image.roi)
    if min(region.width, region.height, region.depth, region.chend - region.chbegin) <= 0:
        raise SettingsError(
            f"the region {_told(roi)} has no pixels in common with the image's, "
            f"{_told(image.roi)}; choose another"
        )
    return region


def _told(roi: oiio.ROI) -> str:
    """As oiiotool writes geometry, WIDTHxHEIGHT+X+Y."""
    return f"{roi.width}x{roi.height}{roi.xbegin:+d}{roi.ybegin:+d}"


def _color_space(colorspace: str, image: oiio.ImageBuf, lookup: Lookup) -> str | Primaries:
    """The name to tag with, or the primaries of a linear space."""
    if colorspace != "auto":
        return colorspace
    spec = image.spec()
    primaries = primaries_of(spec, icc_profile(spec))
    told = spec.get_string_attribute("colorInteropID")
    if not image.file_format_name:
        told += spec.get_string_attribute("oiio:ColorSpace")
    if primaries is None and "rec709" in told.lower():
        primaries = known_primaries("Rec.709", "file attribute")
    if isinstance(lookup, LutLookup):
        return lookup.leads_to(primaries) or "unknown"
    return primaries or "unknown" if lookup.separable else "unknown"


def _header(source: oiio.ImageSpec, region: oiio.ROI, dtype: Any) -> oiio.ImageSpec:
    header = oiio.ImageSpec(source)
    header.set_format(oiio.TypeDesc(dtype))
    header.x, header.y, header.z = region.xbegin, region.ybegin, region.zbegin
    header.width, header.height, header.depth = region.width, region.height, region.depth
    for item in source.extra_attribs:
        kept = still_holds(item.name) or item.name in _KEPT
        if not kept and item.name != "oiio:UnassociatedAlpha":
            header.erase_attribute(item.name)
    return header


def _tag(spec: oiio.ImageSpec, color_space: str | Primaries) -> None:
    spec.erase_attribute("chromaticities")
    if isinstance(color_space, str):
        tag_color_space(spec, color_space)
    else:
        tag_primaries(spec, color_space)


def _fitting(out: oiio.ImageBuf, region: oiio.ROI, channels: int) -> oiio.ImageBuf:
    spec, inside = out.spec(), out.roi.copy()
    fits = spec.format.basetype in _LINEAR and spec.nchannels == channels
    wanted = region.copy()
    wanted.chbegin, wanted.chend = 0, channels
    if not fits or oiio.intersection(inside, wanted) != wanted:
        raise SettingsError(
            f"`out` is {spec.format} {_told(inside)} of {spec.nchannels} channels, and must be "
            f"half or float, of {channels} channels, and hold {_told(region)}"
        )
    return out
