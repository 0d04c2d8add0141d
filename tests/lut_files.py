"""LUT files as others make them, and reading them through OpenColorIO alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import PyOpenColorIO as ocio  # noqa: N813

LOG_TO_INFINITY = (
    '<Log inBitDepth="32f" outBitDepth="32f" style="cameraLogToLin">'
    '<LogParams base="10" logSideSlope="0.25" logSideOffset="0.385" linSideSlope="5.5" '
    'linSideOffset="0.052" linSideBreak="0.01"/></Log>'
)
MIXES = (0.7, 0.2, 0.1, 0.1, 1.0, -0.1, 0.0, -0.1, 1.1)
REC709_TO_AP1 = (
    *(0.6130974, 0.3395231, 0.0473795),
    *(0.0701937, 0.9163539, 0.0134524),
    *(0.0206156, 0.1095698, 0.8698147),
)
CURVE = '<LUT1D inBitDepth="32f" outBitDepth="32f"><Array dim="3 1">0 0.21 1</Array></LUT1D>'


def matrix(numbers: tuple[float, ...]) -> str:
    values = " ".join(map(str, numbers))
    return f'<Matrix inBitDepth="32f" outBitDepth="32f"><Array dim="3 3">{values}</Array></Matrix>'


def write_clf(path: Path, *operations: str, before: str = "", after: str = "") -> Path:
    told = f"<InputDescriptor>{before}</InputDescriptor>" if before else ""
    told += f"<OutputDescriptor>{after}</OutputDescriptor>" if after else ""
    text = f'<ProcessList compCLFversion="3" id="a">{told}{"".join(operations)}</ProcessList>'
    path.write_text(text)
    return path


def write_half_domain(path: Path, values: npt.ArrayLike) -> Path:
    """A CLF with an entry for each of the 65536 half floats, in the order of their bits."""
    rows = "\n".join(f"{value:.9g}" for value in np.asarray(values, np.float64))
    operation = (
        '<LUT1D inBitDepth="32f" outBitDepth="32f" halfDomain="true">'
        f'<Array dim="65536 1">{rows}</Array></LUT1D>'
    )
    return write_clf(path, operation)


def half_floats() -> npt.NDArray[np.float64]:
    """All 65536, infinities and NaN among them."""
    with np.errstate(invalid="ignore"):
        return np.arange(65536, dtype=np.uint16).view(np.float16).astype(np.float64)


def through_ocio(
    path: Path, pixels: npt.ArrayLike, *, inverse: bool = False
) -> npt.NDArray[np.float32]:
    """What OpenColorIO makes of (..., 3)."""
    way = ocio.TRANSFORM_DIR_INVERSE if inverse else ocio.TRANSFORM_DIR_FORWARD
    ocio.ClearAllCaches()
    transform = ocio.FileTransform(str(path), interpolation=ocio.INTERP_BEST)
    processor = ocio.Config.CreateRaw().getProcessor(ocio.Context(), transform, way)
    result = np.array(pixels, np.float32, order="C")
    processor.getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS).applyRGB(result)
    return result
