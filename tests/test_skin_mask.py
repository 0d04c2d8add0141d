"""Which pixels are skin: hue around the most frequent one, and the middle of the brightness."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from facecrf_ocio.face.skin_mask import BLACK, CLIPPED, find_skin
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import Light, SyntheticSpec, gamma_curve, photograph, render_face

SETTINGS = Settings()


def colored(hue, value, saturation=0.4):
    """(H, W, 3) of hues [degree] and values."""
    hue, value = np.broadcast_arrays(hue, value)
    hsv = np.stack([hue % 360, np.full(hue.shape, saturation), value], axis=2).astype(np.float32)
    return cv2.cvtColor(hsv, cv2.COLOR_HSV2RGB)


def ramp(low=0.3, high=0.7, shape=(60, 60)):
    return np.linspace(low, high, shape[0] * shape[1]).reshape(shape)


def everywhere(image):
    return np.ones(image.shape[:2], bool)


@pytest.mark.parametrize("mode", [0.5, 20.0, 129.0, 215.0, 350.0, 359.5])
def test_hues_within_18_degrees_of_the_most_frequent_one_are_kept(mode):
    """No fixed interval of hues: light may have any color, and hue is a circle."""
    hue = np.full((60, 60), mode)
    hue[:10] = mode + np.linspace(-60, 60, 60)
    image = colored(hue, ramp())
    found = find_skin(image, everywhere(image), SETTINGS)
    distance = np.abs((hue - found.hue_mode + 180) % 360 - 180)
    # A single hue fills three bins of the smoothed histogram alike: the mode is one of them.
    assert abs((found.hue_mode - mode + 180) % 360 - 180) <= 3.01
    assert found.skin[distance < 17.9].all()
    assert not found.skin[distance > 18.1].any()


def test_the_histogram_holds_the_shares_of_all_hues():
    hue = np.where(np.arange(3600).reshape(60, 60) < 900, 100.0, 21.0)
    image = colored(hue, ramp())
    histogram = find_skin(image, everywhere(image), SETTINGS).hue_histogram
    assert histogram.shape == (180,)
    assert histogram.sum() == pytest.approx(1.0)
    assert histogram[48:53].sum() == pytest.approx(0.25)
    assert histogram[9:12].sum() == pytest.approx(0.75)


def test_the_darkest_and_the_brightest_quarter_are_not_diffuse():
    image = colored(20.0, ramp())
    found = find_skin(image, everywhere(image), SETTINGS)
    low, high = np.quantile(ramp(), [0.25, 0.75])
    expected = (ramp() > low) & (ramp() < high)
    assert found.skin.all()
    assert (found.diffuse != expected).mean() < 0.002
    whole = find_skin(image, everywhere(image), replace(SETTINGS, value_low=0.0, value_high=1.0))
    assert whole.diffuse.all()


def test_clipped_black_and_gray_pixels_are_not_skin():
    image = colored(20.0, ramp())
    image[:5, :, 0] = CLIPPED
    image[5:10, :, 2] = BLACK
    image[10:15] = 0.5
    found = find_skin(image, everywhere(image), SETTINGS)
    assert not found.skin[:15].any()
    assert found.skin[15:].all()


def test_nothing_outside_of_the_bare_skin_is_used():
    image = colored(20.0, ramp())
    image[:, :40] = colored(200.0, 0.5 * np.ones((60, 40)))
    bare = np.arange(60) >= 40
    found = find_skin(image, np.tile(bare, (60, 1)), SETTINGS)
    assert found.hue_mode == pytest.approx(20.0, abs=3.01)
    assert not found.skin[:, :40].any()
    assert found.skin[:, 40:].all()


@pytest.mark.parametrize("value", [0.0, 0.5, 1.0])
def test_an_image_without_color_has_no_skin(value):
    image = np.full((20, 20, 3), value, np.float32)
    found = find_skin(image, everywhere(image), SETTINGS)
    assert not found.skin.any()
    assert not found.diffuse.any()
    assert np.isfinite(found.hue_histogram).all()


def test_no_bare_skin_is_no_skin():
    image = colored(20.0, ramp())
    assert not find_skin(image, np.zeros((60, 60), bool), SETTINGS).skin.any()


@pytest.mark.parametrize("color", [(1.0, 1.0, 1.0), (1.0, 0.7, 0.4), (0.7, 0.85, 1.0)])
def test_true_skin_is_kept_under_light_of_any_color(color):
    spec = SyntheticSpec(
        seed=2, ideal=True, lights=(Light(color=color),), height=240, width=200, face_width=120.0
    )
    face = render_face(spec)
    encoded = photograph(face, gamma_curve(2.2)).encoded
    found = find_skin(encoded, np.isfinite(face.normals[..., 2]), SETTINGS)
    usable = face.skin & (encoded.max(axis=2) < CLIPPED) & (encoded.min(axis=2) > BLACK)
    assert found.skin[usable].mean() > 0.90
