"""What a color space of a config says of the photo it is for."""

from __future__ import annotations

from facecrf_ocio.ocio_config.find import PhotoLut
from facecrf_ocio.record.provenance import EXPOSURE, record_of
from facecrf_ocio.values import Primaries
from facecrf_ocio.wording.sentence import expected


def describe(lut: PhotoLut, primaries: Primaries | None) -> str:
    """Source, estimator, verdict, what to expect and assumptions, as far as they are known.

    Parameters
    ----------
    lut
        The photo's LUT; the record beside it tells most.
    primaries
        Those that all photos are taken for, if any were given.
    """
    record = record_of(lut.path)
    lines = [f"Source: {lut.photo or lut.stem}, through {lut.path.name}."]
    if record is not None:
        estimate = record.estimate
        confidence = estimate.confidence
        verdict = "" if confidence is None else f", {confidence.verdict}"
        lines.append(f"Curve: {estimate.outcome} by {estimate.estimator}{verdict}.")
        said = expected(estimate)
        if said:
            lines.append(f"{said[0].upper()}{said[1:]}.")
    lines.append(f"Primaries: {_primaries(lut, primaries)}. Exposure: {EXPOSURE}.")
    return "\n".join(lines)


def _primaries(lut: PhotoLut, given: Primaries | None) -> str:
    if lut.space:
        return f"the LUT leads to {lut.space}"
    if lut.leads_to is not None:
        return f"the LUT leads to {lut.leads_to.name}, by {lut.leads_to.source}"
    if given is not None:
        return f"{given.name}, as asked for"
    if lut.primaries is not None:
        return f"{lut.primaries.name} by {lut.primaries.source}"
    return "not told, taken for Rec.709"
