"""LUT files, as OpenColorIO reads them, run toward light unless told otherwise."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.color.primaries import CIE_XYZ
from facecrf_ocio.errors import IS_FOLDER, LutError, SettingsError
from facecrf_ocio.image.lookup import Lookup
from facecrf_ocio.lut.format_table import of_suffix
from facecrf_ocio.lut.lint import errors_in
from facecrf_ocio.lut.lint.text_tables import decimal_comma
from facecrf_ocio.lut.numbers import is_of_numbers
from facecrf_ocio.lut.ocio_processor import RefusedError, exact_cpu, ocio_processor
from facecrf_ocio.lut.records import LutRecords, lut_records, space_by_matrix
from facecrf_ocio.lut.transform import DIRECTIONS
from facecrf_ocio.lut.usable import why_unusable
from facecrf_ocio.record.lut_names import told_of
from facecrf_ocio.values import Primaries

_PROFILES = (".icc", ".icm", ".pf")  # that OpenColorIO runs from CIE XYZ to the device
_LINEARIZE, _ENCODE = DIRECTIONS


class LutLookup(Lookup):
    """A LUT file to send pixels through, and what comes of their color space.

    Attributes
    ----------
    encodes
        By what the file itself goes from light to code values; empty where it does not.
    """

    def __init__(
        self, lut: Path, processor: Any, *, to_light: bool, after: Primaries | None, encodes: str
    ):
        # One for half floats too: OCIO rounds its result to them.
        cpus = {np.dtype(kind): exact_cpu(processor, depth) for kind, depth in _DEPTHS.items()}

        def transform(values: npt.NDArray[np.float32], out: npt.NDArray[Any]) -> None:
            cpus[out.dtype].apply(
                described(values, ocio.BIT_DEPTH_F32), described(out, _DEPTHS[out.dtype.type])
            )

        super().__init__(transform, separable=not processor.hasChannelCrosstalk(), name=str(lut))
        self.encodes = encodes
        self._to_light = to_light
        self._after = after

    def leads_to(self, source: Primaries | None) -> Primaries | None:
        """Return the linear RGB that the result is in; None if that is unknown or not linear.

        It is what the LUT's own records say. A LUT without any that keeps the channels apart
        keeps the source's primaries; one that mixes them leads anywhere.
        """
        if not self._to_light:
            return None
        return self._after or (source if self.separable else None)


def lut_lookup(lut: str | Path, direction: str | None = None) -> LutLookup:
    """Return what a LUT file does to pixels; see `lookup.Lookup`.

    Values outside of its domain are clamped and NaN treated as OpenColorIO does. Where a LUT is
    inverted, the inverse is exact; oiiotool takes OpenColorIO's fast one, a table of the inverse,
    which differs where the curve is steep, by 1.2 % of white on one of the LUTs it was tried on.

    Parameters
    ----------
    lut
        The file.
    direction
        `linearize`: toward light, for which a LUT that encodes is inverted. `encode`: the other
        way. None is `linearize`, and refuses a LUT that encodes. ICC profiles are read from the
        device to CIE XYZ.

    Raises
    ------
    LutError
        If the file is missing, OpenColorIO cannot use it, it holds NaN, encodes though no
        direction is given, or has no inverse and needs one.
    SettingsError
        If the direction is none of these.
    """
    lut = Path(lut)
    if direction not in (None, *DIRECTIONS):
        raise SettingsError(f"no direction {direction!r}; known: {', '.join(DIRECTIONS)}")
    processor = lut_processor(lut)
    if lut.suffix.lower() in _PROFILES:
        records = LutRecords("the way of profiles", before=CIE_XYZ)
        direction = direction or _LINEARIZE
    else:
        records = lut_records(processor, encodes="its name" if _named_to_encode(lut) else "")
    if records.encodes and direction is None:
        raise LutError(
            f'{lut}: encodes, by {records.encodes}; pass direction="{_LINEARIZE}" to run '
            f'it backward, toward light, or direction="{_ENCODE}" to run it as it is'
        )
    to_light = direction != _ENCODE
    if bool(records.encodes) == to_light:
        processor = _inverse(lut)
    after = records.before if records.encodes else records.after
    after = after or space_by_matrix(processor)
    return LutLookup(lut, processor, to_light=to_light, after=after, encodes=records.encodes)


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
    """The processor of one LUT file, forward, as it is on the disk now.

    Raises
    ------
    LutError
        If the file is missing, OpenColorIO cannot use it, or it holds NaN.
    """
    if not lut.is_file():
        problem = (
            "is no file; name a LUT file" if lut.exists() else "does not exist; check the name"
        )
        raise LutError(f"{lut}: {IS_FOLDER + '; name a LUT file' if lut.is_dir() else problem}")
    try:
        refused = why_unusable(lut)
        if refused:
            raise RefusedError(refused)
        row = of_suffix(lut.suffix)
        comma = decimal_comma(lut.read_bytes()) if row and row.spaced else 0
        if comma:
            problem = f"a number in line {comma} has a decimal comma; write decimal points"
            raise LutError(f"{lut}: {problem}")
        processor = ocio_processor(lut)
    except OSError as error:
        raise LutError(f"{lut}: cannot be read ({error.strerror}); check the file") from error
    except RefusedError as error:
        for found in errors_in(lut)[:1]:
            if not found.unusable:  # in fewer words than OpenColorIO's, and with what to do
                line = "" if found.line is None else f"line {found.line}: "
                raise LutError(f"{lut}: {line}{found.problem}; {found.remedy}") from error
        raise LutError(
            f"{lut}: OpenColorIO cannot read it ({error}); give a LUT file such as .spi1d, .cube "
            "or .clf"
        ) from error
    # OpenColorIO takes a table with NaN for the identity.
    if not is_of_numbers(processor):
        raise LutError(f"{lut}: holds NaN or infinite values; make the LUT again")
    return processor


def _named_to_encode(lut: Path) -> bool:
    try:
        return told_of(lut, {}).encodes
    except LutError:  # of a record that is none
        return False


def _inverse(lut: Path) -> Any:
    try:
        return ocio_processor(lut, inverse=True)
    except RefusedError as error:
        raise LutError(f"{lut}: cannot be run backward ({error}); name a LUT that can") from error
