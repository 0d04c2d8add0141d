"""What cameras and software do to light, in the order in which they do it, drawn once for a photo.

Lens, photon and read noise, mosaic, denoising, color matrix, response, denoising and sharpening of
encoded values, scaling, JPEG.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.synthetic.jpeg import Codes, through_jpeg
from facecrf_ocio.training.before_camera import gray_of
from facecrf_ocio.training.denoise import Denoiser
from facecrf_ocio.values import Float

Light = npt.NDArray[np.float32]
_WHITE = 65535  # [code value] of 16 bits, which demosaicing takes
_LEVELS = 16384  # of the root of light: 64 for each code of 8 bits


@dataclass(frozen=True, slots=True, eq=False)
class Process:
    """Everything that happens to the light of one photo.

    Attributes
    ----------
    stops, gains
        Exposure [EV], and (3,) factors of white balance on top of it.
    blur
        [px] Deviation of the lens's blur, 0 for none.
    full_well, read_noise
        [electrons] At saturation; infinite for no noise.
    raw_gains
        (3,) of the sensor's channels, by which white balance amplifies their noise.
    matrix
        How much more saturated the color matrix makes what the sensor sees.
    mosaic
        `none`, `edge-aware` or `bilinear`.
    denoise, smooth
        Of light, and of encoded values.
    sharpen, sharpen_radius
        Strength and [px] radius of an unsharp mask on encoded values.
    scale
        Factor of the size as stored, at most 1.
    resampling
        OpenCV's number.
    jpeg, sampling, first_jpeg
        Quality of the file, 0 for none; its sampling of colors; quality of a JPEG before that
        (before scaling if there is scaling), 0 for none.
    sharpen_small
        Strength of sharpening after scaling.
    """

    stops: float
    gains: Float
    blur: float
    full_well: float
    read_noise: float
    raw_gains: Float
    matrix: float
    mosaic: str
    denoise: Denoiser
    smooth: Denoiser
    sharpen: float
    sharpen_radius: float
    scale: float
    resampling: int
    jpeg: int
    sampling: str
    first_jpeg: int
    sharpen_small: float

    @property
    def noise(self) -> float:
        """Deviation of the noise of light's root, roughly: half of that of the photons."""
        return float(0.5 * np.sqrt(2.0**self.stops * self.raw_gains.mean() / self.full_well))


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """Light to encoded values, by a table over the root of light, which resolves the shadows."""

    table: npt.NDArray[np.float32]

    @staticmethod
    def of(inverse: Float) -> Response:
        """From an inverse response at uniform encoded values."""
        grid = np.linspace(0.0, 1.0, inverse.size)
        nodes = np.linspace(0.0, 1.0, _LEVELS) ** 2
        rising = inverse + np.arange(inverse.size) * 1e-9
        return Response(np.interp(nodes, rising, grid).astype(np.float32))

    def encode(self, light: Light) -> Light:
        """Of light from 0 to 1."""
        index = (np.sqrt(light) * np.float32(_LEVELS - 1) + np.float32(0.5)).astype(np.uint16)
        return np.asarray(np.take(self.table, index), np.float32)


def photograph(
    light: Light,
    process: Process,
    response: Response,
    size: tuple[int, int],
    generator: np.random.Generator,
    coarse: float = 1.0,
) -> Light:
    """Encoded values (h, w, 3) of a part of the photo from light (H, W, 3) at the sensor's size.

    Parameters
    ----------
    light
        Of the part, before exposure.
    process, response
        Of the photo.
    size
        Height and width of the part as stored.
    generator
        Of the noise.
    coarse
        Pixels of `light` per pixel of the sensor, at most 1. Below a half the noise is averaged,
        and what happens from pixel to pixel is left out: it does not show.
    """
    fine = coarse > 0.5
    if fine and process.blur:
        light = np.asarray(cv2.GaussianBlur(light, (0, 0), process.blur * coarse), np.float32)
    light = _sensed(light, process, generator, coarse)
    root = np.sqrt(light)
    if fine:
        root = process.denoise.apply(root, process.noise)
    light = np.clip(root, 0.0, 1.0) ** 2
    if process.matrix > 1.0:
        gray = gray_of(light)
        light = np.clip(gray + np.float32(process.matrix) * (light - gray), 0.0, 1.0)
    encoded = response.encode(np.asarray(light, np.float32))
    if fine:
        encoded = process.smooth.apply(encoded, max(0.006, process.noise))
        encoded = _sharpened(encoded, process.sharpen, process.sharpen_radius)
    return _stored(encoded, process, size, fine=fine)


def _sensed(light: Light, process: Process, generator: np.random.Generator, coarse: float) -> Light:
    gray = gray_of(light)
    light = gray + (light - gray) / np.float32(process.matrix)
    light = light * (2.0**process.stops * process.gains).astype(np.float32)
    if np.isfinite(process.full_well):
        well = process.full_well / process.raw_gains
        variance = light / well.astype(np.float32)
        variance += ((process.read_noise / well) ** 2).astype(np.float32)
        noise = generator.standard_normal(light.shape, dtype=np.float32)
        light = light + noise * np.sqrt(variance) * np.float32(coarse)
    light = np.clip(light, 0.0, 1.0)
    if process.mosaic != "none" and coarse > 0.5:
        light = demosaiced(light, process.mosaic)
    return np.asarray(light, np.float32)


def demosaiced(light: Light, how: str) -> Light:
    """One channel a pixel, the others from its neighbors: noise that is alike in neighbors."""
    mosaic = light[..., 1].copy()
    mosaic[::2, ::2] = light[::2, ::2, 0]
    mosaic[1::2, 1::2] = light[1::2, 1::2, 2]
    codes = np.rint(mosaic * np.float32(_WHITE)).astype(np.uint16)
    way = cv2.COLOR_BayerRGGB2RGB_EA if how == "edge-aware" else cv2.COLOR_BayerRGGB2RGB
    full = cv2.demosaicing(codes, way)
    return np.asarray(full * np.float32(1.0 / _WHITE), np.float32)


def _sharpened(encoded: Light, strength: float, radius: float) -> Light:
    if not strength:
        return encoded
    soft = cv2.GaussianBlur(encoded, (0, 0), radius)
    return np.asarray(encoded + np.float32(strength) * (encoded - soft), np.float32)


def _stored(encoded: Light, process: Process, size: tuple[int, int], *, fine: bool) -> Light:
    """Scaled and compressed; in 8 bits unless the part is too coarse for that to show."""
    if encoded.shape[:2] != size:
        if process.first_jpeg and fine:
            encoded = _compressed(encoded, process.first_jpeg, process.sampling)
        smaller = cv2.resize(encoded, size[::-1], interpolation=process.resampling)
        encoded = _sharpened(np.asarray(smaller, np.float32), process.sharpen_small, 0.7)
    elif process.first_jpeg and fine:
        encoded = _compressed(encoded, process.first_jpeg, process.sampling)
    if not fine:
        return np.asarray(np.clip(encoded, 0.0, 1.0), np.float32)
    if process.jpeg:
        return _compressed(encoded, process.jpeg, process.sampling)
    return in_codes(encoded).astype(np.float32) / np.float32(255.0)


def in_codes(encoded: Light) -> Codes:
    """Rounded to 8 bits."""
    return np.asarray(np.clip(np.rint(encoded * np.float32(255.0)), 0, 255), np.uint8)


def _compressed(encoded: Light, quality: int, sampling: str) -> Light:
    """Encoded values (H, W, 3) as they come back from a JPEG file."""
    return through_jpeg(in_codes(encoded), quality, sampling).astype(np.float32) / np.float32(255.0)
