"""What a LUT says of itself: whether it encodes, and which linear RGB it leads to.

Evidence are the descriptors that CLF and CTF carry, a matrix at its end that leads to a
known space, and, of a curve without any of these, its shape. No profile is asked: an ICC profile's
way toward light is its inverse, see `LutFormat.profile`, and that leads to CIE XYZ.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import PyOpenColorIO as ocio  # noqa: N813

from facecrf_ocio.color.adaptation import bradford, rgb_to_xyz
from facecrf_ocio.color.primaries import CIE_XYZ, D65, KNOWN_PRIMARIES
from facecrf_ocio.lut.ocio_processor import exact_cpu
from facecrf_ocio.values import Float, Primaries

BY_DESCRIPTION, BY_MATRIX = "the LUT's description", "the LUT's matrix"

_ENCODED = re.compile(
    r"encoded|gamma|\blog|oetf|video|display|\bpq\b|2084|1886|\bacescct?\b|\bhlg\b|\bsrgb$", re.I
)
_LINEAR = re.compile(r"\blin(ear)?(\b|_)|aces2065|acescg\b|\bap[01]\b|\bxyz\b|exposure", re.I)
_SPACES = (
    (re.compile(r"aces2065-?1|\bap0\b", re.I), "AP0"),
    (re.compile(r"acescg\b|\bap1\b", re.I), "AP1"),
    (re.compile(r"\bxyz\b.*\bd65\b", re.I), CIE_XYZ.name),
    (re.compile(r"rec\.?\s?709", re.I), "Rec.709"),
    (re.compile(r"rec\.?\s?2020", re.I), "Rec.2020"),
    (re.compile(r"\bp3\b|p3-?d65", re.I), "Display P3"),
    (re.compile(r"adobe\s?rgb", re.I), "Adobe RGB"),
)
# Published matrices have four digits at least; no two pairs of spaces come as near.
_SAME_MATRIX = 5e-4
# A power of 1/1.6 lies 0.18 above the diagonal, sRGB's curve 0.29; a look that brightens, 0.1.
_BULGE, _DIP = 0.17, 0.01
_SHADES = 257  # grays from black to white


@dataclass(frozen=True, slots=True)
class LutRecords:
    """What a LUT says of itself, run forward.

    Attributes
    ----------
    encodes
        By what it is known to encode, such as `its name`; empty if it is not.
    before, after
        The linear RGB that its description says it starts from and leads to; None where it does
        not say, or is not linear.
    """

    encodes: str = ""
    before: Primaries | None = None
    after: Primaries | None = None


def lut_records(processor: Any, *, encodes: str = "") -> LutRecords:
    """Read what a LUT's processor tells.

    Parameters
    ----------
    processor
        OpenColorIO's, forward.
    encodes
        By what it is known to encode already, such as `its name`.
    """
    metadata = processor.getFormatMetadata()
    texts = {child.getElementName(): child.getElementValue() for child in _children(metadata)}
    begin, end = (texts.get(f"{place}Descriptor", "") for place in ("Input", "Output"))
    told = bool(begin or end)
    if encodes:
        pass
    elif _LINEAR.search(begin) and _ENCODED.search(end) and not _LINEAR.search(end):
        encodes = "its description"
    elif not (told and _LINEAR.search(end)) and _bulges(processor):
        encodes = "the shape of its curve"
    return LutRecords(encodes, _space(begin), _space(end))


def known_space(name: str, source: str) -> Primaries:
    """Primaries of a known space by name, `AP0` and `AP1` among them."""
    red, green, blue, white = _all_spaces()[name]
    return Primaries(name, red, green, blue, white, source)


def _all_spaces() -> dict[str, Any]:
    xyz = (CIE_XYZ.red, CIE_XYZ.green, CIE_XYZ.blue, CIE_XYZ.white)
    return {**KNOWN_PRIMARIES, CIE_XYZ.name: xyz}


def _children(metadata: Any) -> list[Any]:
    return list(metadata.getChildElements())


def _space(descriptor: str) -> Primaries | None:
    """The linear space that a descriptor names, if it names one."""
    if not _LINEAR.search(descriptor) or _ENCODED.search(descriptor):
        return None
    names = [name for pattern, name in _SPACES if pattern.search(descriptor)]
    return known_space(names[0], BY_DESCRIPTION) if names else None


def space_by_matrix(processor: Any) -> Primaries | None:
    """Return the space that the matrix at the end leads to, from any known one; or None."""
    steps = list(processor.createGroupTransform())
    if not steps or not isinstance(steps[-1], ocio.MatrixTransform):
        return None
    full = np.array(steps[-1].getMatrix()).reshape(4, 4)
    if any(steps[-1].getOffset()) or not np.array_equal(full[3], [0, 0, 0, 1]):
        return None
    if steps[-1].getDirection() == ocio.TRANSFORM_DIR_INVERSE:
        full = np.linalg.inv(full)
    if np.abs(full[:3, :3] - np.diag(np.diag(full[:3, :3]))).max() < _SAME_MATRIX:
        return None
    spaces = {name: _to_xyz(*space) for name, space in _all_spaces().items()}
    for name, target in spaces.items():
        for source in spaces.values():
            if np.abs(np.linalg.solve(target, source) - full[:3, :3]).max() < _SAME_MATRIX:
                return known_space(name, BY_MATRIX)
    return None


def _to_xyz(*space: tuple[float, float]) -> npt.NDArray[np.float64]:
    """(3, 3) matrix to CIE XYZ of D65, from xy of red, green, blue and white."""
    *rgb, white = space
    if white == CIE_XYZ.white:
        return np.eye(3)
    return np.asarray(bradford(white, D65) @ rgb_to_xyz(rgb, white))


def _bulges(processor: Any) -> bool:
    """Whether grays become much brighter, and hardly ever darker, relative to black and white."""
    shades = np.linspace(0.0, 1.0, _SHADES, dtype=np.float32)
    gray = np.repeat(shades[:, None], 3, axis=1)
    exact_cpu(processor).applyRGB(gray)
    curve: Float = gray.mean(axis=1, dtype=np.float64)
    if not np.isfinite(curve).all() or curve[-1] - curve[0] < 1e-6:
        return False
    above = (curve - curve[0]) / (curve[-1] - curve[0]) - shades
    return bool(above.max() > _BULGE and above.min() > -_DIP)
