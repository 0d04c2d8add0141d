"""Diffuse skin pixels, found by their hue (sec. 5.1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from facecrf_ocio.settings import FaceSettings
from facecrf_ocio.values import Bool

HUE_BIN = 2.0  # [degree] of the histogram
CLIPPED = 0.98  # [encoded] brightest channel from which a pixel may have lost light
BLACK = 0.02  # [encoded] darkest channel: below, rounding decides the hue
MIN_SATURATION = 0.02  # of HSV: below, noise decides the hue


@dataclass(frozen=True, slots=True, eq=False)
class SkinMask:
    """Which pixels of a face are skin.

    Attributes
    ----------
    skin
        (H, W) bare skin of the face's hue, neither clipped nor black.
    diffuse
        (H, W) those of `skin` that are neither among the darkest nor the brightest.
    hue_mode
        [degree] Most frequent hue P.
    hue_histogram
        (180,) share of the bare skin's pixels per bin of two degrees.
    """

    skin: Bool
    diffuse: Bool
    hue_mode: float
    hue_histogram: npt.NDArray[np.float64]


def find_skin(
    encoded: npt.NDArray[np.float32], bare_skin: Bool, settings: FaceSettings
) -> SkinMask:
    """Select skin by hue and brightness.

    Parameters
    ----------
    encoded
        (H, W, 3) float32 in [0, 1].
    bare_skin
        (H, W) inside of the face mesh, without eyes, brows, lips and nostrils.
    """
    planes: Any = cv2.split(cv2.cvtColor(encoded, cv2.COLOR_RGB2HSV))
    hue, saturation, value = planes
    colors: Any = cv2.split(encoded)
    red, green, blue = colors
    darkest = np.asarray(cv2.min(cv2.min(red, green), blue))
    usable = bare_skin & (value < CLIPPED) & (darkest > BLACK)
    colored = usable & (saturation > MIN_SATURATION)
    mode, histogram = _hue_mode(hue[colored])
    turned = hue - mode + 180.0
    turned -= 360.0 * np.floor(turned / 360.0)  # NumPy's remainder takes some times as long
    distance = np.abs(turned - 180.0)
    skin = colored & (distance <= settings.hue_half_width)
    if not skin.any():
        return SkinMask(skin, skin, mode, histogram)
    low, high = np.quantile(value[skin], [settings.value_low, settings.value_high])
    diffuse = skin & (value >= low) & (value <= high)
    return SkinMask(skin, diffuse, mode, histogram)


def _hue_mode(hue: npt.NDArray[np.float32]) -> tuple[float, npt.NDArray[np.float64]]:
    """Center [degree] of the fullest bin of hues (N,), smoothed over three; each bin's share."""
    bins = int(360.0 / HUE_BIN)
    counts = np.bincount((hue / HUE_BIN).astype(np.intp) % bins, minlength=bins)
    smooth = counts + np.roll(counts, 1) + np.roll(counts, -1)
    share = counts / max(int(counts.sum()), 1)
    return (float(np.argmax(smooth)) + 0.5) * HUE_BIN, share
