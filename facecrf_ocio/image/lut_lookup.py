"""LUT files, as OpenColorIO reads them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.errors import LutError
from facecrf_ocio.image.lookup import Lookup
from facecrf_ocio.lut.ocio_processor import RefusedError, exact_cpu, ocio_processor


def lut_lookup(lut: str | Path) -> Lookup:
    """Return what a LUT file does, forward, to pixels; see `lookup.Lookup`.

    Values outside of its domain are clamped and NaN treated as OpenColorIO does.

    Raises
    ------
    LutError
        If the file is missing, is not a LUT or holds NaN.
    """
    lut = Path(lut)
    processor = lut_processor(lut)
    # One for half floats too: OCIO rounds its result to them.
    cpus = {np.dtype(kind): exact_cpu(processor, depth) for kind, depth in _DEPTHS.items()}

    def transform(values: npt.NDArray[np.float32], out: npt.NDArray[Any]) -> None:
        cpus[out.dtype].apply(
            described(values, ocio.BIT_DEPTH_F32), described(out, _DEPTHS[out.dtype.type])
        )

    return Lookup(transform, separable=not processor.hasChannelCrosstalk(), name=str(lut))


_DEPTHS = {np.float32: ocio.BIT_DEPTH_F32, np.float16: ocio.BIT_DEPTH_F16}


def described(image: npt.NDArray[Any], depth: Any) -> Any:
    """Tell OpenColorIO of (H, W, 3) contiguous pixels, which must outlive what is returned."""
    height, width, _ = image.shape
    size = image.itemsize
    return ocio.PackedImageDesc(
        image,
        width,
        height,
        ocio.CHANNEL_ORDERING_RGB,
        depth,
        size,
        3 * size,
        3 * width * size,
    )


def lut_processor(lut: Path) -> Any:
    """The processor of one LUT file, as it is on the disk now."""
    if not lut.is_file():
        problem = (
            "is a folder; name a LUT file" if lut.is_dir() else "does not exist; check the name"
        )
        raise LutError(f"{lut}: {problem}")
    try:
        processor = ocio_processor(lut)
    except RefusedError as error:
        raise LutError(
            f"{lut}: OpenColorIO cannot read it ({error}); give a LUT file such as .spi1d, .cube "
            "or .clf"
        ) from error
    # OpenColorIO takes a table with NaN for the identity.
    tables = [
        part.getData() for part in processor.createGroupTransform() if hasattr(part, "getData")
    ]
    if not all(np.isfinite(table).all() for table in tables):
        raise LutError(f"{lut}: holds NaN or infinite values; make the LUT again")
    return processor
