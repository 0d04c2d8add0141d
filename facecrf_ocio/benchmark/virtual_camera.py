"""A camera of which everything is known: from linear light to the photo it would store."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.photo.raster.pixels import is_gray
from facecrf_ocio.synthetic.jpeg import through_jpeg
from facecrf_ocio.values import Float, Photo, Primaries

FULL_WELL_ISO_100 = 60_000.0  # [electron] at which a pixel of a full-frame camera saturates
READ_NOISE = 5.0  # [electron] standard deviation, of the same


@dataclass(frozen=True, slots=True)
class CameraEncoding:
    """How the camera stores a photo.

    Attributes
    ----------
    bits
        Bits of the integer code values, 8 to 16.
    jpeg
        Quality, 1 to 100, of a real JPEG (chroma at half resolution); None for no compression.
    iso
        Sensitivity whose photon and read noise is added to the linear light; None for none.
    """

    bits: int = 8
    jpeg: int | None = None
    iso: float | None = None

    def __post_init__(self) -> None:
        if not 8 <= self.bits <= 16:
            raise SettingsError(f"cannot store {self.bits} bits; give 8 to 16")
        if self.jpeg is not None and not (1 <= self.jpeg <= 100 and self.bits == 8):
            raise SettingsError("a JPEG has 8 bits and a quality of 1 to 100")
        if self.iso is not None and not self.iso > 0:
            raise SettingsError("ISO must be positive")


def take_photo(
    linear: npt.NDArray[np.float32],
    inverse: Float,
    encoding: CameraEncoding,
    generator: np.random.Generator,
    primaries: Primaries | None = None,
) -> Photo:
    """Expose, encode and store a scene.

    Parameters
    ----------
    linear
        (H, W, 3) relative linear light; clipped to [0, 1] as a sensor clips.
    inverse
        (3, K) the camera's inverse response at uniform encoded values.
    encoding
        Noise, code values, compression.
    generator
        Source of the noise.
    primaries
        Of `linear`; the response does not change them.
    """
    exposed: Float = np.clip(linear.astype(np.float64), 0.0, 1.0)
    if encoding.iso is not None:
        exposed = _add_noise(exposed, encoding.iso, generator)
    grid = np.linspace(0.0, 1.0, inverse.shape[1])
    encoded = np.stack([np.interp(exposed[..., c], inverse[c], grid) for c in range(3)], axis=2)
    top = 2**encoding.bits - 1
    codes = np.rint(encoded * top)
    if encoding.jpeg is not None:
        codes = through_jpeg(codes.astype(np.uint8), encoding.jpeg).astype(np.float64)
    stored = np.asarray(codes / top, dtype=np.float32)
    return Photo(stored, encoding.bits, grayscale=is_gray(stored), primaries=primaries)


def count_codes(photo: Photo) -> npt.NDArray[np.int64]:
    """Pixels of each code value, (3, L); beyond 12 bits neighboring codes are counted together."""
    levels = 2 ** min(photo.bit_depth or 12, 12)
    codes = np.rint(photo.encoded * (levels - 1)).astype(np.intp)
    return np.stack([np.bincount(codes[..., c].ravel(), minlength=levels) for c in range(3)])


def _add_noise(exposed: Float, iso: float, generator: np.random.Generator) -> Float:
    full_well = FULL_WELL_ISO_100 * 100.0 / iso
    electrons = generator.poisson(exposed * full_well) + generator.normal(
        0.0, READ_NOISE, exposed.shape
    )
    return np.clip(electrons / full_well, 0.0, 1.0)
