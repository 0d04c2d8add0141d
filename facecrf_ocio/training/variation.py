"""What differs between photos of one head: light, exposure, noise, and what is done to them.

Wider than any one camera's, so that the networks learn what holds for all.
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.benchmark.virtual_camera import FULL_WELL_ISO_100, READ_NOISE, through_jpeg

_WHITE = 65535


def vary(
    linear: npt.NDArray[np.float32], generator: np.random.Generator
) -> npt.NDArray[np.float32]:
    """Another skin, light, color matrix, exposure, white balance, noise and sharpness."""
    return _photographed(_staged(linear, generator), generator)


def _staged(
    light: npt.NDArray[np.float32], generator: np.random.Generator
) -> npt.NDArray[np.float32]:
    """What is before the camera; its own noise is left in most."""
    if generator.random() < 0.4:
        light = _saturate(light, np.exp(generator.normal(0.0, 0.25)))
    if generator.random() < 0.3:
        light = light * _uneven_light(light.shape[:2], generator)
    if generator.random() < 0.3:
        light = _denoise(light, generator)
    if generator.random() < 0.3:
        light = _even(light, generator.uniform(0.2, 1.0))
    if generator.random() < 0.35:
        light = light * _texture(light.shape[:2], generator)
    return light


def _photographed(
    light: npt.NDArray[np.float32], generator: np.random.Generator
) -> npt.NDArray[np.float32]:
    """What a camera and its raw converter make of it."""
    stops = generator.uniform(*((-0.9, 0.5) if generator.random() < 0.8 else (-3.5, 0.9)))
    spread = 0.06 if generator.random() < 0.7 else 0.15
    gains = 2.0**stops * np.exp(generator.normal(0.0, spread, 3))
    light = light * gains.astype(np.float32)
    if generator.random() < 0.25:
        light = np.asarray(cv2.GaussianBlur(light, (0, 0), generator.uniform(0.5, 2.0)))
    if generator.random() < 0.5:
        full_well = FULL_WELL_ISO_100 / 2.0 ** generator.uniform(0.0, 5.0)
        read_noise = READ_NOISE * (10.0 ** generator.random() if generator.random() < 0.4 else 1.0)
        deviation = np.sqrt(light / full_well + (read_noise / full_well) ** 2)
        light = light + generator.standard_normal(light.shape, dtype=np.float32) * deviation
    light = np.clip(light, 0.0, 1.0)
    if generator.random() < 0.3:
        light = _demosaic(light)
    if generator.random() < 0.25:
        light = _denoise(light, generator)
    if generator.random() < 0.25:
        light = np.asarray(cv2.GaussianBlur(light, (0, 0), generator.uniform(0.4, 1.0)))
    return np.asarray(np.clip(light, 0.0, 1.0), dtype=np.float32)


def _denoise(
    light: npt.NDArray[np.float32], generator: np.random.Generator
) -> npt.NDArray[np.float32]:
    """As cameras do before the tone curve; the root of light is where noise is even."""
    root = np.sqrt(light)
    for _ in range(int(generator.integers(1, 3))):
        root = cv2.bilateralFilter(root, 5, generator.uniform(0.01, 0.08), 2.0)
    return np.asarray(root**2, dtype=np.float32)


def _demosaic(light: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """One channel a pixel, the others from its neighbors: noise that is alike in neighbors."""
    mosaic = light[..., 1].copy()
    mosaic[::2, ::2] = light[::2, ::2, 0]
    mosaic[1::2, 1::2] = light[1::2, 1::2, 2]
    codes = np.rint(mosaic * np.float32(_WHITE)).astype(np.uint16)
    full = cv2.demosaicing(codes, cv2.COLOR_BayerRGGB2RGB_EA)
    return np.asarray(full / np.float32(_WHITE), dtype=np.float32)


def _saturate(light: npt.NDArray[np.float32], factor: float) -> npt.NDArray[np.float32]:
    """Other primaries, roughly: every color moved from, or toward, its gray."""
    gray = light.mean(axis=2, keepdims=True)
    return np.asarray(np.maximum(gray + factor * (light - gray), 0.0), dtype=np.float32)


def _even(light: npt.NDArray[np.float32], contrast: float) -> npt.NDArray[np.float32]:
    """Fewer blemishes: colors nearer to those of their surroundings, shading as it was."""
    gray = light.mean(axis=2, keepdims=True) + np.float32(1e-4)
    color = light / gray
    around = cv2.GaussianBlur(color, (0, 0), 12.0)
    return np.asarray(gray * (around + np.float32(contrast) * (color - around)), dtype=np.float32)


def _texture(shape: tuple[int, int], generator: np.random.Generator) -> npt.NDArray[np.float32]:
    """Fine texture of all that is seen (H, W, 1), which grows with light and not with its root."""
    grain = generator.standard_normal(shape, dtype=np.float32)
    if generator.random() < 0.7:
        grain = np.asarray(cv2.GaussianBlur(grain, (0, 0), generator.uniform(0.4, 1.5)))
    strength = np.exp(generator.uniform(np.log(0.002), np.log(0.04)))
    return np.asarray(np.exp(strength / grain.std() * grain)[..., None], dtype=np.float32)


def _uneven_light(
    shape: tuple[int, int], generator: np.random.Generator
) -> npt.NDArray[np.float32]:
    """A smooth field of light (H, W, 3), a little of it colored: a second, mixed illuminant."""
    coarse = generator.normal(0.0, 0.25, (3, 3, 1)) + generator.normal(0.0, 0.05, (3, 3, 3))
    field = cv2.resize(np.exp(coarse), shape[::-1], interpolation=cv2.INTER_CUBIC)
    return np.asarray(field, dtype=np.float32)


def process(
    encoded: npt.NDArray[np.float32], generator: np.random.Generator
) -> npt.NDArray[np.float32]:
    """What software may do to encoded values before a photo is stored; often nothing."""
    if generator.random() < 0.3:
        codes = np.rint(encoded * 255.0).astype(np.uint8)
        strength = generator.uniform(0.3, 1.2)
        kind = int(generator.integers(4))
        if kind == 0:
            codes = cv2.bilateralFilter(codes, 5, 25.0 * strength, 2.0)
        elif kind == 1:
            codes = cv2.medianBlur(codes, 3)
        else:
            soft = cv2.GaussianBlur(codes, (0, 0), strength)
            codes = soft if kind == 2 else cv2.addWeighted(codes, 1 + strength, soft, -strength, 0)
        encoded = codes.astype(np.float32) / np.float32(255.0)
    if generator.random() < 0.3:
        encoded = _compress(encoded, int(generator.integers(70, 98)))
    return encoded


def _compress(encoded: npt.NDArray[np.float32], quality: int) -> npt.NDArray[np.float32]:
    codes = through_jpeg(np.rint(encoded * 255.0).astype(np.uint8), quality)
    return codes.astype(np.float32) / np.float32(255.0)
