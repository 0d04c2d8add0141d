"""What a photo's file says of itself makes no EXR that cannot be written, or read."""

from __future__ import annotations

import io
import struct

import numpy as np
import OpenEXR
import OpenImageIO as oiio  # noqa: N813
import pytest
from odd_files import CODES
from photo_files import write
from PIL import Image, PngImagePlugin

from facecrf_ocio import linearize_photo

# OpenEXR technical introduction: what a header holds by these names is of a type of its own.
RESERVED = (
    *("channels", "chunkCount", "compression", "dataWindow", "displayWindow", "envmap"),
    *("lineOrder", "name", "pixelAspectRatio", "preview", "screenWindowCenter"),
    *("screenWindowWidth", "tiles", "type", "version", "view", "wrapmodes"),
)


def linearized(path):
    """The spec of the EXR of a photo, as OpenImageIO reads it; OpenEXR's own reader took it too."""
    exr = path.with_suffix(".exr")
    linearize_photo(path, exr, estimator="srgb", overwrite=True)
    assert OpenEXR.File(str(exr)).channels()
    source = oiio.ImageInput.open(str(exr))
    assert source is not None, oiio.geterror()
    spec = source.spec()
    source.close()
    return spec


@pytest.mark.parametrize("name", RESERVED)
def test_a_text_by_a_name_of_openexr_s_own_is_left_aside(tmp_path, name):
    texts = PngImagePlugin.PngInfo()
    texts.add_text(name, "1.0")
    texts.add_text("Software", "a painter")
    Image.fromarray(CODES).save(tmp_path / "a.png", pnginfo=texts)
    spec = linearized(tmp_path / "a.png")
    assert (spec.width, spec.height) == CODES.shape[1::-1]
    assert spec["Software"] == "a painter"


def jpeg_with_aspect(across, down, orientation):
    exif = Image.Exif()
    exif[0x112] = orientation
    out = io.BytesIO()
    Image.fromarray(CODES).save(out, "JPEG", exif=exif)
    content = bytearray(out.getvalue())
    place = content.index(b"JFIF\0")
    content[place + 7 : place + 12] = struct.pack(">BHH", 0, across, down)
    return bytes(content)


@pytest.mark.parametrize(
    ("orientation", "aspect"), [(1, 2.0), (3, 2.0), (4, 2.0), (5, 0.5), (6, 0.5), (8, 0.5)]
)
def test_pixels_that_are_not_square_are_so_in_the_picture_turned_upright(
    tmp_path, orientation, aspect
):
    path = tmp_path / "a.jpg"
    path.write_bytes(jpeg_with_aspect(2, 1, orientation))
    assert linearized(path).get_float_attribute("PixelAspectRatio") == aspect


def test_resolutions_are_turned_with_them(tmp_path):
    """A fax has 204 by 98 pixels an inch."""
    for orientation, expected in ((1, (204.0, 98.0)), (6, (98.0, 204.0))):
        path = tmp_path / f"{orientation}.tif"
        said = {282: 204.0, 283: 98.0, 296: 2, 274: orientation}
        Image.fromarray(CODES).save(path, tiffinfo=said)
        spec = linearized(path)
        told = [spec.get_float_attribute(f"{axis}Resolution") for axis in "XY"]
        assert told == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("resolutions", [(1e-9, 1e9), (1e9, 1e-9)])
def test_resolutions_that_openexr_refuses_are_left_aside(tmp_path, resolutions):
    path = tmp_path / "a.tif"
    said = {282: resolutions[0], 283: resolutions[1], 296: 2}
    Image.fromarray(CODES).save(path, tiffinfo=said)
    assert linearized(path).get_float_attribute("PixelAspectRatio", 1.0) == 1.0


def test_what_an_exr_says_of_its_parts_does_not_pass_to_another(tmp_path):
    light = np.full((8, 9, 3), 0.25, np.float32)
    path = write(
        tmp_path / "a.exr", light, oiio.FLOAT, preview="?", chunkCount=77, envmap="latlong"
    )
    photo = tmp_path / "b.exr"
    linearize_photo(path, photo, estimator="srgb")
    assert OpenEXR.File(str(photo)).header().get("chunkCount", 1) != 77
