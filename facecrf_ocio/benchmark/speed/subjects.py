"""The photos that speed is measured on: a portrait in the public domain, as large as wanted."""

from __future__ import annotations

from pathlib import Path

import cv2
import matplotlib.cbook
import numpy as np

_NOISE = 3.0  # [code] deviation, without which an enlarged photo decodes faster than a camera's
_QUALITY = 92  # of JPEG, as cameras have it
_CLOSE = (130, 30, 390, 290)  # [px] left, top, right, bottom: the face fills half of each side


def portrait(path: Path, megapixels: float, *, close: bool = False, seed: int = 0) -> Path:
    """Write matplotlib's portrait of Grace Hopper (US Navy, public domain), enlarged, as JPEG.

    Parameters
    ----------
    path
        The file, named .jpg.
    megapixels
        How large.
    close
        Cut around the face.
    seed
        Of the noise: another one makes another photo.
    """
    image = cv2.imread(str(matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False)))
    if image is None:
        raise FileNotFoundError("matplotlib's sample data, grace_hopper.jpg")
    if close:
        left, top, right, bottom = _CLOSE
        image = image[top:bottom, left:right]
    height, width = image.shape[:2]
    scale = (megapixels * 1e6 / (height * width)) ** 0.5
    size = (round(width * scale), round(height * scale))
    large = cv2.resize(image, size, interpolation=cv2.INTER_CUBIC)
    grain = np.random.default_rng(seed).standard_normal((size[1], size[0], 1), np.float32)
    codes = np.clip(large + np.float32(_NOISE) * grain, 0, 255).astype(np.uint8)
    cv2.imwrite(str(path), codes, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    return path
