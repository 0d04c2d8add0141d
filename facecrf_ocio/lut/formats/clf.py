"""XML process lists: Common LUT Format, version 3 (.clf), and Autodesk's Color Transform Format.

A CLF is read by all that follow the Academy's S-2014-006. A CTF (.ctf) is OpenColorIO's and
Autodesk's; it has an inverse LUT, with which encoding is the exact inverse of linearizing.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from uuid import UUID, uuid5

import numpy as np

from facecrf_ocio.lut.comments import remark
from facecrf_ocio.lut.table import LUT_LENGTH, rows_of, table_rows
from facecrf_ocio.lut.transform import LutTransform, encode_nodes, encode_table
from facecrf_ocio.values import Float, InverseCRF

_NAMESPACE = UUID("6f0b3c5e-54a7-5d0e-9a57-3c1d0c8e4b21")
_DEPTHS = 'inBitDepth="32f" outBitDepth="32f"'
_HALF_ONE = 15360  # bits of 1.0 as a half float
_HALF_INFINITY = 31744  # bits of infinity as a half float


def clf_text(transform: LutTransform, comments: Sequence[str] = ()) -> str:
    """Return the text of a CLF, to be encoded as UTF-8.

    The required identifier is derived from the numbers and the comments, so that equal files are
    equal byte for byte.
    """
    curve = _half_domain(transform.curve) if transform.encodes else _lut1d(transform.curve, "LUT1D")
    return _process_list(transform, curve, comments, 'compCLFversion="3"', "3 3")


def ctf_text(transform: LutTransform, comments: Sequence[str] = ()) -> str:
    """Return the text of a CTF, to be encoded as UTF-8; its identifier is made as a CLF's."""
    curve = _lut1d(transform.curve, "InverseLUT1D" if transform.encodes else "LUT1D")
    return _process_list(transform, curve, comments, 'version="1.3"', "3 3 3")


def _process_list(
    transform: LutTransform, curve: str, comments: Sequence[str], version: str, matrix_size: str
) -> str:
    linear = f"linear RGB, {transform.space or 'relative exposure'}"
    if transform.space:
        linear += ", relative exposure"
    ends = ("RGB as encoded by the camera", linear)
    title, name = "Inverse camera response of one photo", "inverse camera response"
    operations = curve
    if transform.matrix is not None:
        operations += _matrix(transform.matrix, matrix_size)
    if transform.encodes:
        ends = ends[::-1]
        title, name = "Camera response of one photo", "camera response"
        if transform.matrix is not None:
            operations = _matrix(np.linalg.inv(transform.matrix), matrix_size) + curve
    descriptions = "".join(
        f"    <Description>{escape(remark(line), quote=False)}</Description>\n"
        for line in (title, *comments)
    )
    identifier = uuid5(_NAMESPACE, version + operations + descriptions).urn
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<ProcessList {version} id="{identifier}" name="{name}">\n'
        f"{descriptions}"
        f"    <InputDescriptor>{ends[0]}</InputDescriptor>\n"
        f"    <OutputDescriptor>{ends[1]}</OutputDescriptor>\n"
        f"{operations}"
        "</ProcessList>\n"
    )


def _lut1d(curve: InverseCRF, element: str) -> str:
    return (
        f'    <{element} {_DEPTHS} interpolation="linear">\n'
        f'        <Array dim="{LUT_LENGTH} 3">\n'
        f"{table_rows(curve)}"
        "        </Array>\n"
        f"    </{element}>\n"
    )


def _half_domain(curve: InverseCRF) -> str:
    """A table with one entry for each of the 65536 half floats, in the order of their bits."""
    table = np.zeros((65536, 3), np.float32)
    table[: _HALF_ONE + 1] = encode_table(curve, encode_nodes(half_domain=True))
    table[_HALF_ONE : _HALF_INFINITY + 1] = 1.0
    return (
        f'    <LUT1D {_DEPTHS} halfDomain="true" interpolation="linear">\n'
        '        <Array dim="65536 3">\n'
        f"{rows_of(table)}"
        "        </Array>\n"
        "    </LUT1D>\n"
    )


def _matrix(matrix: Float, size: str) -> str:
    rows = "".join(f"{r:.17g} {g:.17g} {b:.17g}\n" for r, g, b in matrix.tolist())
    return (
        f'    <Matrix {_DEPTHS}>\n        <Array dim="{size}">\n{rows}        </Array>\n'
        "    </Matrix>\n"
    )
