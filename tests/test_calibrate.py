"""From a photo to an estimate: what every outcome holds, and the example of the README."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from skin_truth import SPECS

from facecrf_ocio import Photo, calibrate, write_lut
from facecrf_ocio.errors import NotCalibratedError, SettingsError
from facecrf_ocio.estimators import ESTIMATOR_NAMES, FALLBACKS, FIXED_CURVES
from facecrf_ocio.face.view import cut_face
from facecrf_ocio.published.face_estimator import analyze_face
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import CURVE_SIZE, dorf_model
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import SyntheticSpec, gamma_curve, photograph, render_face
from facecrf_ocio.values import Estimate, InverseCRF, Outcome, Primaries, Verdict

MODEL = dorf_model()
CODES = np.linspace(0.0, 1.0, CURVE_SIZE)


@pytest.fixture(scope="module")
def portrait():
    spec = replace(SPECS[1], height=320, width=260, face_width=160.0)
    return photograph(render_face(spec), gamma_curve(2.2))


@pytest.fixture(scope="module")
def estimate(portrait):
    return calibrate(portrait, estimator="face")


@pytest.fixture(scope="module")
def again(portrait):
    """The same pixels in another array, the estimator by its name, with an unneeded fallback."""
    return calibrate(Photo(encoded=portrait.encoded.copy()), estimator="face", fallback="srgb")


def blank(value=0.5):
    return Photo(encoded=np.full((120, 100, 3), value, np.float32))


def check_is_whole(found: Estimate):
    """What holds for every estimate with a curve."""
    assert isinstance(found.curve, InverseCRF)
    assert found.curve.encoded.shape == (CURVE_SIZE,)
    assert found.confidence is not None
    assert found.confidence.sigma.shape == (3, CURVE_SIZE)
    assert found.confidence.coverage.shape == (3, CURVE_SIZE)
    assert np.isfinite(found.confidence.sigma).all()
    assert (found.confidence.sigma >= 0).all()
    assert ((found.confidence.coverage >= 0) & (found.confidence.coverage <= 1)).all()
    assert found.reason
    assert any("exposure" in a for a in found.assumptions)
    assert any("primaries" in a for a in found.assumptions)


# --- a photo with a face ---


def test_the_snippet_of_the_readme(portrait, tmp_path):
    array_h_w_3_float, photo = portrait.encoded, portrait
    estimate = calibrate(Photo(encoded=array_h_w_3_float))
    estimate = calibrate(photo, estimator="face-unshaded")
    estimate.outcome, estimate.confidence, estimate.curve.encoded, estimate.curve.linear  # noqa: B018
    linear = estimate.curve.linearize(photo.encoded)
    write_lut(estimate.curve, tmp_path / "a.spi1d")

    k = estimate.curve.encoded.size
    assert estimate.curve.linear.shape == (3, k)
    assert (linear.shape, linear.dtype) == (photo.encoded.shape, np.float32)
    assert np.isfinite(linear).all()
    text = (tmp_path / "a.spi1d").read_text()
    table = np.array(text[text.index("{") + 1 : text.index("}")].split(), float)
    assert np.allclose(table.reshape(k, 3).T, estimate.curve.linear, atol=1e-6)


def test_a_portrait_is_calibrated(estimate):
    check_is_whole(estimate)
    assert estimate.outcome is Outcome.CALIBRATED
    assert estimate.estimator == "face"
    assert estimate.coefficients.shape == (3, 5)
    assert len(estimate.faces) == 1
    assert "1 face" in estimate.reason
    assert {"empirical", "monotonicity", "pigment"} <= set(estimate.energy)


def test_the_curve_is_that_of_the_coefficients(estimate):
    again = MODEL.inverse_crf(MODEL.samples(estimate.coefficients))
    assert np.array_equal(again.linear, estimate.curve.linear)


def test_unshaded_is_another_answer(portrait, estimate):
    unshaded = calibrate(portrait, estimator="face-unshaded")
    assert unshaded.estimator == "face-unshaded"
    assert np.abs(unshaded.curve.linear - estimate.curve.linear).max() > 1e-4


def test_the_same_photo_gives_the_same_curve(estimate, again):
    assert np.array_equal(again.curve.linear, estimate.curve.linear)
    assert dict(again.energy) == dict(estimate.energy)


def test_a_shared_curve_is_one_curve(portrait, estimate):
    shared = calibrate(
        portrait, estimator="face", settings=Settings(shared_curve=True)
    ).curve.linear
    assert (shared == shared[0]).all()
    apart = estimate.curve.linear
    assert np.abs(apart[0] - apart[2]).max() > 1e-4


def test_settings_reach_the_estimator(portrait):
    found = calibrate(portrait, estimator="face", settings=Settings(min_pairs=100_000))
    assert found.outcome is Outcome.NOT_CALIBRATED


def test_primaries_are_told_or_assumed(portrait):
    p3 = Primaries("Display P3", (0.68, 0.32), (0.265, 0.69), (0.15, 0.06), (0.3127, 0.329), "EXIF")
    told = calibrate(replace(portrait, primaries=p3), estimator="mean")
    assert "primaries are Display P3, from the EXIF" in told.assumptions
    assumed = calibrate(portrait, estimator="mean")
    assert any("taken as Rec.709" in a for a in assumed.assumptions)


@pytest.mark.slow
def test_all_faces_of_the_photo_are_used_together():
    small = [replace(s, height=360, width=300, face_width=180.0) for s in SPECS[:2]]
    halves = [photograph(render_face(s), gamma_curve(2.2)).encoded for s in small]
    photo = Photo(encoded=np.concatenate(halves, axis=1))
    found = calibrate(photo, estimator="face")
    settings = Settings()
    pairs = [analyze_face(cut_face(photo, f, settings), settings) for f in found.faces]
    melanin = sum(int(a.gradients.is_melanin.sum()) for a in pairs)
    both = sum(len(a.gradients.pairs) for a in pairs)
    assert len(found.faces) == 2
    assert f"2 faces, {melanin} melanin and {both - melanin} hemoglobin pairs" in found.reason
    assert sorted(f.box_xy[0] > 300 for f in found.faces) == [False, True]


# --- photos without evidence ---


@pytest.mark.parametrize("value", [0.0, 0.5, 1.0])
def test_a_blank_photo_is_an_outcome_with_a_remedy(value):
    found = calibrate(blank(value))
    assert found.outcome is Outcome.NOT_CALIBRATED
    assert found.found is None
    assert found.confidence is None
    assert found.remedy


def test_a_photo_of_one_pixel_is_an_outcome():
    photo = Photo(encoded=np.full((1, 1, 3), 0.5, np.float32))
    assert calibrate(photo).outcome is Outcome.NOT_CALIBRATED


def test_noise_is_an_outcome():
    noise = np.random.default_rng(0).uniform(0, 1, (200, 200, 3)).astype(np.float32)
    assert calibrate(Photo(encoded=noise)).outcome is Outcome.NOT_CALIBRATED


def test_a_grayscale_photo_is_an_outcome(portrait):
    found = calibrate(replace(portrait, grayscale=True))
    assert found.outcome is Outcome.NOT_CALIBRATED
    assert "grayscale" in found.reason


def test_asking_for_the_curve_that_is_not_there_says_what_to_do():
    with pytest.raises(
        NotCalibratedError, match="no curve: no face found; use a photo with a face"
    ):
        _ = calibrate(blank()).curve


@pytest.mark.parametrize("name", [f for f in FALLBACKS if f != "none"])
def test_a_fallback_is_called_one(name):
    found = calibrate(blank(), fallback=name)
    check_is_whole(found)
    assert found.outcome is Outcome.FALLBACK
    assert found.estimator == name
    assert found.confidence.verdict is Verdict.PRIOR_ONLY
    assert not found.confidence.coverage.any()
    assert "no face found" in found.reason
    assert f"fell back to the {name} curve" in found.reason
    assert found.remedy
    assert np.allclose(found.curve.linear, fixed_curve(name, CODES, MODEL), atol=1e-6)


def test_a_fallback_is_not_used_where_there_is_evidence(again):
    assert again.outcome is Outcome.CALIBRATED


# --- curves that need no evidence ---


@pytest.mark.parametrize("name", FIXED_CURVES)
def test_a_fixed_curve_does_not_look_at_the_photo(name, portrait):
    found, other = calibrate(portrait, estimator=name), calibrate(blank(), estimator=name)
    check_is_whole(found)
    assert found.estimator == name
    assert np.allclose(found.curve.linear, fixed_curve(name, CODES, MODEL), atol=1e-6)
    assert np.array_equal(found.curve.linear, other.curve.linear)
    assert found.outcome is Outcome.FALLBACK


@pytest.mark.parametrize("name", ESTIMATOR_NAMES)
def test_what_is_linear_already_stays_as_it_is(name):
    photo = Photo(np.full((4, 4, 3), 3.5, np.float32), scene_linear=True)
    found = calibrate(photo, estimator=name)
    check_is_whole(found)
    assert found.outcome is Outcome.ALREADY_LINEAR
    assert "linear already" in found.reason
    assert np.array_equal(found.curve.linear, np.tile(found.curve.encoded, (3, 1)))


# --- wrong questions ---


def test_unknown_estimators_and_fallbacks_are_refused_with_those_that_are_known():
    with pytest.raises(SettingsError, match="no estimator 'magic'; known: auto, joint"):
        calibrate(blank(), estimator="magic")
    with pytest.raises(SettingsError, match="no fallback 'gamma'; known: none, mean, srgb"):
        calibrate(blank(), fallback="gamma")
    linear = Photo(np.ones((2, 2, 3), np.float32), scene_linear=True)
    with pytest.raises(SettingsError, match="no estimator"):
        calibrate(linear, estimator="magic")


@pytest.mark.slow
@pytest.mark.parametrize("seed", [11, 12])
def test_a_natural_portrait_gives_a_curve_that_is_better_than_none(seed):
    """With noise, highlights and shadows: nearer to the truth than taking codes for light."""
    photo = photograph(render_face(SyntheticSpec(seed=seed, cast_shadows=True)), gamma_curve(2.2))
    found = calibrate(photo)
    error = np.sqrt(((found.curve.linear - CODES**2.2) ** 2).mean())
    identity = np.sqrt(((CODES - CODES**2.2) ** 2).mean())
    assert found.outcome is Outcome.CALIBRATED
    assert error < identity


def test_integer_codes_give_the_estimate_of_the_floats_that_they_stand_for(portrait):
    codes = np.rint(portrait.encoded * 255).astype(np.uint8)
    of_codes = Photo.of_codes(codes)
    found = calibrate(of_codes)
    with pytest.raises(AttributeError):  # no cue needed all pixels as floats
        Photo.__dict__["encoded"].__get__(of_codes)
    expected = calibrate(Photo(of_codes.encoded, bit_depth=8))
    assert np.array_equal(found.curve.linear, expected.curve.linear)
    assert np.array_equal(found.confidence.sigma, expected.confidence.sigma)
