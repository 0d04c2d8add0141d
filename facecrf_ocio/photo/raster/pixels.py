"""Arrangements of pixels on their way from a file to a `Photo`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.checks import encoded_of
from facecrf_ocio.files.threads import OtherThread

Pixels = npt.NDArray[Any]
Float32 = npt.NDArray[np.float32]
_MANY_CODES = 32  # of 256; a picture made of few whole numbers may be light


def code_values(codes: Pixels, bits: int) -> Float32:
    """Code values divided by their maximum.

    Parameters
    ----------
    codes
        uint8 or uint16 over its full range, or floating point.
    bits
        Bits of the file where `codes` are uint16: readers scale 10 and 12 bits up to 16, which is
        undone so that the values are those of the file. Else ignored.

    Returns
    -------
    numpy.ndarray
        float32 of the same shape, [0, 1] for integers; floating point is passed on.
    """
    if codes.dtype == np.uint8:
        return encoded_of(codes)
    if codes.dtype == np.uint16:
        if not 8 < bits < 16:
            return np.divide(codes, np.float32(65535), dtype=np.float32)
        maximum = 2**bits - 1
        table = np.rint(np.arange(65536) * (maximum / 65535)) / maximum
        return np.take(table.astype(np.float32), codes)
    return np.asarray(codes, np.float32)


def eight_bit(pixels: Pixels) -> npt.NDArray[np.uint8]:
    """Codes of 8 bits as they are, or encoded values in [0, 1] rounded to them."""
    if pixels.dtype == np.uint8:
        return pixels
    return np.asarray(cv2.convertScaleAbs(pixels, alpha=255), np.uint8)


def packed(pixels: Pixels) -> Pixels:
    """(H, W, C) some pixels of a picture, one after the other in memory.

    NumPy copies them in half of the time where it sees a pixel as one item.
    """
    if not pixels.size or pixels.strides[2] != pixels.itemsize:
        return np.ascontiguousarray(pixels)
    item = np.dtype((np.void, pixels.itemsize * pixels.shape[2]))
    return np.ascontiguousarray(pixels.view(item)).view(pixels.dtype)


def in_8_bits(values: Float32) -> Float32:
    """Code values (...) in [0, 1], rounded to those that an 8-bit file can hold."""
    rounded = np.asarray(values * np.float32(255), np.float32)  # one array, not one a step
    np.rint(rounded, out=rounded)
    rounded /= np.float32(255)
    return rounded


def holds_codes(pixels: Pixels) -> bool:
    """Whether floating point holds nothing but whole numbers, many and up to 255: codes of 8 bits.

    Counts of a sensor are whole numbers too, and go farther.
    """
    if pixels.dtype.kind != "f" or not (_is_whole(pixels[::31, ::31]) and _is_whole(pixels)):
        return False
    return len(np.unique(pixels)) > _MANY_CODES and 0 <= pixels.min() <= pixels.max() <= 255


def _is_whole(pixels: Pixels) -> bool:
    return bool((np.rint(pixels) == pixels).all())


def unpremultiplied(color: Float32, alpha: Float32) -> Float32:
    """Divide (H, W, 3) by (H, W) alpha; where alpha is 0 there is nothing to divide."""
    coverage = np.where(alpha > 0, alpha, np.float32(1))
    return np.asarray(color / coverage[..., None], np.float32)


def filled(whole: Pixels, bands: Iterable[tuple[slice, Pixels]]) -> Pixels:
    """Copy bands to their rows of a whole picture, each while the next is read."""
    with OtherThread() as other:
        copied: Callable[[], object] = list
        for rows, band in bands:
            copied()
            copied = other.begin(partial(np.copyto, whole[rows], band))
        copied()
    return whole


def three_channels(image: Pixels) -> Pixels:
    """(H, W, 3) as it is, or (H, W) repeated."""
    return image if image.ndim == 3 else np.asarray(cv2.merge([image] * 3))


def is_gray(rgb: Pixels) -> bool:
    """Whether the three channels of (H, W, 3) are equal everywhere."""
    return _is_gray(rgb[::31, ::31]) and _is_gray(rgb)


def _is_gray(rgb: Pixels) -> bool:
    red, green, blue = rgb[..., 0], rgb[..., 1], rgb[..., 2]
    return bool((red == green).all() and (green == blue).all())
