"""Camera raw to linear light, by LibRaw."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import rawpy

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.files.threads import WhileAny
from facecrf_ocio.photo.containers.integrity import COPY_AGAIN, check_size
from facecrf_ocio.photo.containers.suffixes import RAW_SUFFIXES
from facecrf_ocio.photo.decoding.orientation import upright
from facecrf_ocio.photo.raster.pixels import Pixels

# LibRaw's `flip` as EXIF's orientation: which way it is to be turned.
_ORIENTATIONS = {3: 3, 5: 8, 6: 6}


def libraw_takes(path: Path) -> bool:
    """Whether LibRaw takes the file for camera raw; reads the header only."""
    try:
        with rawpy.imread(str(path)):
            return True
    except rawpy.LibRawError:
        return False


def picture_in_raw(path: Path) -> bytes | None:
    """The JPEG that a camera stored in a raw file, as LibRaw finds the largest; None without one.

    Raises
    ------
    PhotoError
        If LibRaw does not take the file for camera raw, or finds it damaged.
    """
    try:
        with _without_remarks(), rawpy.imread(str(path)) as raw:
            stored = raw.extract_thumb()
    except (rawpy.LibRawNoThumbnailError, rawpy.LibRawUnsupportedThumbnailError):
        return None
    except rawpy.LibRawFileUnsupportedError as error:
        problem = "is not camera raw that LibRaw knows, in which a camera's picture could be"
        raise PhotoError(path, problem, "give the camera's JPEG as well") from error
    except rawpy.LibRawError as error:
        raise PhotoError(path, _damaged(error), COPY_AGAIN) from error
    return bytes(stored.data) if stored.format is rawpy.ThumbFormat.JPEG else None


def decode_raw(path: Path) -> npt.NDArray[np.uint16] | None:
    """Demosaic a camera raw file without any tone curve.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    numpy.ndarray or None
        (H, W, 3) upright, proportional to light, camera white balance, Rec.709 primaries. The
        scale is the photo's own: LibRaw puts the brightest pixel at 65535 where it is near the
        sensor's saturation. None where LibRaw does not take the file for camera raw.

    Raises
    ------
    PhotoError
        If the file is camera raw, but damaged, larger than `integrity.MAX_MEGAPIXELS`, or decoded
        to zeros alone.
    """
    try:
        with _without_remarks(), rawpy.imread(str(path)) as raw:
            sizes = raw.sizes  # before LibRaw is told not to turn the picture
            check_size(path, sizes.raw_width, sizes.raw_height)
            linear = raw.postprocess(
                gamma=(1, 1),
                no_auto_bright=True,
                output_bps=16,
                use_camera_wb=True,
                output_color=rawpy.ColorSpace.sRGB,
                user_flip=0,
            )
            linear = upright(_cropped(linear, sizes), _ORIENTATIONS.get(sizes.flip, 1))
    except rawpy.LibRawFileUnsupportedError:
        return None
    except rawpy.LibRawError as error:
        # LibRaw gives up on a few bytes of anything before it asks whether they are camera raw.
        if path.suffix.lower() not in RAW_SUFFIXES and not libraw_takes(path):
            return None
        raise PhotoError(path, _damaged(error), COPY_AGAIN) from error
    if not linear.any():
        problem = "is camera raw of which LibRaw decodes zeros alone, such as a DNG of floats"
        raise PhotoError(path, problem, "export a 16-bit TIFF from its raw converter")
    return np.asarray(linear, np.uint16)


def _damaged(error: rawpy.LibRawError) -> str:
    return f"is damaged or cut short camera raw ({plain_text(error)})"


def _cropped(linear: Pixels, sizes: Any) -> Pixels:
    """What the file says is the picture; LibRaw gives all that its sensor saw of it."""
    if min(sizes.crop_width, sizes.crop_height) == 0 or linear.shape[:2] != (
        sizes.iheight,
        sizes.iwidth,
    ):
        return linear
    left, top = sizes.crop_left_margin - sizes.left_margin, sizes.crop_top_margin - sizes.top_margin
    crop = linear[max(top, 0) : top + sizes.crop_height, max(left, 0) : left + sizes.crop_width]
    return crop if crop.shape[:2] == (sizes.crop_height, sizes.crop_width) else linear


def _turn_stderr_away() -> Callable[[], object]:
    try:
        kept = os.dup(2)
    except OSError:  # no stderr: nothing to keep quiet
        return int
    with open(os.devnull, "wb") as nowhere:  # noqa: PTH123
        os.dup2(nowhere.fileno(), 2)

    def turn_back() -> None:
        os.dup2(kept, 2)
        os.close(kept)

    return turn_back


# LibRaw prints to stderr about damaged files, besides returning an error, and rawpy cannot ask it
# not to.
_without_remarks = WhileAny(_turn_stderr_away)
