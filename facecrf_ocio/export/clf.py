"""Common LUT Format, version 3 (.clf), of the Academy and the ASC."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from uuid import UUID, uuid5

from facecrf_ocio.export.comments import one_line
from facecrf_ocio.export.table import LUT_LENGTH, table_rows
from facecrf_ocio.values import InverseCRF

_NAMESPACE = UUID("6f0b3c5e-54a7-5d0e-9a57-3c1d0c8e4b21")


def clf_text(curve: InverseCRF, comments: Sequence[str] = ()) -> str:
    """Return the file's text, to be encoded as UTF-8.

    The required identifier is derived from the table and the comments, so that equal files are
    equal byte for byte.
    """
    rows = table_rows(curve)
    descriptions = "".join(
        f"    <Description>{escape(one_line(line), quote=False)}</Description>\n"
        for line in ("Inverse camera response of one photo", *comments)
    )
    identifier = uuid5(_NAMESPACE, rows + descriptions).urn
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<ProcessList compCLFversion="3" id="{identifier}" name="inverse camera response">\n'
        f"{descriptions}"
        "    <InputDescriptor>RGB as encoded by the camera</InputDescriptor>\n"
        "    <OutputDescriptor>linear RGB, relative exposure</OutputDescriptor>\n"
        '    <LUT1D inBitDepth="32f" outBitDepth="32f" interpolation="linear">\n'
        f'        <Array dim="{LUT_LENGTH} 3">\n'
        f"{rows}"
        "        </Array>\n"
        "    </LUT1D>\n"
        "</ProcessList>\n"
    )
