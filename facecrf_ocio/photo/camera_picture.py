"""The picture that a camera stored in its raw file: what its response made of the same exposure."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.containers.integrity import check_file, photo_sha256
from facecrf_ocio.photo.decoding.picture import MENDED, open_image
from facecrf_ocio.photo.decoding.raw import picture_in_raw
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.photo.tags.header import camera_of
from facecrf_ocio.values import Camera, Photo

_AS_WELL = "give the camera's JPEG of the same exposure as well"
# Converters put a picture of their own into the DNG that they write.
_CONVERTERS = re.compile(r"adobe|dng converter|lightroom|camera raw|dxo|capture one", re.IGNORECASE)
# LibRaw signs EXIF that it makes up for a picture without any.
_LIBRAW = "dcraw"


def camera_picture(path: str | Path) -> Photo:
    """Read the picture that lies in a camera's raw file beside the sensor's values.

    Cameras store one for their own display, most of them a JPEG as large as the photo or half as
    wide, by the response of all their JPEGs.

    Parameters
    ----------
    path
        The raw file.

    Returns
    -------
    Photo
        As `read_photo` gives it, with the path and the hash of the raw file.

    Raises
    ------
    PhotoError
        If the file is no camera raw, is damaged, holds no picture, or one that a converter made.
    """
    path = Path(path)
    with _copied(path) as copy:
        try:
            photo = read_photo(copy)
        except PhotoError as error:
            problem = f"holds a picture by the camera that {error.problem}"
            raise PhotoError(path, problem, _AS_WELL) from error
    return replace(photo, camera=_signed(photo.camera), path=path, sha256=photo_sha256(path))


def camera_in_raw(path: str | Path) -> Camera:
    """Read the name of the camera as its picture in a raw file tells it, without decoding that.

    Raises
    ------
    PhotoError
        As `camera_picture` does, but for a picture of which only pixels are damaged.
    """
    path = Path(path)
    with _copied(path) as copy:
        header, _ = open_image(copy)
        if header is None:
            raise PhotoError(path, "holds a picture by the camera that cannot be read", _AS_WELL)
        return _signed(camera_of(header.spec()))


@contextmanager
def _copied(path: Path) -> Iterator[Path]:
    """The picture in a raw file, copied to a file of its own for as long as it is read."""
    check_file(path)
    header, _ = open_image(path)
    software = "" if header is None else camera_of(header.spec()).software
    if _CONVERTERS.search(software):
        problem = f"holds no picture by the camera, but one by {software[:60]}"
        raise PhotoError(path, problem, _AS_WELL)
    stored = picture_in_raw(path)
    if stored is None:
        raise PhotoError(path, "holds no JPEG by the camera", _AS_WELL)
    with TemporaryDirectory(prefix="facecrf-") as folder:
        copy = Path(folder) / MENDED
        copy.write_bytes(stored)
        yield copy


def _signed(camera: Camera) -> Camera:
    """A camera as the picture tells it, without what LibRaw signs."""
    return replace(camera, software="") if camera.software.startswith(_LIBRAW) else camera
