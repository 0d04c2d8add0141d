"""Values are valid or refused, and cannot change afterwards."""

from __future__ import annotations

import copy
import pickle
import sys
from dataclasses import FrozenInstanceError, replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from facecrf_ocio.checks import span_colors
from facecrf_ocio.color.primaries import KNOWN_PRIMARIES, known_primaries, name_primaries
from facecrf_ocio.errors import FaceCRFError, NotCalibratedError, PhotoError, SettingsError
from facecrf_ocio.published.gradients import PigmentGradients
from facecrf_ocio.published.pigments import Pigments
from facecrf_ocio.response.model import strictly_increasing
from facecrf_ocio.values import (
    Confidence,
    Estimate,
    Face,
    GainMap,
    InStops,
    InverseCRF,
    Outcome,
    Photo,
    Primaries,
    Verdict,
    frozen,
)

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
    with pytest.raises(PhotoError, match="save it with values from 0 to 1, or as EXR"):
        Photo(encoded=pixels, path=Path("a.jxl"))  # who reads a file has no arguments to pass
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


# --- what a photo is beside its pixels ---


@pytest.mark.parametrize(
    ("alpha", "text"),
    [
        (np.ones((3, 2)), r"alpha of shape \(3, 2\) and type float64 does not fit"),
        (np.ones((2, 3, 1)), "does not fit"),
        (np.ones((2, 3), np.uint8), r"uint8 does not fit pixels of \(2, 3, 3\); give floats"),
        (np.full((2, 3), np.nan), "alpha from nan to nan, outside of 0 to 1"),
        (np.full((2, 3), 1.01), "alpha from 1.01 to 1.01, outside of 0 to 1; scale it"),
        (np.full((2, 3), -0.01), "alpha from -0.01"),
        (np.ma.masked_array(np.ones((2, 3))), "masked array"),
    ],
)
def test_alpha_fits_its_pixels(alpha, text):
    with pytest.raises(PhotoError, match=text):
        Photo(encoded=np.zeros((2, 3, 3), np.float32), alpha=alpha)


@given(arrays(np.float64, (2, 3), elements=st.floats(0, 1)))
def test_alpha_is_kept_as_a_copy_that_no_one_can_change(alpha):
    photo = Photo(encoded=np.zeros((2, 3, 3), np.float32), alpha=alpha)
    before = alpha.astype(np.float32)
    alpha += 1.0
    assert np.array_equal(photo.alpha, before)
    assert not photo.alpha.flags.writeable
    assert photo.alpha.dtype == np.float32


@pytest.mark.parametrize("bits", [0, -8, 33, 8.0, "8", True, np.float32(8)])
def test_a_bit_depth_is_a_number_of_bits(bits):
    with pytest.raises(PhotoError, match="is no bit depth; give the bits of its integer codes"):
        Photo(encoded=np.zeros((1, 1, 3)), bit_depth=bits)


@pytest.mark.parametrize("bits", [None, 1, 8, 10, 16, 32, np.int64(12)])
def test_integer_files_have_up_to_32_bits(bits):
    assert Photo(encoded=np.zeros((1, 1, 3)), bit_depth=bits).bit_depth == bits


def test_a_photo_is_taken_while_another_thread_loads_masked_arrays(monkeypatch):
    monkeypatch.setitem(sys.modules, "numpy.ma", ModuleType("numpy.ma"))  # as it is at first
    assert Photo(np.full((2, 2, 3), 0.5)).encoded.shape == (2, 2, 3)


def test_a_mask_is_not_dropped_without_a_word():
    hidden = np.ma.masked_array(np.full((2, 2, 3), 0.5), mask=True)
    with pytest.raises(PhotoError, match="masked array says nothing of the pixels it hides; fill"):
        Photo(encoded=hidden)


REC709 = ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), (0.3127, 0.329))


@pytest.mark.parametrize("name", KNOWN_PRIMARIES)
def test_known_primaries_span_colors(name):
    assert span_colors(KNOWN_PRIMARIES[name])
    Photo(encoded=np.zeros((1, 1, 3)), primaries=known_primaries(name, "EXIF"))


@pytest.mark.parametrize(
    ("which", "xy"),
    [
        (0, (np.nan, 0.3)),
        (3, (np.inf, 0.3)),
        (0, (0.30, 0.60)),  # red and green alike
        (0, (0.225, 0.33)),  # red between green and blue
        (3, (0.7, 0.3)),  # white outside
        (3, (0.64, 0.33)),  # white is red
        (3, (0.0, 0.0)),
    ],
)
def test_primaries_that_span_no_colors_are_refused(which, xy):
    bad = [*REC709]
    bad[which] = xy
    with pytest.raises(PhotoError, match="primaries and white span no colors; give the CIE xy"):
        Photo(encoded=np.zeros((1, 1, 3)), primaries=Primaries("custom", *bad, "EXIF"))
    assert name_primaries(bad, "file attribute") is None


@given(arrays(float, (4, 2), elements=st.floats(-0.2, 1.2)))
def test_what_spans_colors_has_a_matrix_with_light_of_every_primary(xy):
    if span_colors(xy):
        columns = np.stack([xy[:, 0], xy[:, 1], 1 - xy.sum(axis=1)])
        shares = np.linalg.solve(columns[:, :3], columns[:, 3])
        assert (shares > 0).all()
        assert np.isclose(shares.sum(), 1.0, atol=1e-6)


# --- results ---


@given(arrays(float, (3, 8), elements=st.floats(0, 1)), arrays(float, (3, 5)))
def test_an_estimate_keeps_what_no_one_can_change(numbers, coefficients):
    energy = {"pigment": 1.0}
    stops = InStops(numbers, 0.1, 0.2)
    told = Confidence(numbers, numbers, Verdict.WEAK, (), stops)
    found = Estimate(
        Outcome.CALIBRATED, "face", "", confidence=told, coefficients=coefficients, energy=energy
    )
    before = numbers.copy(), coefficients.copy()
    numbers += 1.0
    coefficients += 1.0
    energy["pigment"] = 2.0
    for kept, first in (
        *((a, before[0]) for a in (told.sigma, told.coverage, stops.sigma)),
        (found.coefficients, before[1]),
    ):
        assert np.array_equal(kept, first, equal_nan=True)
        assert not kept.flags.writeable
    assert found.energy == {"pigment": 1.0}
    with pytest.raises(TypeError):
        found.energy["pigment"] = 3.0  # type: ignore[index]


def test_pigments_keep_what_no_one_can_change():
    numbers, directions = np.ones(4), np.ones((2, 3))
    densities = Pigments(numbers, numbers, directions)
    pairs = PigmentGradients(np.zeros((2, 2), np.intp), np.zeros(2, bool))
    numbers += 1.0
    assert (densities.melanin == 1.0).all()
    for array in (densities.melanin, densities.directions, pairs.pairs, pairs.is_melanin):
        assert not array.flags.writeable


def test_a_gain_map_keeps_what_no_one_can_change():
    given = np.ones(3)
    gain_map = GainMap(np.zeros((2, 2, 3)), 0 * given, given, given, given, given, "Ultra HDR")
    given[:] = 7.0
    for name in ("values", "low", "high", "gamma", "base_offset", "offset"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(gain_map, name)[0] = 2.0
    assert gain_map.high.tolist() == [1.0, 1.0, 1.0]


def test_an_estimate_goes_from_process_to_process():
    found = Estimate(Outcome.CALIBRATED, "face", "", energy={"pigment": 1.0})
    for again in (pickle.loads(pickle.dumps(found)), copy.deepcopy(found), replace(found)):  # noqa: S301
        assert again.energy == {"pigment": 1.0}
        assert again.outcome is Outcome.CALIBRATED


EIGHT = np.random.default_rng(0).integers(0, 256, (40, 30, 3), np.uint8)


def test_a_photo_of_codes_makes_its_encoded_values_when_they_are_asked_for():
    photo = Photo.of_codes(EIGHT, grayscale=False)
    assert (photo.shape, photo.bit_depth) == ((40, 30, 3), 8)
    assert photo.pixels is photo.codes
    assert np.array_equal(photo.encoded, (EIGHT / 255).astype(np.float32))
    assert photo.encoded is photo.encoded
    assert not photo.encoded.flags.writeable
    with pytest.raises(AttributeError, match="nothing"):
        _ = photo.nothing


def test_the_codes_of_a_photo_are_its_own():
    codes = EIGHT.copy()
    photo = Photo.of_codes(codes)
    codes[:] = 0
    assert np.array_equal(photo.codes, EIGHT)


def test_a_photo_with_other_pixels_has_other_codes_or_none():
    photo = Photo.of_codes(EIGHT, edits=("cropped",))
    same = photo.but(grayscale=True)
    assert same.codes is not None
    assert (same.edits, same.grayscale) == (("cropped",), True)
    other = replace(photo, encoded=np.zeros((2, 2, 3), np.float32))
    assert other.codes is None
    assert not other.encoded.any()


def test_a_photo_of_codes_goes_from_process_to_process():
    photo = pickle.loads(pickle.dumps(Photo.of_codes(EIGHT)))  # noqa: S301
    assert np.array_equal(photo.codes, EIGHT)
    assert np.array_equal(photo.encoded, (EIGHT / 255).astype(np.float32))
