"""A camera with all its steps, in their order: scene, lens, sensor, developing, curve, file.

Written apart from what varies the photos of the training, so that habits of one are not those of
the other: noise is counted in photons on the mosaic, which is interpolated by the filters of
Malvar, He and Cutler (2004), and reduced by a guided filter (He, Sun and Tang 2010).
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.benchmark.conditions import Conditions
from facecrf_ocio.benchmark.virtual_camera import FULL_WELL_ISO_100, READ_NOISE
from facecrf_ocio.color.primaries import LUMINANCE
from facecrf_ocio.synthetic.jpeg import through_jpeg
from facecrf_ocio.values import Float

Image = npt.NDArray[np.float32]
_LUMA = LUMINANCE.astype(np.float32)
_LEAST_MEGAPIXELS = 0.3  # below it faces of whole portraits are too small to be found
_LEVELS = 65536  # of linear light, as a 16-bit raw converter has them
_GUIDE_RADIUS, _CHROMA_DEVIATION = 2, 2.0  # [pixel] of the noise reduction
_PATCH, _SEARCH = 5, 11  # [pixel] of non-local means; OpenCV's 7 and 21 take five times as long
_TYPICAL_ISO = 400.0  # where conditions name none; indoors by day, chosen by judgment
_MID_GRAY = 0.18  # [1] of white: the reflectance that exposure meters are set to

# Malvar, He and Cutler, fig. 2, times 8: green at red or blue; red at green in its own row, and in
# its own column; red at blue.
_GREEN = ((0, 0, -1, 0, 0), (0, 0, 2, 0, 0), (-1, 2, 4, 2, -1), (0, 0, 2, 0, 0), (0, 0, -1, 0, 0))
_IN_ROW = ((0, 0, 0.5, 0, 0), (0, -1, 0, -1, 0), (-1, 4, 5, 4, -1), (0, -1, 0, -1, 0),
           (0, 0, 0.5, 0, 0))  # fmt: skip
_DIAGONAL = ((0, 0, -1.5, 0, 0), (0, 2, 0, 2, 0), (-1.5, 0, 6, 0, -1.5), (0, 2, 0, 2, 0),
             (0, 0, -1.5, 0, 0))  # fmt: skip


def photograph(
    scene: Image, inverse: Float, conditions: Conditions, generator: np.random.Generator
) -> npt.NDArray[np.uint8]:
    """Take a photo under given conditions.

    Parameters
    ----------
    scene
        (H, W, 3) relative linear light; what exceeds 1 is clipped by the sensor.
    inverse
        (3, K) the camera's inverse response at uniform encoded values.
    conditions
        What happens on the way.
    generator
        Source of the noise.

    Returns
    -------
    numpy.ndarray
        (H', W', 3) 8-bit code values, as they come back from the file.
    """
    light = _sensed(_lit(scene, conditions), conditions, generator)
    if conditions.denoise_before:
        light = _denoised(light, conditions)
    return _stored(_finished(_encoded(light, inverse), conditions), conditions)


def _lit(scene: Image, conditions: Conditions) -> Image:
    """The scene's light as it reaches the sensor."""
    gray = scene @ _LUMA
    light = gray[..., None] + np.float32(conditions.saturation) * (scene - gray[..., None])
    factor = 2.0**conditions.exposure * np.array(conditions.gains)
    light = np.maximum(light, 0.0) * factor.astype(np.float32)
    megapixels = max(conditions.megapixels or 0.0, _LEAST_MEGAPIXELS)
    height, width = light.shape[:2]
    scale = np.sqrt(megapixels * 1e6 / (height * width))
    if scale > 1.0:
        size = (round(scale * width), round(scale * height))
        light = np.maximum(cv2.resize(light, size, interpolation=cv2.INTER_CUBIC), 0.0)
    if conditions.blur:
        light = cv2.GaussianBlur(light, (0, 0), conditions.blur)
    return np.asarray(light, np.float32)


def _sensed(light: Image, conditions: Conditions, generator: np.random.Generator) -> Image:
    """What the sensor counts, one color a pixel if it has a mosaic."""
    seen = _mosaic(light) if conditions.mosaic else light
    if conditions.iso is not None:
        well = FULL_WELL_ISO_100 * 100.0 / conditions.iso
        electrons = generator.poisson(seen * well).astype(np.float32)
        electrons += READ_NOISE * generator.standard_normal(seen.shape, dtype=np.float32)
        seen = electrons / np.float32(well)
    seen = np.asarray(np.clip(seen, 0.0, 1.0), np.float32)
    return np.clip(_demosaic(seen), 0.0, 1.0) if conditions.mosaic else seen


def _mosaic(light: Image) -> Image:
    """One channel a pixel: red at even rows and columns, blue at odd ones."""
    mosaic = light[..., 1].copy()
    mosaic[::2, ::2] = light[::2, ::2, 0]
    mosaic[1::2, 1::2] = light[1::2, 1::2, 2]
    return mosaic


def _demosaic(mosaic: Image) -> Image:
    green, in_row, in_column, diagonal = (
        cv2.filter2D(
            mosaic, -1, np.array(taps, np.float32) / 8.0, borderType=cv2.BORDER_REFLECT_101
        )
        for taps in (_GREEN, _IN_ROW, np.array(_IN_ROW).T, _DIAGONAL)
    )
    full = np.stack([mosaic, mosaic, mosaic], axis=2)
    for own, other, row in ((0, 2, 0), (2, 0, 1)):
        full[row::2, row::2, 1] = green[row::2, row::2]
        full[row::2, row::2, other] = diagonal[row::2, row::2]
        full[row::2, 1 - row :: 2, own] = in_row[row::2, 1 - row :: 2]
        full[1 - row :: 2, row::2, own] = in_column[1 - row :: 2, row::2]
    return full


def _denoised(light: Image, conditions: Conditions) -> Image:
    """Luma by a guided filter on the root of light, where noise is even; chroma by a blur."""
    well = FULL_WELL_ISO_100 * 100.0 / (conditions.iso or _TYPICAL_ISO)
    noise = np.sqrt(_MID_GRAY / well + (READ_NOISE / well) ** 2) / (2.0 * np.sqrt(_MID_GRAY))
    root = np.sqrt(light)
    luma = root @ _LUMA
    chroma = cv2.GaussianBlur(root - luma[..., None], (0, 0), _CHROMA_DEVIATION)
    smooth = _guided(luma, float((conditions.denoise_before * noise) ** 2))
    return np.asarray(np.clip(smooth[..., None] + chroma, 0.0, 1.0) ** 2, np.float32)


def _guided(image: Image, epsilon: float) -> Image:
    """He, Sun and Tang's filter, guided by the image itself: edges stay where variance is more."""
    window = (2 * _GUIDE_RADIUS + 1, 2 * _GUIDE_RADIUS + 1)
    mean = cv2.blur(image, window)
    variance = np.maximum(cv2.blur(image * image, window) - mean * mean, 0.0)
    slope = variance / (variance + epsilon)
    return np.asarray(
        cv2.blur(slope, window) * image + cv2.blur(mean - slope * mean, window), np.float32
    )


def _encoded(light: Image, inverse: Float) -> Image:
    """Code values (H, W, 3) in [0, 1], not rounded, by a table of 16-bit light."""
    grid = np.linspace(0.0, 1.0, inverse.shape[1])
    levels = np.linspace(0.0, 1.0, _LEVELS)
    rising = inverse + np.arange(grid.size) * 1e-9
    tables = np.array([np.interp(levels, row / row[-1], grid) for row in rising], np.float32)
    index = np.rint(light * np.float32(_LEVELS - 1)).astype(np.uint16)
    return np.stack([tables[c][index[..., c]] for c in range(3)], axis=2)


def _finished(encoded: Image, conditions: Conditions) -> Image:
    """What is done to encoded values before the file is written."""
    if conditions.denoise_after:
        strength = conditions.denoise_after
        codes = cv2.fastNlMeansDenoisingColored(
            _rounded(encoded), None, strength, strength, _PATCH, _SEARCH
        )
        encoded = codes.astype(np.float32) / np.float32(255.0)
    if conditions.sharpen:
        luma = encoded @ _LUMA
        detail = luma - cv2.GaussianBlur(luma, (0, 0), conditions.sharpen_radius)
        encoded = encoded + np.float32(conditions.sharpen) * detail[..., None]
    if conditions.halve:
        half = (encoded.shape[1] // 2, encoded.shape[0] // 2)
        encoded = np.asarray(cv2.resize(encoded, half, interpolation=cv2.INTER_AREA), np.float32)
    return np.asarray(encoded, np.float32)


def _rounded(encoded: Image) -> npt.NDArray[np.uint8]:
    return np.asarray(np.rint(np.clip(encoded, 0.0, 1.0) * 255.0), np.uint8)


def _stored(encoded: Image, conditions: Conditions) -> npt.NDArray[np.uint8]:
    codes = _rounded(encoded)
    if conditions.quality is None:
        return codes
    return through_jpeg(codes, conditions.quality, conditions.sampling)
