"""Portraits made wrong on purpose, and ordinary photos made of the same ones.

Brightness is inverted as editors do, levels are taken away and grain laid over them. Ordinary
photos are denoised, dark, pushed, grainy and stored with loss, too: what tells the one must not
tell the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from facecrf_ocio.joint.face_parts import FaceColors
from facecrf_ocio.synthetic.jpeg import Codes, through_jpeg

LEVELS = (4, 6, 8, 12, 16)
"""Of a poster's channels: of fewer it is told without grain, and of more grain leaves nothing."""
AS_IT_IS = "as it is"
PROCESSED = "denoised, dark, of contrast, stored with loss"
WITH_GRAIN = "with grain"
PUSHED = "pushed in 8 bits"
OF_CONTRAST = "of contrast, without loss"
"""What ordinary photos are, by what was done to them."""
_POSTERS = 3  # of each portrait
_GRAIN = (3.0, 6.0, 9.0)  # [code] deviations: fine, plain, and coarse grain
_QUALITIES = (None, 80, 92)  # of JPEG; none for a file without loss
_SOFT, _SOFTNESS = 0.4, 0.7  # share of grain that is soft, and [px] how soft
_RAISED = 1.9  # what that softness takes from its deviation
_PUSHED = (0.6, 1.6)  # [EV] taken off in 8 bits and put back, which leaves gaps
_CONTRAST = (1.2, 1.7)  # factor about the middle


@dataclass(frozen=True, slots=True)
class FaceLight:
    """What light and camera do to logs of a face's colors; one value of each range is drawn.

    Attributes
    ----------
    saturation
        Factor of differences between channels.
    evened
        Share of the skin's color that the light takes off.
    cast
        Deviation of each channel's gain.
    """

    saturation: tuple[float, float] = (1.0, 1.0)
    evened: tuple[float, float] = (0.0, 0.0)
    cast: float = 0.0

    def on(self, colors: FaceColors, generator: np.random.Generator) -> FaceColors:
        """Colors as they would be in it."""
        kept = generator.uniform(*self.saturation)
        mix = kept * np.eye(3) + (1.0 - kept) / 3.0
        middle = colors.middle @ mix
        skin = middle[0] - middle[0].mean()
        gains = generator.normal(0.0, self.cast, 3) - generator.uniform(*self.evened) * skin
        return FaceColors(middle + gains, mix @ colors.spread @ mix)


# By judgment: half of what is learned from has its color.
LIGHTS = {
    AS_IT_IS: FaceLight(),
    "of a cast": FaceLight(cast=0.1),
    "of less color": FaceLight(saturation=(0.3, 0.6), cast=0.03),
    "in gray light": FaceLight(saturation=(0.6, 1.0), evened=(0.7, 1.0), cast=0.04),
    "in half gray light": FaceLight(evened=(0.3, 0.6), cast=0.03),
}
"""Each a light in which faces are photographed."""


def inverted(codes: Codes, generator: np.random.Generator) -> Iterator[Codes]:
    """A portrait with its luma inverted, and with its lightness, as JPEGs."""
    quality = int(generator.integers(70, 98))
    for there, back in (
        (cv2.COLOR_RGB2YCrCb, cv2.COLOR_YCrCb2RGB),
        (cv2.COLOR_RGB2LAB, cv2.COLOR_LAB2RGB),
    ):
        planes = cv2.cvtColor(codes, there)
        planes[..., 0] = 255 - planes[..., 0]
        yield through_jpeg(np.asarray(cv2.cvtColor(planes, back), np.uint8), quality)


def posters(codes: Codes, generator: np.random.Generator) -> Iterator[tuple[int, Codes]]:
    """Posters of a portrait with grain over them, each with its number of levels."""
    for levels in generator.choice(LEVELS, _POSTERS).tolist():
        steps = _codes(np.rint(codes / 255.0 * (levels - 1)) / (levels - 1) * 255.0)
        yield levels, _stored(with_grain(steps, generator), generator)


def ordinary(codes: Codes, generator: np.random.Generator) -> Iterator[tuple[str, Codes]]:
    """Photos that the same portrait might be, each with what was done to it."""
    yield AS_IT_IS, codes
    processed = (
        lambda: through_jpeg(codes, int(generator.integers(60, 85))),
        lambda: through_jpeg(np.asarray(cv2.bilateralFilter(codes, 9, 30, 5), np.uint8), 88),
        lambda: through_jpeg(_codes(codes * 2.0 ** generator.uniform(-1.6, -0.5)), 90),
        lambda: through_jpeg(_of_contrast(codes, generator), 90),
    )
    for number in generator.choice(len(processed), 2, replace=False).tolist():
        yield PROCESSED, processed[number]()
    for _ in range(2):
        yield WITH_GRAIN, _stored(with_grain(codes, generator), generator)
    stops = generator.uniform(*_PUSHED)
    dark = np.floor(codes * 2.0**-stops)
    yield PUSHED, _stored(_codes(np.floor(dark * 2.0**stops)), generator)
    yield OF_CONTRAST, _of_contrast(codes, generator)


def with_grain(codes: Codes, generator: np.random.Generator) -> Codes:
    """Codes (H, W, 3) with grain of one gray, or one of each channel, sharp or soft."""
    planes = int(generator.choice([1, 3]))
    grain = generator.normal(0.0, generator.choice(_GRAIN), (*codes.shape[:2], planes))
    if generator.random() < _SOFT:
        soft = np.asarray(cv2.GaussianBlur(grain, (0, 0), _SOFTNESS), np.float64)
        grain = _RAISED * soft.reshape(grain.shape)
    return _codes(codes + grain)


def _of_contrast(codes: Codes, generator: np.random.Generator) -> Codes:
    return _codes(np.floor((codes - 128.0) * generator.uniform(*_CONTRAST) + 128.0))


def _stored(codes: Codes, generator: np.random.Generator) -> Codes:
    quality = _QUALITIES[int(generator.integers(len(_QUALITIES)))]
    return codes if quality is None else through_jpeg(codes, quality)


def _codes(values: np.ndarray) -> Codes:
    return np.asarray(np.clip(np.rint(values), 0, 255), np.uint8)
