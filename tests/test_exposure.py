"""Exposure: a factor on light, told in the file, by stops or by the mean of the picture."""

from __future__ import annotations

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest

from facecrf_ocio import Photo, SettingsError, calibrate
from facecrf_ocio.image.exposure import exposure_stops
from facecrf_ocio.image.linearize import write_linear


@pytest.fixture
def photo():
    return Photo(encoded=np.random.default_rng(0).uniform(0.2, 0.7, (64, 80, 3)).astype(np.float32))


@pytest.fixture
def estimate(photo):
    return calibrate(photo, estimator="srgb")


def read(path):
    image = oiio.ImageBuf(str(path))
    return image.get_pixels(oiio.FLOAT), image.spec().getattribute("facecrf:exposure")


def test_stops_scale_the_light_and_are_told(photo, estimate, tmp_path):
    plain, nothing = read(write_linear(tmp_path / "a.exr", photo, estimate, half=False))
    brighter, told = read(
        write_linear(tmp_path / "b.exr", photo, estimate, half=False, exposure="1.5")
    )
    assert nothing is None
    assert told == "+1.500 stops (1.5)"
    np.testing.assert_allclose(brighter, plain * 2**1.5, rtol=1e-6)


def test_gray_brings_the_geometric_mean_to_middle_gray(photo, estimate, tmp_path):
    pixels, told = read(write_linear(tmp_path / "a.exr", photo, estimate, exposure="gray"))
    luminance = pixels[..., :3] @ (0.2126, 0.7152, 0.0722)
    assert np.exp(np.log(luminance).mean()) == pytest.approx(0.18, rel=0.05)
    assert told.endswith("(gray)")


def test_black_has_an_exposure_too(estimate):
    black = Photo(encoded=np.zeros((8, 8, 3), np.float32))
    assert np.isfinite(exposure_stops("gray", black, estimate.curve))


@pytest.mark.parametrize("wrong", ["bright", "nan", "inf", "17", ""])
def test_anything_else_is_refused(wrong, photo, estimate):
    with pytest.raises(SettingsError, match="give stops from -16 to 16, or gray"):
        exposure_stops(wrong, photo, estimate.curve)
