"""The linear images to test with."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.photo.containers.suffixes import RAW_SUFFIXES, suffixes_named
from facecrf_ocio.photo.decoding.picture import open_image
from facecrf_ocio.photo.read import read_photo
from facecrf_ocio.values import Photo

_SUFFIXES = suffixes_named("OpenEXR", "Radiance HDR", "PNG", "TIFF") | RAW_SUFFIXES
_MIN_BITS = 10  # of linear light, whose darkest stops have a code or two each in 8


@dataclass(frozen=True, slots=True)
class LinearImage:
    """One image file whose values are proportional to light.

    Attributes
    ----------
    name
        Path below the folder that was searched.
    path, sha256
        The file and the digest of its bytes.
    """

    name: str
    path: Path
    sha256: str

    def read(self) -> Photo:
        """Read it; `encoded` holds linear light whatever the file says of itself."""
        return read_photo(self.path)


@dataclass(frozen=True, slots=True)
class FoundImages:
    """Linear images of a folder, and in one line each why others were left out."""

    images: tuple[LinearImage, ...]
    left_out: tuple[str, ...]


def find_linear_images(folder: Path, pattern: str = "*") -> FoundImages:
    """Find the linear images of a folder, or below it if it holds none itself.

    Files of 8 bits, too coarse for linear light, and EXR files without channels R, G, B are left
    out. Every other image is taken as linear: a bench has no way to tell.

    Parameters
    ----------
    folder
        Folder, or a single image.
    pattern
        Names to take, such as `dev_*_noisy.exr`.

    Raises
    ------
    PhotoError
        If there are none, or one of them cannot be read.
    """
    if folder.is_file():
        root, paths = folder.parent, [folder]
    else:
        root = folder
        paths = _images(folder.glob(pattern)) or _images(folder.rglob(pattern))
    images, left_out = [], []
    for path in paths:
        problem = _unfit(path)
        if problem:
            left_out.append(f"{path}: {problem}")
        else:
            digest = read_photo(path).sha256 or ""
            images.append(LinearImage(path.relative_to(root).as_posix(), path, digest))
    if not images:
        found = f"{len(left_out)} images, none of them linear" if left_out else "no images"
        raise PhotoError(
            folder,
            f"holds {found}",
            "name a folder of EXR, 16-bit TIFF or PNG, or camera raw files",
        )
    return FoundImages(tuple(images), tuple(left_out))


def _images(paths: Iterable[Path]) -> list[Path]:
    return sorted(p for p in paths if p.suffix.lower() in _SUFFIXES and p.is_file())


def _unfit(path: Path) -> str:
    """Why a file is not taken, empty if it is; a file that no reader opens is `read_photo`'s."""
    if path.suffix.lower() in RAW_SUFFIXES:
        return ""
    source, _ = open_image(path)
    if source is None:
        return ""
    try:
        spec = source.spec()
        if spec.format.size() == 1 or 0 < spec.get_int_attribute("oiio:BitsPerSample") < _MIN_BITS:
            return "8 bits are too coarse for linear light"
        if path.suffix.lower() == ".exr" and not {"R", "G", "B"} <= set(spec.channelnames):
            return "has no channels R, G, B"
        return ""
    finally:
        source.close()
