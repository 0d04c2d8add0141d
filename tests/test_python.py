"""The Python interface as a notebook's author meets it."""

from __future__ import annotations

import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from PIL import Image

from facecrf_ocio import (
    InverseCRF,
    LutError,
    Outcome,
    Photo,
    PhotoError,
    SettingsError,
    calibrate,
    calibrate_together,
    linearize_photo,
    read_curve,
    read_photo,
)
from facecrf_ocio.record.calibration_record import write_record
from facecrf_ocio.settings import Settings

CODES = np.linspace(0.0, 1.0, 256)
CURVE = InverseCRF(CODES, np.tile(CODES**2, (3, 1)))


@pytest.mark.parametrize(("kind", "maximum"), [(np.uint8, 255), (np.uint16, 65535)])
def test_integers_are_code_values(kind, maximum):
    codes = np.array([[0, maximum // 2, maximum]], kind)
    expected = CURVE.linearize(codes / maximum)
    np.testing.assert_allclose(CURVE.linearize(codes), expected, rtol=1e-6)


def test_integers_without_a_known_maximum_are_refused():
    with pytest.raises(SettingsError, match="int64 have no known maximum"):
        CURVE.linearize(np.array([[1, 2, 3]]))


def test_floats_that_were_not_divided_are_refused():
    with pytest.raises(SettingsError, match=r"up to 255 are not in \[0, 1\]; divide them"):
        CURVE.linearize(np.array([[0.0, 3.0, 255.0]]))
    np.testing.assert_allclose(CURVE.linearize([[-0.5, 0.5, 1.5]]), [[0, 0.25, 1]], atol=1e-5)


@pytest.mark.parametrize("what", [7, None, [0.5, 0.5]])
def test_what_is_no_photo_is_told_with_what_is(what):
    for call in (calibrate, lambda given: calibrate_together([given])):
        with pytest.raises(PhotoError, match="give a Photo, a path, or an array"):
            call(what)


def test_no_photos_at_all_are_told():
    with pytest.raises(SettingsError, match="no photos to calibrate together; give at least one"):
        calibrate_together([])


def test_a_photo_given_for_a_record_is_told_in_a_few_words(tmp_path):
    Image.fromarray(np.full((9, 9, 3), 200, np.uint8)).save(tmp_path / "a.jpg")
    with pytest.raises(LutError, match=r"is no record of facecrf; name a \.crf\.json$"):
        read_curve(tmp_path / "a.jpg")


def test_a_lut_given_for_a_record_is_told_in_a_few_words(tmp_path):
    (tmp_path / "a.spi1d").write_text("Version 1\nFrom 0.0 1.0\n")
    with pytest.raises(LutError, match=r"is no record of facecrf; name a \.crf\.json$"):
        read_curve(tmp_path / "a.spi1d")


def test_photos_taken_together_may_be_paths_and_arrays(tmp_path):
    codes = np.random.default_rng(0).integers(0, 256, (80, 90, 3)).astype(np.uint8)
    path = tmp_path / "a.png"
    Image.fromarray(codes).save(path)
    together = calibrate_together([path, str(path), codes, read_photo(path)])
    assert len(together.lacking) == 4


def test_a_photo_may_be_a_path_or_an_array(tmp_path):
    codes = np.random.default_rng(0).integers(0, 256, (40, 50, 3)).astype(np.uint8)
    path = tmp_path / "a.png"
    Image.fromarray(codes).save(path)
    found = [
        calibrate(given, estimator="srgb").curve.linear
        for given in (path, str(path), codes, codes / 255.0, read_photo(path))
    ]
    assert all((curve == found[0]).all() for curve in found)
    assert calibrate(codes).outcome is Outcome.NOT_CALIBRATED


def test_what_is_shown_is_short():
    photo = Photo(encoded=np.full((20, 30, 3), 0.5, np.float32), bit_depth=8)
    estimate = calibrate(photo, estimator="srgb")
    shown = [repr(each) for each in (photo, estimate, estimate.curve, estimate.confidence)]
    assert max(map(len, shown)) < 140
    assert shown[1].startswith("<Estimate by srgb: fallback (prior only, ")
    assert shown[0] == "<Photo in memory: 30 x 20, 8 bits>"
    assert "0.5 -> 0.214" in shown[2]


def test_one_call_from_a_photo_to_an_exr(tmp_path):
    codes = np.random.default_rng(0).integers(0, 256, (40, 50, 3)).astype(np.uint8)
    path, exr = tmp_path / "a.png", tmp_path / "a.exr"
    Image.fromarray(codes).save(path)
    estimate = linearize_photo(path, exr, estimator="srgb", half=False)
    pixels = oiio.ImageBuf(str(exr)).get_pixels(oiio.FLOAT)
    np.testing.assert_allclose(pixels, estimate.curve.linearize(codes), atol=1e-6)


def test_a_curve_comes_back_from_its_record(tmp_path):
    photo = Photo(encoded=np.full((20, 30, 3), 0.5, np.float32))
    estimate = calibrate(photo, estimator="gamma22")
    record = write_record(tmp_path / "a.crf.json", photo, estimate, Settings())
    assert (read_curve(record).linear == estimate.curve.linear).all()
    nothing = write_record(tmp_path / "b.crf.json", photo, calibrate(photo), Settings())
    with pytest.raises(LutError, match="holds no curve"):
        read_curve(nothing)
