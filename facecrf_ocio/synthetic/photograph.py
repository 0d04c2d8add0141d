"""From linear light to the photo a camera would store."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.synthetic.spec import SyntheticFace
from facecrf_ocio.values import Camera, InverseCRF, Photo


def gamma_curve(exponent: float | npt.ArrayLike, samples: int = 4096) -> InverseCRF:
    """The inverse CRF linear = encoded ** exponent, one exponent or one for each channel.

    Raises
    ------
    SettingsError
        If an exponent is not positive.
    """
    encoded = np.linspace(0.0, 1.0, samples)
    exponents = np.broadcast_to(np.asarray(exponent, dtype=np.float64), (3,))
    if not (exponents > 0).all():
        raise SettingsError("the exponent of an inverse CRF must be positive")
    return InverseCRF(encoded, encoded ** exponents[:, None])


def encode(linear: npt.ArrayLike, curve: InverseCRF, bits: int = 8) -> npt.NDArray[np.float32]:
    """Apply a camera response and round to integer code values.

    Parameters
    ----------
    linear
        (..., 3) relative linear light; clipped to [0, 1].
    curve
        The inverse of the response to apply.
    bits
        Bits of the code values, 1 to 16; 0 to leave them unrounded.

    Returns
    -------
    numpy.ndarray
        (..., 3) float32 code values divided by their maximum, [0, 1].

    Raises
    ------
    SettingsError
        If it is another number of bits.
    """
    encoded = curve.encode(np.asarray(linear))
    if bits == 0:
        return encoded
    if not 1 <= bits <= 16:
        raise SettingsError(f"cannot round to {bits} bits; give 1 to 16, or 0 not to round")
    top = np.float32(2**bits - 1)
    return np.asarray(np.round(encoded * top) / top, dtype=np.float32)


def photograph(face: SyntheticFace, curve: InverseCRF, bits: int = 8) -> Photo:
    """Store a rendered face as a photo of `bits` bits (0: floating point) through a response."""
    return Photo(
        encode(face.linear, curve, bits),
        bit_depth=bits or None,
        camera=Camera(model="synthetic"),
    )
