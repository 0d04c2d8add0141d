"""The joint estimator on photos of the synthetic face."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from facecrf_ocio import (
    Outcome,
    Photo,
    PhotoEvidence,
    SettingsError,
    Verdict,
    calibrate,
    calibrate_together,
    conclude,
    gather,
    misfit,
)
from facecrf_ocio.cameras.known_cameras import shipped_cameras
from facecrf_ocio.color.primaries import KNOWN_PRIMARIES
from facecrf_ocio.face.detect import find_faces
from facecrf_ocio.face.view import cut_face
from facecrf_ocio.files.threads import OtherThread
from facecrf_ocio.joint import shipped_joint
from facecrf_ocio.joint.conclusion import families_of
from facecrf_ocio.joint.messages import COMBINED
from facecrf_ocio.joint.metadata import modern_leaning, phone_leaning
from facecrf_ocio.joint.prior import FAMILIES, Posterior
from facecrf_ocio.joint.statistics import CUES, face_statistics
from facecrf_ocio.joint.verdict import deviations
from facecrf_ocio.record.demand import Demand, demand
from facecrf_ocio.settings import Settings
from facecrf_ocio.synthetic import SyntheticSpec, gamma_curve, photograph, render_face
from facecrf_ocio.values import Camera, Primaries


@pytest.fixture(scope="module")
def faces():
    return [render_face(SyntheticSpec(seed=seed)) for seed in (3, 4)]


@pytest.fixture(scope="module")
def photos(faces):
    return [photograph(face, gamma_curve(2.2)) for face in faces]


@pytest.fixture(scope="module")
def evidence(photos):
    return [gather(photo) for photo in photos]


def blank():
    return Photo(np.full((64, 64, 3), (0.5, 0.4, 0.3), np.float32))


def test_auto_is_joint(photos):
    auto, joint = calibrate(photos[0]), calibrate(photos[0], estimator="joint")
    assert auto.estimator == "joint"
    assert auto.outcome is Outcome.CALIBRATED
    assert np.array_equal(auto.curve.linear, joint.curve.linear)


def test_more_bits_do_not_change_what_a_cue_sees(photos):
    """The networks know photos of 8 bits: those of 16 are rounded before they are looked at."""
    fine = Photo(photos[0].encoded, bit_depth=16, camera=photos[0].camera)
    same = calibrate(fine, estimator="joint").curve.linear
    assert np.allclose(same, calibrate(photos[0], estimator="joint").curve.linear, atol=1e-6)


def test_every_cue_speaks(evidence):
    assert set(evidence[0].messages) == {*CUES, COMBINED}


def test_the_curve_is_nearer_to_the_truth_than_taking_codes_for_light(photos):
    found = [calibrate(photo).curve for photo in photos]
    codes = found[0].encoded
    truth = codes**2.2
    errors = [np.sqrt(((curve.linear - truth) ** 2).mean()) for curve in found]
    assert np.mean(errors) < 0.5 * np.sqrt(((codes - truth) ** 2).mean())


def test_all_channels_share_one_curve(photos):
    linear = calibrate(photos[0]).curve.linear
    assert (linear == linear[0]).all()


def test_the_band_is_narrower_than_the_prior_s(evidence):
    prior = conclude([])
    assert prior.confidence.verdict is Verdict.PRIOR_ONLY
    alone = conclude(evidence[:1])
    assert alone.confidence.sigma.mean() < 0.8 * prior.confidence.sigma.mean()


def test_a_photo_without_a_face_gets_the_prior_if_joint_is_asked_for_and_nothing_from_auto():
    refused = calibrate(blank())
    assert refused.outcome is Outcome.NOT_CALIBRATED
    assert refused.reason == "no face found"
    given = calibrate(blank(), estimator="joint")
    assert given.outcome is Outcome.FALLBACK
    assert given.confidence.verdict is Verdict.PRIOR_ONLY
    assert "no face found: the mean of the prior" in given.reason


def test_evidence_survives_storage(evidence):
    back = PhotoEvidence.from_json(evidence[0].to_json())
    assert np.array_equal(conclude([back]).curve.linear, conclude([evidence[0]]).curve.linear)
    assert len(evidence[0].to_json()) < 20_000


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"messages": {"grain": 1}}'])
def test_other_text_is_no_evidence(text):
    with pytest.raises(SettingsError, match="no evidence of a photo"):
        PhotoEvidence.from_json(text)


def test_several_photos_tighten_the_band(photos, evidence):
    together = calibrate_together(photos)
    alone = conclude(evidence[:1])
    assert together.estimate.confidence.sigma.mean() < alone.confidence.sigma.mean()
    assert together.lacking == ("", "")
    assert max(together.misfits) < 3.0


def test_who_is_outvoted_is_called_by_its_place_among_all_photos_given(evidence):
    silent, told = gather(blank()), evidence[0]
    liar = {
        cue: replace(message, mean=message.mean + 40.0, precision=np.full_like(message.mean, 1e2))
        for cue, message in told.messages.items()
    }
    given = [silent, told, told, told, replace(told, messages=liar)]
    said = conclude(given).confidence.outvoted
    assert [name for name in said if name.startswith("photo")] == ["photo 5"]
    names = ["a", "b", "c", "d", "e"]
    assert conclude(given, names=names).confidence.outvoted[-1] == "e"


@pytest.mark.parametrize("names", [["a", "a"], ["a"], ["a", "b", "c"]])
def test_photos_to_conclude_from_are_as_many_as_their_names(evidence, names):
    with pytest.raises(ValueError, match="no two alike"):
        conclude(evidence[:2], names=names)


def test_photos_without_a_face_change_nothing(photos):
    with_blank = calibrate_together([blank(), photos[0]])
    assert with_blank.lacking == ("no face found", "")
    assert np.array_equal(
        with_blank.estimate.curve.linear, calibrate_together(photos[:1]).estimate.curve.linear
    )


def test_a_photo_with_another_curve_fits_worse(faces, evidence):
    common = conclude(evidence)
    stranger = gather(photograph(faces[0], gamma_curve(1.2)))
    assert misfit(stranger, common) > 2.0 * max(misfit(one, common) for one in evidence)


def test_the_prior_can_be_told(evidence):
    film, digital = conclude(evidence[:1], "dorf"), conclude(evidence[:1], "modern")
    assert not np.allclose(film.curve.linear, digital.curve.linear, atol=1e-4)
    with pytest.raises(SettingsError, match="no prior 'film'"):
        calibrate(blank(), prior="film")


def test_phones_are_known_by_their_names():
    assert phone_leaning(Camera()) == 0.0
    assert phone_leaning(Camera("Apple", "iPhone 12")) > 0.0
    assert phone_leaning(Camera("samsung", "SM-G973F")) > 0.0
    assert phone_leaning(Camera("NIKON CORPORATION", "NIKON D90")) < 0.0


def test_evidence_stored_before_phones_were_told_is_read(evidence):
    stored = json.loads(evidence[0].to_json())
    del stored["phone"], stored["stretch"]
    old = PhotoEvidence.from_json(json.dumps(stored))
    assert (old.phone, old.stretch) == (0.0, 1.0)


def test_a_photo_unlike_training_has_a_wider_band_and_the_same_curve(evidence):
    usual = replace(evidence[0], stretch=1.0)
    strange = replace(evidence[0], stretch=1.5)
    a, b = conclude([usual]), conclude([strange])
    assert np.allclose(a.curve.linear, b.curve.linear)
    assert np.all(b.confidence.sigma[:, 100:-100] > 1.3 * a.confidence.sigma[:, 100:-100])
    assert b.confidence.in_stops.mid > a.confidence.in_stops.mid


def test_a_face_cut_by_two_threads_is_that_cut_by_one():
    photo = photograph(render_face(SyntheticSpec(seed=3)), gamma_curve(2.2))
    face = find_faces(photo.encoded, Settings()).faces[0]
    alone = cut_face(photo, face, Settings())
    with OtherThread() as other:
        together = cut_face(photo, face, Settings(), other=other)
    np.testing.assert_array_equal(together.encoded, alone.encoded)
    np.testing.assert_array_equal(together.geometry.bare_skin, alone.geometry.bare_skin)


def test_closed_eyes_say_nothing():
    face = render_face(SyntheticSpec(seed=3))
    photo = photograph(face, gamma_curve(2.2))
    found = find_faces(photo.encoded, Settings()).faces[0]
    points = found.landmarks_xyz.copy()
    for corner, upper, lower in ((33, 159, 145), (263, 386, 374)):
        points[[upper, lower], 1] = points[corner, 1]
    open_eyes, closed = (
        face_statistics(cut_face(photo, f, Settings()), Settings())
        for f in (found, replace(found, landmarks_xyz=points))
    )
    assert "eyes" in open_eyes.by_cue
    assert "eyes" not in closed.by_cue


def test_a_silent_file_leaves_all_three_families_alike():
    prior = shipped_joint().prior
    families = prior.family.astype(int)
    weights = prior.weights_for("auto", modern_leaning(Camera()), phone_leaning(Camera()))
    assert np.bincount(families, weights) == pytest.approx(np.full(3, 1 / 3))


def test_what_the_file_says_of_its_camera_leans():
    assert modern_leaning(Camera(make="NIKON", model="D90")) > 0.0
    assert modern_leaning(Camera(make="Noritsu Koki", model="QSS-31")) < 0.0
    assert modern_leaning(Camera("FUJI PHOTO FILM CO., LTD.", "SP-3000")) < 0.0
    assert modern_leaning(Camera("OLYMPUS IMAGING CORP.", "SP550UZ")) > 0.0
    assert modern_leaning(Camera(software="SilverFast 8.8")) < 0.0


@pytest.mark.parametrize(
    ("name", "modern"),
    [("Display P3", True), ("Rec.2020", True), ("Rec.709", False), ("Adobe RGB", False)],
)
def test_a_recent_profile_leans_as_a_named_camera_does(name, modern):
    primaries = Primaries(name, *KNOWN_PRIMARIES[name], "ICC profile")
    assert (modern_leaning(Camera(), primaries) > modern_leaning(Camera())) is modern
    assert modern_leaning(Camera(model="CoolScan V"), primaries) < 0.0


def test_demands_are_met_or_refused(evidence):
    weak = conclude([])
    assert demand(weak, Demand("prior only")) is weak
    refused = demand(weak, Demand("weak"))
    assert refused.outcome is Outcome.NOT_CALIBRATED
    assert "the estimate is prior only, and weak was asked for" in refused.reason


def test_the_verdict_is_of_the_expected_error_alone_whatever_srgb_is(evidence):
    found = conclude(evidence)
    told = found.confidence
    assert told.in_stops.sigma.shape == (3, 256)
    reliable = told.in_stops.mid <= 0.1 and told.in_stops.shadows <= 0.25
    assert (told.verdict is Verdict.RELIABLE) == reliable
    assert told.differs_from_srgb == (told.nearer_than_srgb >= 0.95)
    assert told.reasons == ()


@pytest.mark.parametrize(
    ("codes", "doubt"),
    [
        ((16, 140), ()),
        ((140, 200), ()),
        ((70, 250), ()),
        ((20, 60), ("the face is dark: 100 % of it below code 64",)),
        ((20, 80), ("the face is dark: 73 % of it below code 64",)),
        ((230, 255), ("the face is bright: 71 % of it above code 235",)),
    ],
)
def test_a_face_outside_the_midtones_is_never_reliable(evidence, codes, doubt):
    first, last = (code // 4 for code in codes)
    coverage = np.zeros((3, 64))
    coverage[:, first : last + (last == 63)] = 1.0
    told = conclude([replace(evidence[0], coverage=coverage)]).confidence
    assert told.doubts == doubt
    assert not doubt or told.verdict is not Verdict.RELIABLE


def test_a_dark_face_leaves_more_error_to_expect_and_the_same_curve(evidence):
    dark, bright = np.zeros((3, 64)), np.zeros((3, 64))
    dark[:, 5], bright[:, 62] = 1.0, 1.0
    plain, under, over = (
        conclude([replace(evidence[0], coverage=coverage)])
        for coverage in (evidence[0].coverage, dark, bright)
    )
    assert np.allclose(under.curve.linear, plain.curve.linear, rtol=0, atol=1e-12)
    assert under.confidence.in_stops.mid > 1.2 * plain.confidence.in_stops.mid
    assert under.confidence.sigma.mean() > 1.2 * plain.confidence.sigma.mean()
    assert over.confidence.in_stops.mid == plain.confidence.in_stops.mid


def test_one_face_in_the_midtones_is_enough(evidence):
    dark = np.zeros((3, 64))
    dark[:, 5] = 1.0
    both = [replace(evidence[0], coverage=dark), evidence[1]]
    assert conclude(both[:1]).confidence.doubts != ()
    assert conclude(both).confidence.doubts == ()


def test_a_dark_face_is_no_doubt_of_a_camera_that_was_measured(evidence):
    dark = np.zeros((3, 64))
    dark[:, 5] = 1.0
    told = replace(evidence[0], coverage=dark, camera=("Canon", "Canon EOS 5D"))
    stranger = replace(told, camera=("Acme", "One"))
    measured, other = (conclude([one], cameras=shipped_cameras()) for one in (told, stranger))
    assert not any("dark" in doubt for doubt in measured.confidence.doubts)
    assert any("dark" in doubt for doubt in other.confidence.doubts)


def test_more_evidence_leaves_less_error_to_expect(evidence):
    alone, nothing = conclude(evidence[:1]).confidence, conclude([]).confidence
    assert alone.in_stops.mid < nothing.in_stops.mid
    assert alone.in_stops.shadows < nothing.in_stops.shadows


def test_the_error_to_expect_is_what_was_measured_of_such_errors(evidence):
    as_it_is = replace(shipped_joint(), stops_scale=np.ones((len(FAMILIES), 2)))
    raw = conclude(evidence, model=as_it_is)
    halves = np.tile([0.5, 0.25], (len(FAMILIES), 1))
    scaled = conclude(evidence, model=replace(as_it_is, stops_scale=halves))
    assert np.array_equal(scaled.curve.linear, raw.curve.linear)
    assert np.array_equal(scaled.confidence.sigma, raw.confidence.sigma)
    assert scaled.confidence.in_stops.mid == pytest.approx(0.5 * raw.confidence.in_stops.mid)
    expected = 0.25 * raw.confidence.in_stops.shadows
    assert scaled.confidence.in_stops.shadows == pytest.approx(expected)


def test_the_error_to_expect_is_that_of_the_family_that_the_photo_is_held_for(evidence):
    only_film = np.array([[3.0, 3.0], [1.0, 1.0], [1.0, 1.0]])
    model = shipped_joint()
    as_it_is = replace(model, stops_scale=np.ones_like(only_film))
    film_off = replace(model, stops_scale=only_film)
    for prior, factor in (("dorf", 3.0), ("modern", 1.0)):
        raw, scaled = (
            conclude(evidence, prior, one).confidence.in_stops for one in (as_it_is, film_off)
        )
        assert scaled.mid == pytest.approx(factor * raw.mid)
        assert scaled.shadows == pytest.approx(factor * raw.shadows)
    shares = families_of(evidence[0], model)
    assert shares.shape == (len(FAMILIES),)
    assert shares.sum() == pytest.approx(1.0)


def test_film_errs_by_more_than_cameras_of_what_its_posterior_expects():
    film, camera, phone = shipped_joint().stops_scale
    assert film[0] > camera[0]
    assert film[0] > phone[0]


def test_weights_stay_small():
    networks = shipped_joint().networks.members
    count = sum(w.size + b.size for m in networks.values() for n in m for w, b in n.layers)
    assert 2 * count < 2_000_000  # stored in half precision


def test_a_sure_curve_keeps_the_band_that_channels_differ_by():
    """Red, green and blue of films and cameras lie about 2 % of white apart in the midtones."""
    prior = shipped_joint().prior
    size = prior.means.shape[1]
    sure = Posterior(np.ones(1), np.zeros((1, size)), 1e-12 * np.eye(size)[None])
    band = deviations(sure, prior, 1.0)
    at = np.interp([32 / 255, 128 / 255, 192 / 255], prior.grid, band)
    assert np.all((at > [0.003, 0.014, 0.02]) & (at < [0.012, 0.026, 0.04]))
    vague = Posterior(np.ones(1), np.zeros((1, size)), np.eye(size)[None])
    assert np.allclose(
        deviations(vague, prior, 1.2) ** 2, (1.2 * prior.deviations(vague)) ** 2 + band**2
    )
