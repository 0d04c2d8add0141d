"""What differs between the photos of a day: camera, exposure, processing, file."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from facecrf_ocio.benchmark.virtual_camera import FULL_WELL_ISO_100
from facecrf_ocio.synthetic.jpeg import SAMPLING
from facecrf_ocio.training.denoise import Denoiser
from facecrf_ocio.training.process import Process

EXPOSURE = 1.1
"""[EV] Deviation of the exposure: cameras, scenes and skins differ by about one stop."""
DARKEST, BRIGHTEST = -4.0, 2.0  # [EV] by judgment
FAR = 0.4
"""Share of photos whose exposure is anything between those two: few photos are three stops under,
but of those that are the curve shall not be guessed from how photos are usually exposed."""
# Shares; chosen by judgment.
_RESAMPLING = {cv2.INTER_AREA: 0.6, cv2.INTER_LINEAR: 0.2, cv2.INTER_CUBIC: 0.2}


@dataclass(frozen=True, slots=True)
class Shares:
    """Of all photos, those that go through each step.

    Attributes
    ----------
    noisy, mosaic, matrix, denoised, smoothed, blurred, sharpened
        With noise of a sensor, a mosaic, a color matrix, less noise in light, less in encoded
        values, a soft lens, sharpening.
    scaled, jpeg, again
        Stored smaller, as a JPEG, as a JPEG again without a change of size.
    """

    noisy: float
    mosaic: float
    matrix: float
    denoised: float
    smoothed: float
    blurred: float
    sharpened: float
    scaled: float
    jpeg: float
    again: float


# By judgment of what cameras, phones and web sites do; no survey of it is known to us.
FROM_CAMERAS = Shares(0.93, 0.8, 0.75, 0.55, 0.25, 0.35, 0.5, 0.4, 0.88, 0.1)
# Renders, scans and files of raw converters: most went through one step or none, so that a quarter
# of them is untouched; of the photos of cameras it is one in 550.
HARDLY_PROCESSED = Shares(0.8, 0.3, 0.3, 0.12, 0.08, 0.15, 0.12, 0.12, 0.4, 0.03)


def draw_process(generator: np.random.Generator, shares: Shares = FROM_CAMERAS) -> Process:
    """One camera, its settings, and what became of the file."""
    usual, far = generator.normal(0.0, EXPOSURE), generator.uniform(DARKEST, BRIGHTEST)
    stops = float(np.clip(far if generator.random() < FAR else usual, DARKEST, BRIGHTEST))
    gains = np.exp(generator.normal(0.0, 0.08 if generator.random() < 0.7 else 0.2, 3))
    iso = 2.0 ** generator.uniform(-1.0, 6.0)
    small_sensor = 2.0 ** generator.uniform(-2.0, 0.0)
    noisy = generator.random() < shares.noisy
    full_well = FULL_WELL_ISO_100 * small_sensor / iso if noisy else np.inf
    ways = [1.0 - shares.mosaic, 0.625 * shares.mosaic, 0.375 * shares.mosaic]
    mosaic = str(generator.choice(["none", "edge-aware", "bilinear"], p=ways))
    scale = _scale(generator, shares.scaled)
    jpeg = 0 if generator.random() < 1.0 - shares.jpeg else int(generator.integers(80, 99))
    return Process(
        stops=stops,
        gains=gains,
        blur=_some(generator, shares.blurred, 0.4, 1.6),
        full_well=float(full_well),
        read_noise=float(np.exp(generator.uniform(np.log(2.0), np.log(15.0)))) if noisy else 0.0,
        raw_gains=np.array([generator.uniform(1.0, 2.6), 1.0, generator.uniform(1.0, 2.6)]),
        matrix=float(generator.uniform(1.0, 1.8)) if generator.random() < shares.matrix else 1.0,
        mosaic=mosaic if noisy else "none",
        denoise=Denoiser.draw(generator, shares.denoised),
        smooth=Denoiser.draw(generator, shares.smoothed),
        sharpen=_some(generator, shares.sharpened, 0.2, 1.5),
        sharpen_radius=float(generator.uniform(0.5, 1.6)),
        scale=scale,
        resampling=int(generator.choice(list(_RESAMPLING), p=list(_RESAMPLING.values()))),
        jpeg=jpeg,
        sampling=str(generator.choice(list(SAMPLING), p=[0.5, 0.2, 0.3])),
        first_jpeg=_first_jpeg(generator, scale, shares.again),
        sharpen_small=_some(generator, 0.3, 0.2, 0.8) if scale < 1.0 else 0.0,
    )


def _some(generator: np.random.Generator, share: float, low: float, high: float) -> float:
    """Uniform in a share of all photos, 0 in the others."""
    return float(generator.uniform(low, high)) if generator.random() < share else 0.0


def _scale(generator: np.random.Generator, share: float) -> float:
    """A half in one of two that are stored smaller, and anything between in the others."""
    luck = generator.random()
    if luck < 0.5 * share:
        return 0.5
    return float(generator.uniform(0.35, 0.95)) if luck < share else 1.0


def _first_jpeg(generator: np.random.Generator, scale: float, share: float) -> int:
    """Quality of a JPEG that was decoded, mostly to be scaled, before the one that is stored."""
    again = generator.random() < (0.5 if scale < 1.0 else share)
    return int(generator.integers(88, 99)) if again else 0
