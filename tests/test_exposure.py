"""Exposure: a factor on light, told in the file, by stops or by the mean of the picture."""

from __future__ import annotations

import matplotlib.cbook
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from command_line import CommandLine, write_noise

from facecrf_ocio import Photo, PhotoError, SettingsError, calibrate, read_photo
from facecrf_ocio.color.srgb import encode_srgb
from facecrf_ocio.image.exposure import USUAL, find_exposure
from facecrf_ocio.image.linearize import write_linear
from facecrf_ocio.synthetic.skin_layers import TONES

CHEEKS = (np.s_[235:255, 195:212], np.s_[235:255, 305:325])  # found by eye in the portrait


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
    plain, nothing = read(write_linear(tmp_path / "a.exr", photo, estimate, half=False).path)
    brighter, told = read(
        write_linear(tmp_path / "b.exr", photo, estimate, half=False, exposure="1.5").path
    )
    assert nothing is None
    assert told == "+1.500 stops (1.5)"
    np.testing.assert_allclose(brighter, plain * 2**1.5, rtol=1e-6)


def test_gray_brings_the_geometric_mean_to_middle_gray(photo, estimate, tmp_path):
    pixels, told = read(write_linear(tmp_path / "a.exr", photo, estimate, exposure="gray").path)
    luminance = pixels[..., :3] @ (0.2126, 0.7152, 0.0722)
    assert np.exp(np.log(luminance).mean()) == pytest.approx(0.18, rel=0.05)
    assert told.endswith("(gray)")


def test_black_has_an_exposure_too(estimate):
    black = Photo(encoded=np.zeros((8, 8, 3), np.float32))
    assert np.isfinite(find_exposure("gray", black, estimate.curve).stops)


def test_usual_skin_is_the_skin_that_renders_are_painted_with():
    luminance = TONES @ (0.2126, 0.7152, 0.0722)
    assert tuple(USUAL.values()) == pytest.approx(luminance, rel=0.03)


@pytest.fixture(scope="module")
def portrait():
    return read_photo(matplotlib.cbook.get_sample_data("grace_hopper.jpg", asfileobj=False))


def cheek_in(pixels):
    """Median luminance of a patch of the brighter cheek."""
    return max(float(np.median(pixels[c] @ (0.2126, 0.7152, 0.0722))) for c in CHEEKS)


def test_a_cheek_gets_the_reflectance_of_its_tone(portrait, tmp_path):
    estimate = calibrate(portrait, estimator="srgb")
    for tone, usual in USUAL.items():
        path = tmp_path / f"{tone}.exr"
        written = write_linear(path, portrait, estimate, half=False, exposure=f"skin:{tone}")
        pixels, told = read(written.path)
        assert cheek_in(pixels[..., :3]) == pytest.approx(usual, rel=0.15)
        assert f"(skin:{tone}: a cheek of" in told


def test_half_of_a_judged_tone_may_be_the_exposure(portrait):
    """A stop less light on all of it: half a stop is put down to darker skin."""
    curve = calibrate(portrait, estimator="srgb").curve
    found = find_exposure("skin", portrait, curve)
    darker = Photo(encoded=encode_srgb(curve.linearize(portrait.encoded) * 0.5).astype(np.float32))
    assert find_exposure("skin", darker, curve).stops == pytest.approx(found.stops + 0.5, abs=0.05)
    low, high = (find_exposure(f"skin:{t}", portrait, curve).stops for t in ("dark", "fair"))
    assert low <= found.stops <= high


def test_a_face_that_is_known_is_not_sought_again(portrait, monkeypatch):
    estimate = calibrate(portrait)
    sought = find_exposure("skin", portrait, estimate.curve)
    monkeypatch.setattr("facecrf_ocio.image.cheek.find_faces", None)
    known = find_exposure("skin", portrait, estimate.curve, estimate.faces)
    assert known.stops == pytest.approx(sought.stops, abs=0.02)


def test_without_a_face_there_is_no_skin_to_expose_for(photo, estimate):
    with pytest.raises(PhotoError, match="no cheek to expose for is in view; expose by gray"):
        find_exposure("skin", photo, estimate.curve)


@pytest.mark.parametrize("wrong", ["bright", "nan", "inf", "17", "", "skin:blue", "gray:dark"])
def test_anything_else_is_refused(wrong, photo, estimate):
    with pytest.raises(SettingsError, match="give stops from -16 to 16, gray, skin, or"):
        find_exposure(wrong, photo, estimate.curve)


@pytest.mark.parametrize("exposure", ["gray", "skin"])
def test_a_batch_exposes_each_exr_or_leaves_no_half_result(capfd, tmp_path, exposure):
    (tmp_path / "photos").mkdir()
    write_noise(tmp_path / "photos" / "a.png", seed=1)
    output = tmp_path / "luts"
    options = ("--estimator", "mean", "--formats", "cube", "--jobs", "1", "--exr")
    run = ("batch", tmp_path / "photos", "-o", output, *options, "--exposure", exposure)
    ended = CommandLine(capfd)(*run)
    if exposure == "gray":
        assert ended.code == 0
        assert read(output / "a.png.exr")[1].endswith("stops (gray)")
    else:
        assert ended.code == 3
        assert "no cheek to expose for is in view; expose by gray" in ended.err
        assert not list(output.glob("a.png.*"))


@pytest.mark.parametrize(
    "options",
    [("--exposure", "gray"), ("--exr", "--exposure", "bright"), ("--compression", "piz")],
)
def test_a_batch_says_at_once_what_of_exrs_it_cannot_do(capfd, tmp_path, options):
    (tmp_path / "photos").mkdir()
    write_noise(tmp_path / "photos" / "a.png", seed=1)
    ended = CommandLine(capfd)("batch", tmp_path / "photos", "-o", tmp_path / "luts", *options)
    assert ended.code == 2
    assert not (tmp_path / "luts").exists()
