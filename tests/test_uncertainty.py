"""`--uncertainty`: a channel beside the colors that says how far the curve may be off."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import OpenImageIO as oiio  # noqa: N813
import pytest
from click.testing import CliRunner
from matplotlib import cbook

from facecrf_ocio import Photo, SettingsError, calibrate
from facecrf_ocio.cli.facecrf import main
from facecrf_ocio.image.linearize import write_linear
from facecrf_ocio.image.uncertainty import CHANNEL
from facecrf_ocio.values import Estimate

CODES = np.random.default_rng(0).integers(0, 256, (300, 40, 3))


@pytest.fixture
def photo() -> Photo:
    return Photo(encoded=(CODES / np.float32(255)).astype(np.float32), bit_depth=8)


@pytest.fixture
def estimate(photo: Photo) -> Estimate:
    return calibrate(photo, estimator="mean")


def expected(photo: Photo, estimate: Estimate) -> np.ndarray:
    """By brute force, channel by channel."""
    assert estimate.confidence is not None
    encoded, sigma = estimate.curve.encoded, estimate.confidence.sigma
    each = [np.interp(photo.encoded[..., c], encoded, sigma[c]) for c in range(3)]
    return np.sqrt(np.mean(np.square(each), axis=0))


def channels(path: Path) -> dict[str, np.ndarray]:
    image = oiio.ImageBuf(str(path))
    pixels = image.get_pixels(oiio.FLOAT)
    return {name: pixels[..., n] for n, name in enumerate(image.spec().channelnames)}


def test_each_pixel_has_the_deviation_of_its_codes(photo, estimate, tmp_path):
    plain = channels(write_linear(tmp_path / "a.exr", photo, estimate, half=False).path)
    path = write_linear(tmp_path / "b.exr", photo, estimate, half=False, uncertainty=True).path
    found = channels(path)
    assert list(found) == ["R", "G", "B", CHANNEL]
    assert all(np.array_equal(found[name], plain[name]) for name in "RGB")
    np.testing.assert_allclose(found[CHANNEL], expected(photo, estimate), rtol=1e-5, atol=1e-7)
    assert found[CHANNEL].std() > 0.01
    with OpenEXR.File(str(path), separate_channels=True) as theirs:
        assert np.array_equal(theirs.channels()[CHANNEL].pixels, found[CHANNEL])


def test_it_is_scaled_as_the_light_is_and_multiplied_by_alpha(photo, estimate, tmp_path):
    clear = replace(photo, alpha=np.linspace(0, 1, CODES[..., 0].size).reshape(300, 40))
    path = write_linear(tmp_path / "a.exr", clear, estimate, exposure="2", uncertainty=True).path
    found = channels(path)
    assert list(found) == ["R", "G", "B", "A", CHANNEL]
    wanted = 4.0 * expected(photo, estimate) * clear.alpha
    np.testing.assert_allclose(found[CHANNEL], wanted, rtol=2e-3, atol=1e-4)


def test_half_floats_hold_it_too(photo, estimate, tmp_path):
    found = channels(write_linear(tmp_path / "a.exr", photo, estimate, uncertainty=True).path)
    np.testing.assert_allclose(found[CHANNEL], expected(photo, estimate), rtol=1e-3, atol=1e-6)


def test_a_photo_without_a_curve_has_none(estimate, tmp_path):
    light = Photo(encoded=np.ones((8, 8, 3), np.float32), scene_linear=True)
    with pytest.raises(SettingsError, match="the photo is scene-linear; leave it out"):
        write_linear(tmp_path / "a.exr", light, estimate, uncertainty=True)
    with pytest.raises(SettingsError, match="the photo was not estimated"):
        write_linear(tmp_path / "a.exr", Photo(encoded=light.encoded * np.float32(0.5)),
                     replace(estimate, confidence=None), uncertainty=True)  # fmt: skip
    assert not list(tmp_path.iterdir())


def test_the_command(tmp_path):
    with cbook.get_sample_data("grace_hopper.jpg", asfileobj=True) as portrait:
        photo = tmp_path / "a.jpg"
        photo.write_bytes(portrait.read())
    target = tmp_path / "a.exr"
    ended = CliRunner().invoke(main, ["linearize", str(photo), "-o", str(target), "--uncertainty"])
    assert ended.exit_code == 0, ended.output
    sigma = channels(target)[CHANNEL]
    assert 0.0 <= sigma.min() < 0.01 < sigma.max() < 0.5
    refused = CliRunner().invoke(
        main,
        ["linearize", str(photo), "-o", str(tmp_path / "b.exr"), "--hdr", "map", "--uncertainty"],
    )
    assert refused.exit_code != 0
