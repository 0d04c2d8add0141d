"""Values are valid or refused, and cannot change afterwards."""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from facecrf_ocio.errors import FaceCRFError, NotCalibratedError, PhotoError, SettingsError
from facecrf_ocio.response.model import strictly_increasing
from facecrf_ocio.values import Estimate, Face, InverseCRF, Outcome, Photo, Verdict, frozen

CODES = np.linspace(0.0, 1.0, 65)
CURVE = InverseCRF(CODES, CODES ** np.array([[1.8], [2.2], [2.6]]))


# --- Photo ---


@pytest.mark.parametrize("shape", [(4, 4), (4, 4, 4), (4, 4, 1), (0, 4, 3), (4, 0, 3), (3,), ()])
def test_only_three_channels_are_a_photo(shape):
    with pytest.raises(PhotoError, match="is not a photo; give an array of shape"):
        Photo(encoded=np.zeros(shape, np.float32))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.int64, bool])
def test_integers_have_no_known_maximum(dtype):
    with pytest.raises(PhotoError, match=r"no known maximum; divide them by the maximum code"):
        Photo(encoded=np.ones((2, 2, 3), dtype))


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("scene_linear", [True, False])
def test_pixels_must_be_finite(bad, scene_linear):
    pixels = np.full((3, 3, 3), 0.5, np.float32)
    pixels[1, 2, 0] = bad
    with pytest.raises(PhotoError, match="NaN or infinite pixels"):
        Photo(encoded=pixels, scene_linear=scene_linear)


@pytest.mark.parametrize("bad", [-0.01, 1.01, 255.0])
def test_encoded_values_lie_between_0_and_1(bad):
    pixels = np.full((3, 3, 3), 0.5)
    pixels[0, 0, 0] = bad
    with pytest.raises(PhotoError, match=r"outside of 0 to 1; scale them to \[0, 1\], or pass"):
        Photo(encoded=pixels)
    assert Photo(encoded=pixels, scene_linear=True).encoded[0, 0, 0] == np.float32(bad)


def test_an_error_names_its_file():
    with pytest.raises(PhotoError, match=r"^a\.png: ") as caught:
        Photo(encoded=np.zeros((2, 2)), path=Path("a.png"))
    assert caught.value.path == Path("a.png")
    with pytest.raises(PhotoError, match=r"^photo in memory: "):
        Photo(encoded=np.zeros((2, 2)))


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64])
def test_a_photo_keeps_a_copy_that_no_one_can_change(dtype):
    pixels = np.full((2, 2, 3), 0.5, dtype)
    photo = Photo(encoded=pixels)
    pixels[:] = 0.25
    assert photo.encoded.dtype == np.float32
    assert (photo.encoded == 0.5).all()
    with pytest.raises(ValueError, match="read-only"):
        photo.encoded[0, 0, 0] = 1.0
    with pytest.raises(FrozenInstanceError):
        photo.encoded = pixels


# --- InverseCRF ---


@pytest.mark.parametrize(
    ("encoded", "linear", "text"),
    [
        (CODES, np.stack([CODES] * 2), "needs encoded"),
        (CODES, np.stack([CODES[:-1]] * 3), "needs encoded"),
        (CODES[:1], np.ones((3, 1)), "needs encoded"),
        (CODES, np.stack([CODES, CODES, np.where(CODES == 0.5, np.nan, CODES)]), "finite"),
        (CODES, np.stack([CODES, CODES, 0.9 * CODES]), "from \\(0, 0\\) to \\(1, 1\\)"),
        (CODES, np.stack([CODES, CODES, 0.1 + 0.9 * CODES]), "from \\(0, 0\\) to \\(1, 1\\)"),
        (0.5 * CODES, np.stack([CODES] * 3), "from \\(0, 0\\) to \\(1, 1\\)"),
        (CODES, np.stack([CODES, CODES, np.clip(2 * CODES, 0, 1)]), "increase strictly"),
        (np.sort(np.r_[CODES, 0.5]), np.stack([np.linspace(0, 1, 66)] * 3), "increase strictly"),
    ],
)
def test_what_is_not_an_inverse_response_is_refused(encoded, linear, text):
    with pytest.raises(SettingsError, match=text):
        InverseCRF(encoded, linear)


def test_a_curve_keeps_a_copy_that_no_one_can_change():
    linear = np.stack([CODES] * 3)
    curve = InverseCRF(CODES, linear)
    linear[:, 3] = 0.9
    assert curve.linear[0, 3] == CODES[3]
    for array in (curve.linear, curve.encoded):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


@given(arrays(np.float32, (5, 3), elements=st.floats(0, 1, width=32)))
def test_encode_undoes_linearize(encoded):
    assert np.allclose(CURVE.encode(CURVE.linearize(encoded)), encoded, atol=2e-3)
    assert np.allclose(CURVE.linearize(CURVE.encode(encoded)), encoded, atol=1e-6)


@given(
    arrays(float, (3, 20), elements=st.floats(0, 1)),
    arrays(float, (4, 4, 3), elements=st.floats(0, 1)),
)
def test_linearize_interpolates_each_channel_by_its_own_curve(samples, encoded):
    curve = InverseCRF(
        np.linspace(0, 1, 21), strictly_increasing(np.pad(samples, ((0, 0), (0, 1))))
    )
    found = curve.linearize(encoded)
    assert found.dtype == np.float32
    for c in range(3):
        expected = np.interp(encoded[..., c], curve.encoded, curve.linear[c])
        assert np.allclose(found[..., c], expected, atol=1e-6)


def test_linearize_clamps_as_ocio_does():
    assert (CURVE.linearize([[-1.0, 0.0, -0.1], [1.5, 1.0, 9.0]]) == [[0.0] * 3, [1.0] * 3]).all()


@pytest.mark.parametrize("shape", [(4,), (3, 4), ()])
def test_linearize_wants_three_channels(shape):
    with pytest.raises(SettingsError, match="expected"):
        CURVE.linearize(np.zeros(shape))


# --- the others ---


@given(arrays(float, (4,), elements=st.floats(-9, 9)))
def test_frozen_copies_what_could_still_be_written_to(array):
    result = frozen(array)
    before = result.copy()
    array += 1.0
    assert np.array_equal(result, before)
    assert not result.flags.writeable
    assert frozen(result) is result


def test_a_face_keeps_copies():
    box, landmarks = np.zeros(4), np.zeros((478, 3))
    face = Face(box, landmarks, 0.9)
    box += 1
    landmarks += 1
    assert not face.box_xy.any()
    assert not face.landmarks_xyz.any()


def test_an_estimate_without_a_curve_says_why_when_it_is_asked_for_one():
    estimate = Estimate(Outcome.NOT_CALIBRATED, "face", "no face found", "use another photo")
    with pytest.raises(NotCalibratedError, match="no curve: no face found; use another photo"):
        _ = estimate.curve
    assert issubclass(NotCalibratedError, FaceCRFError)


def test_words_print_as_words():
    assert f"{Outcome.CALIBRATED} {Verdict.PRIOR_ONLY}" == "calibrated prior only"
