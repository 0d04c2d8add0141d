"""Posters, palettes and drawings, and JPEGs of them, are told from photos by their histogram."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from face_photos import grace_hopper
from PIL import Image

from facecrf_ocio import Photo, calibrate
from facecrf_ocio.joint.few_levels import few_levels, roughness
from facecrf_ocio.settings import JointSettings
from facecrf_ocio.synthetic.jpeg import through_jpeg
from facecrf_ocio.values import Lacking, Outcome, Verdict

DEFAULTS = JointSettings()
FACE = np.array([183.0, 120.0, 170.0, 212.0])
CODES = np.rint(grace_hopper() * 255).astype(np.uint8)


def poster(levels: int) -> np.ndarray:
    steps = np.rint(np.arange(256) / 255 * (levels - 1)) / (levels - 1) * 255
    return np.rint(steps).astype(np.uint8)[CODES]


def palette(colors: int, dither: Image.Dither = Image.Dither.NONE) -> np.ndarray:
    picture = Image.fromarray(CODES)
    own = picture.quantize(colors)
    return np.array(picture.quantize(colors, palette=own, dither=dither).convert("RGB"))


def cartoon() -> np.ndarray:
    smooth = cv2.bilateralFilter(cv2.bilateralFilter(CODES, 9, 60, 7), 9, 60, 7)
    return (smooth // 32) * 32 + 16


MADE = {
    "poster of 4": lambda: poster(4),
    "poster of 8": lambda: poster(8),
    "poster of 16": lambda: poster(16),
    "8 colors": lambda: palette(8),
    "16 colors": lambda: palette(16),
    "16 colors, dithered": lambda: palette(16, Image.Dither.FLOYDSTEINBERG),
    "cartoon": cartoon,
}


def says(codes: np.ndarray) -> Lacking | str:
    return few_levels(codes, FACE, DEFAULTS)


# The grain of her photo, posterized and stored with loss, is nearly smooth again.
BLURRED = [("poster of 16", 92), ("poster of 16", 80), ("poster of 8", 80), ("poster of 4", 80)]


@pytest.mark.parametrize(
    ("name", "quality"),
    [(name, q) for name in MADE for q in (None, 92, 80) if (name, q) not in BLURRED],
)
def test_what_was_made_with_few_levels_is_told(name: str, quality: int | None) -> None:
    made = MADE[name]()
    found = says(made if quality is None else through_jpeg(made, quality, "4:2:0"))
    told = found.reason if isinstance(found, Lacking) else found
    assert "brightness keeps to few levels" in told
    assert isinstance(found, Lacking) or quality is not None


def brighter(stops: float) -> np.ndarray:
    return np.clip(CODES * 2.0**stops, 0, 255).astype(np.uint8)


ORDINARY = {
    "as it is": lambda: CODES,
    "a third as bright": lambda: brighter(-1.6),
    "pushed, which leaves gaps": lambda: np.clip(brighter(-1.6) * 2.7, 0, 255).astype(np.uint8),
    "of more contrast": lambda: np.clip((CODES - 128.0) * 1.6 + 128, 0, 255).astype(np.uint8),
    "smoothed": lambda: cv2.bilateralFilter(CODES, 9, 30, 5),
    "of a palette of brightness as fine as codes": lambda: poster(256),
    "black": lambda: np.zeros_like(CODES),
}


@pytest.mark.parametrize("quality", [None, 90, 70])
@pytest.mark.parametrize("name", ORDINARY)
def test_photos_have_all_levels(name: str, quality: int | None) -> None:
    picture = ORDINARY[name]()
    assert says(picture if quality is None else through_jpeg(picture, quality, "4:2:0")) == ""


def test_the_size_of_values_and_of_the_face_does_not_matter() -> None:
    large = cv2.resize(poster(8), None, fx=6, fy=6, interpolation=cv2.INTER_NEAREST)
    assert isinstance(few_levels(large, 6 * FACE, DEFAULTS), Lacking)
    floats = np.float32(poster(8)) / np.float32(255)
    assert isinstance(few_levels(floats, FACE, DEFAULTS), Lacking)
    beyond = np.array([400.0, 500.0, 300.0, 300.0])
    assert few_levels(CODES, beyond, DEFAULTS) == ""


def test_a_ramp_is_smooth_and_a_staircase_is_not() -> None:
    ramp = np.tile(np.linspace(20, 220, 400), (100, 1))
    for steps, low, high in ((1, 0.0, 0.05), (8, 0.5, 2.0), (25, 1.0, 2.0)):
        codes = (ramp // steps * steps).astype(np.uint8)
        assert low <= roughness(np.dstack([codes] * 3)) <= high


def test_calibrate_refuses_a_poster_and_doubts_what_may_be_one() -> None:
    refused = calibrate(Photo.of_codes(poster(12)))
    assert refused.outcome is Outcome.NOT_CALIBRATED
    assert "few levels, as in a poster" in refused.reason
    assert refused.remedy
    codes = through_jpeg(palette(16, Image.Dither.FLOYDSTEINBERG), 80, "4:2:0")
    told = calibrate(Photo.of_codes(codes)).confidence
    assert told is not None
    assert told.verdict is not Verdict.RELIABLE
    assert any("perhaps no single curve: its brightness keeps to few" in d for d in told.doubts)


def with_grain(codes: np.ndarray, deviation: float) -> np.ndarray:
    grain = np.random.default_rng(0).normal(0.0, deviation, codes.shape)
    return np.clip(np.rint(codes + grain), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("deviation", [3, 6, 9])
@pytest.mark.parametrize("quality", [None, 92, 80])
@pytest.mark.parametrize("levels", [4, 6, 8])
def test_grain_hides_no_poster(levels: int, quality: int | None, deviation: float) -> None:
    made = with_grain(poster(levels), deviation)
    assert says(made if quality is None else through_jpeg(made, quality, "4:2:0"))


@pytest.mark.parametrize("deviation", [1, 3, 6, 9, 15])
@pytest.mark.parametrize("quality", [None, 92, 80])
def test_grain_makes_no_poster(quality: int | None, deviation: float) -> None:
    grainy = with_grain(CODES, deviation)
    assert says(grainy if quality is None else through_jpeg(grainy, quality, "4:2:0")) == ""
