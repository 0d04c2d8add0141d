"""Camera raw to linear light, by LibRaw."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import numpy.typing as npt
import rawpy

from facecrf_ocio.errors import PhotoError
from facecrf_ocio.files.plain_text import plain_text
from facecrf_ocio.photo.integrity import COPY_AGAIN, check_size

_NAMES = """
    3fr ari arw bay cr2 cr3 crw dcr dng erf fff gpr iiq k25 kdc mdc mef mos mrw nef nrw orf pef raf
    raw rw2 rwl sr2 srf srw x3f
"""
RAW_SUFFIXES = frozenset(f".{name}" for name in _NAMES.split())


def is_raw(path: Path) -> bool:
    """Whether LibRaw takes the file for camera raw; reads the header only."""
    try:
        with rawpy.imread(str(path)):
            return True
    except rawpy.LibRawError:
        return False


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
        If the file is camera raw, but damaged, or larger than `integrity.MAX_MEGAPIXELS`.
    """
    try:
        with _without_remarks(), rawpy.imread(str(path)) as raw:
            check_size(path, raw.sizes.raw_width, raw.sizes.raw_height)
            linear = raw.postprocess(
                gamma=(1, 1),
                no_auto_bright=True,
                output_bps=16,
                use_camera_wb=True,
                output_color=rawpy.ColorSpace.sRGB,
            )
    except rawpy.LibRawFileUnsupportedError:
        return None
    except rawpy.LibRawError as error:
        # LibRaw gives up on a few bytes of anything before it asks whether they are camera raw.
        if path.suffix.lower() not in RAW_SUFFIXES and not is_raw(path):
            return None
        problem = f"is damaged or cut short camera raw ({plain_text(error)})"
        raise PhotoError(path, problem, COPY_AGAIN) from error
    return np.asarray(linear, np.uint16)


@contextmanager
def _without_remarks() -> Iterator[None]:
    """Keep LibRaw from printing to stderr.

    It does so about damaged files, besides returning an error, and rawpy cannot ask it not to.
    """
    try:
        kept = os.dup(2)
    except OSError:  # no stderr: nothing to keep quiet
        yield
        return
    try:
        with open(os.devnull, "wb") as nowhere:  # noqa: PTH123
            os.dup2(nowhere.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
