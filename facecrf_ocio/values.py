"""The values that travel through the package: immutable, validated, without algorithms.

What goes in stands here, what comes out in `estimates.py`; all are known by this module's name.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from facecrf_ocio.checks import (
    Bool,
    Float,
    Index,
    check_bit_depth,
    check_primaries,
    checked_alpha,
    checked_pixels,
    checked_shape,
    encoded_of,
    frozen,
    require_types,
)
from facecrf_ocio.errors import SettingsError
from facecrf_ocio.estimates import (
    CHANNELS,
    DIFFERS_SHARE,
    Confidence,
    Estimate,
    Face,
    InStops,
    InverseCRF,
    Lacking,
    Outcome,
    Verdict,
)

__all__ = [
    "CHANNELS",
    "DIFFERS_SHARE",
    "Bool",
    "Camera",
    "Confidence",
    "Estimate",
    "Face",
    "Float",
    "GainMap",
    "InStops",
    "Index",
    "InverseCRF",
    "Lacking",
    "Outcome",
    "Photo",
    "Primaries",
    "Verdict",
    "frozen",
]


@dataclass(frozen=True, slots=True)
class Primaries:
    """RGB primaries and white as CIE xy chromaticities, and where they were learned from.

    Attributes
    ----------
    name
        `Rec.709`, `Display P3`, `Adobe RGB`, `Rec.2020`, `ProPhoto`, or `custom`.
    red, green, blue, white
        CIE 1931 xy.
    source
        `ICC profile`, `EXIF`, `file attribute`, `camera raw decoding` or `assumed`.
    """

    name: str
    red: tuple[float, float]
    green: tuple[float, float]
    blue: tuple[float, float]
    white: tuple[float, float]
    source: str


@dataclass(frozen=True, slots=True)
class Camera:
    """What the file says of the camera and the software that made it; empty where it is silent."""

    make: str = ""
    model: str = ""
    serial: str = ""
    software: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class GainMap:
    """What brings a photo's encoded picture to the HDR rendition that its maker meant.

    HDR light is (light + `base_offset`) * 2^g - `offset`, with g = `low` + (`high` - `low`) *
    m^(1 / `gamma`) and m the map's value there (ISO 21496-1, which Ultra HDR and Adobe share; all
    numbers (3,), of R, G, B). Apple's is 1 + (2^`high` - 1) * m instead of 2^g, m being linear.

    Attributes
    ----------
    values
        (h, w, 3) float32 in [0, 1], upright, coarser than the photo or alike.
    low, high
        [stop] Gain where the map is 0, and where it is 1.
    gamma
        Exponent by which the map is encoded.
    base_offset, offset
        [light, white of the encoded picture is 1] Added before, subtracted after.
    standard
        `Ultra HDR`, `ISO 21496-1` or `Apple`.
    primaries
        In which the gain is meant, if not in those of the encoded picture.
    rendition
        Primaries of the HDR light, if not those in which the gain is meant.
    base, orientation
        The encoded picture as JPEG, and how that is turned upright; empty where it is none.
    centered
        Whether a coarser map's pixels lie in the middle of those of the photo for which they stand
        (HEIF), and not each at the first of them (JPEG).
    """

    values: npt.NDArray[np.float32]
    low: Float
    high: Float
    gamma: Float
    base_offset: Float
    offset: Float
    standard: str
    primaries: Primaries | None = None
    rendition: Primaries | None = None
    base: bytes = field(default=b"", repr=False)
    orientation: int = 1
    centered: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", frozen(self.values, np.float32))
        for name in ("low", "high", "gamma", "base_offset", "offset"):
            object.__setattr__(self, name, frozen(getattr(self, name)))
        numbers = (self.low, self.high, self.gamma, self.base_offset, self.offset)
        if not all(n.shape == (3,) and np.isfinite(n).all() for n in numbers):
            raise SettingsError("a gain map needs three finite numbers for each of its parameters")


_PIXELS = ("encoded", "alpha", "bit_depth", "codes")


@dataclass(frozen=True, slots=True, eq=False)
class Photo:
    """One photo, upright, as encoded by its camera.

    Attributes
    ----------
    encoded
        (H, W, 3) float32, code values divided by their maximum, [0, 1]; for scene-linear input
        (camera raw, EXR, HDR) relative linear light, which may exceed 1.
    bit_depth
        Bits of the file's integer code values; None for floating point.
    scene_linear
        True where the values are proportional to light already.
    named_curve
        `PQ` or `HLG` (ITU-R BT.2100), `log 100:1` or `log 316:1` (ITU-T H.273), or `Cineon log`
        (Kodak) where the file names that for its code values, else empty.
    grayscale
        True where the file has one color channel (repeated in `encoded`).
    alpha
        (H, W) float32 in [0, 1], kept aside; None where the file has none.
    primaries
        None where the file does not tell.
    camera
        What the metadata tell of the camera.
    path, sha256
        Source file and the digest of its bytes; None for an array in memory.
    gain_map
        None where the file has none, or none of use.
    edits
        What the file says was done after the camera, in clauses.
    adapted
        By what the file says that its camera bent the curve to the scene, such as `Active
        D-Lighting (Auto)`; empty where it does not tell.
    notes
        What reading mended, chosen or set aside, in clauses; empty for a file without a flaw.
    codes
        (H, W, 3) uint8 that `encoded` was made of, or will be when it is asked for; None where the
        file has others, or alpha. See `of_codes`.
    """

    encoded: npt.NDArray[np.float32]
    bit_depth: int | None = None
    scene_linear: bool = False
    named_curve: str = ""
    grayscale: bool = False
    alpha: npt.NDArray[np.float32] | None = None
    primaries: Primaries | None = None
    camera: Camera = field(default_factory=Camera)
    path: Path | None = None
    sha256: str | None = None
    gain_map: GainMap | None = None
    edits: tuple[str, ...] = ()
    adapted: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    codes: npt.NDArray[np.uint8] | None = field(default=None, init=False, repr=False)

    @classmethod
    def of_codes(cls, codes: npt.NDArray[np.uint8], **told: Any) -> Photo:
        """A photo of 8-bit code values (H, W, 3), a quarter of what `encoded` takes.

        Most of the package looks at the codes; `encoded` is made when it is asked for, and kept.
        """
        checked_shape(codes, told.get("path"))
        photo = cls(np.zeros((1, 1, 3), np.float32), 8, **told)
        object.__setattr__(photo, "codes", frozen(codes, np.uint8))
        object.__delattr__(photo, "encoded")
        return photo

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Make `encoded` of the codes; of all attributes it alone may not be there yet."""
            if name != "encoded":
                raise AttributeError(f"a Photo has no attribute {name!r}")
            object.__setattr__(self, "encoded", frozen(encoded_of(self.codes), np.float32))
            return self.encoded

    @property
    def pixels(self) -> npt.NDArray[np.uint8] | npt.NDArray[np.float32]:
        """(H, W, 3) `codes` where there are some, else `encoded`."""
        return self.encoded if self.codes is None else self.codes

    @property
    def shape(self) -> tuple[int, int, int]:
        """Height, width, and 3."""
        height, width, channels = self.pixels.shape
        return height, width, channels

    def but(self, **told: Any) -> Photo:
        """The same pixels of which something else is told, such as `primaries`."""
        if self.codes is None:
            return replace(self, **told)
        kept = {
            item.name: getattr(self, item.name)
            for item in fields(self)
            if item.init and item.name not in ("encoded", "bit_depth")
        }
        return Photo.of_codes(self.codes, **{**kept, **told})

    def __repr__(self) -> str:
        height, width, _ = self.shape
        name = "in memory" if self.path is None else self.path.name
        kind = "scene-linear" if self.scene_linear else f"{self.bit_depth} bits"
        kind = kind if self.bit_depth or self.scene_linear else "floats"
        return f"<Photo {name}: {width} x {height}, {kind}>"

    def __post_init__(self) -> None:
        told = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in _PIXELS}
        require_types(Photo, told)
        encoded = checked_pixels(self.encoded, self.path, scene_linear=self.scene_linear)
        object.__setattr__(self, "encoded", frozen(encoded, np.float32))
        if self.alpha is not None:
            alpha = checked_alpha(self.alpha, encoded.shape, self.path)
            object.__setattr__(self, "alpha", frozen(alpha, np.float32))
        check_bit_depth(self.bit_depth, self.path)
        if self.primaries is not None:
            p = self.primaries
            check_primaries((p.red, p.green, p.blue, p.white), self.path)
