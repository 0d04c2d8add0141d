"""A photo that names a measured camera: that counts, and the photo may contradict it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from facecrf_ocio import Photo, calibrate, calibrate_together
from facecrf_ocio.benchmark.camera_known import (
    known_cases,
    known_markdown,
    measure_known,
    model_of,
)
from facecrf_ocio.benchmark.images import find_linear_images
from facecrf_ocio.benchmark.responses import read_responses
from facecrf_ocio.calibrate import SAME_CURVE
from facecrf_ocio.cameras.known_cameras import (
    POINTS,
    KnownCamera,
    known_cameras,
    shipped_cameras,
    write_registry,
)
from facecrf_ocio.joint import PhotoEvidence, conclude
from facecrf_ocio.joint.cue_weights import agreeing_shares
from facecrf_ocio.joint.fused_photos import fuse_photos
from facecrf_ocio.joint.known_response import (
    STYLES,
    coefficients,
    known_response,
    share_beside,
)
from facecrf_ocio.joint.prior import Message, shipped_prior
from facecrf_ocio.settings import Settings
from facecrf_ocio.values import Verdict
from facecrf_ocio.wording.sentence import sentence

CODES = np.linspace(0.0, 1.0, POINTS)


def camera(exponent, model="One", spread=0.06):
    row = tuple((CODES**exponent).tolist())
    return KnownCamera("Acme", model, "", "pair", "A", spread, "by hand", (row, row, row))


def said(exponent, precision, model="One"):
    """Evidence of a photo whose cues point to a power, each coefficient with this precision."""
    mean = coefficients(camera(exponent), shipped_prior())
    message = Message(mean, np.full(mean.size, precision))
    return PhotoEvidence({"grain": message}, np.ones((3, 64)), camera=("Acme Inc.", model))


def middle(estimate):
    return float(np.interp(0.5, estimate.curve.encoded, estimate.curve.linear[0]))


def test_a_response_keeps_its_shape_as_coefficients():
    prior = shipped_prior()
    for one in shipped_cameras():
        roots = prior.roots(coefficients(one, prior))
        truth = np.sqrt(np.interp(prior.grid, one.curve.encoded, one.curve.linear[1]))
        assert np.sqrt(((roots - truth) ** 2).mean()) < 0.01


def test_measurements_of_one_model_are_joined_and_their_styles_are_not_averaged_away():
    prior = shipped_prior()
    many = [camera(2.2), camera(2.3), camera(1.0, "Two")]
    found = known_response(many, "Acme", "one", prior)
    assert found.name == "Acme One"
    each = [coefficients(one, prior) for one in many[:2]]
    assert np.allclose(found.message.mean, np.mean(each, axis=0))
    deviation = found.message.precision**-0.5
    assert STYLES[0] < deviation[0] < 1.2 * STYLES[0]
    assert deviation[2] > STYLES[2]
    assert known_response([camera(2.2, "ACME X1")], "Acme", "acme x1", prior).name == "Acme X1"
    assert known_response(many, "Other", "One", prior) is None
    assert known_response(many, "Acme", "", prior) is None


def test_what_is_known_draws_a_weak_photo_near_and_narrows_its_band():
    photo = said(2.0, 0.5)
    alone, known = (conclude([photo], cameras=listed) for listed in ((), (camera(2.4),)))
    assert middle(known) < middle(alone)
    assert known.confidence.in_stops.mid < alone.confidence.in_stops.mid
    assert any("Acme One counts as evidence" in reason for reason in known.confidence.reasons)
    other = conclude([replace(photo, camera=("Acme", "Two"))], cameras=(camera(2.4),))
    assert np.array_equal(other.curve.linear, alone.curve.linear)


def test_a_photo_may_contradict_its_camera():
    photo = said(1.6, 400.0)
    alone, known = (conclude([photo], cameras=listed) for listed in ((), (camera(2.9),)))
    assert abs(middle(known) - middle(alone)) < 0.03
    assert known.confidence.verdict is not Verdict.RELIABLE
    (doubt,) = known.confidence.doubts
    assert doubt == (
        "the photo contradicts the measured response of Acme One: another picture style, or edited"
    )
    assert doubt in sentence(known)


def test_one_curve_of_photos_that_name_several_cameras_is_never_reliable():
    named = [("ACME", "One"), ("Acme Inc.", "one "), ("", ""), ("Acme", "Two"), ("Zeta", "Zeta 3")]
    photos = [replace(said(2.2, 400.0), camera=camera) for camera in named]
    alike = conclude(photos[:3], cameras=())
    assert alike.confidence.verdict is Verdict.RELIABLE
    assert alike.confidence.doubts == ()
    mixed = conclude(photos, cameras=())
    assert mixed.confidence.verdict is Verdict.WEAK
    (doubt,) = mixed.confidence.doubts
    assert doubt == (
        "the photos name 3 cameras, but one curve is of one camera: ACME One, Acme Two, Zeta 3"
    )


def test_bends_of_a_measured_curve_contradict_no_photo():
    """As red and blue of the 350D have them, solved from a stack; brightness and contrast agree."""
    prior = shipped_prior()
    bends = np.zeros(prior.basis.shape[0])
    bends[4:7] = 3.0, 5.0, -4.0
    light = np.maximum.accumulate(np.clip(prior.roots(bends), 0.0, 1.0)) ** 2
    row = tuple(np.interp(CODES, prior.grid, light / light[-1]).tolist())
    bent = replace(camera(2.4), linear=(row, row, row))
    known = known_response([bent], "Acme", "One", prior).message
    assert np.abs(known.mean[2:]).max() > 2.0
    plain = np.concatenate([known.mean[:2], np.zeros(known.mean.size - 2)])
    photo = Message(plain, np.full(plain.size, 6.0))
    told = PhotoEvidence({"grain": photo}, np.ones((3, 64)), camera=("Acme", "One"))
    assert conclude([told], cameras=(bent,)).confidence.doubts == ()
    weights = prior.weights_for("auto", 0.0, 0.0)
    assert agreeing_shares({"a": photo, "b": known}, prior, weights)["b"] < 0.5
    assert share_beside(known, prior.posterior(photo, weights)) == 1.0
    away = Message(plain - 3.0, np.full(plain.size, 6.0))
    assert share_beside(known, prior.posterior(away, weights)) < 0.5


@pytest.mark.parametrize("photos", [1, 2, 12])
def test_what_is_known_counts_once_however_many_photos_name_it(photos):
    """The precision that it adds to the photos' is that of one message."""
    prior = shipped_prior()
    weights = prior.weights_for("modern")
    known = {("Acme Inc.", "One"): known_response([camera(2.2)], "Acme", "One", prior)}
    told = {f"{n}.jpg": said(2.2, 50.0) for n in range(photos)}
    stretches = dict.fromkeys(told, 1.0)
    without = fuse_photos(told, stretches, prior, weights, {}).posterior
    both = fuse_photos(told, stretches, prior, weights, known)
    assert both.outvoted == ()
    added = np.linalg.inv(both.posterior.covariance) - np.linalg.inv(without.covariance)
    message = np.diag(known["Acme Inc.", "One"].message.precision)
    assert np.abs(added - message).max() < 0.1 * message.max()


def test_one_camera_by_two_names_counts_once():
    two = {make: replace(said(2.0, 0.5), camera=(make, "One")) for make in ("Acme", "Acme Inc.")}
    told = conclude(list(two.values()), cameras=(camera(2.4),))
    assert sum("Acme One counts as evidence" in r for r in told.confidence.reasons) == 1


def test_what_the_user_added_counts(tmp_path, monkeypatch):
    monkeypatch.setenv("FACECRF_CAMERAS", str(tmp_path / "mine.json"))
    assert known_cameras() == shipped_cameras()
    write_registry(tmp_path / "mine.json", [camera(2.4)], overwrite=False)
    assert known_cameras()[-1].model == "One"
    assert any("Acme One" in reason for reason in conclude([said(2.0, 0.5)]).confidence.reasons)


def in_three_channels(*exponents):
    rows = tuple(tuple((CODES**one).tolist()) for one in exponents)
    return replace(camera(2.4), linear=rows)


def test_each_channel_departs_as_the_user_has_measured():
    photo = said(2.4, 0.5)
    alike = conclude([photo], cameras=(camera(2.4),)).curve
    apart = conclude([photo], cameras=(in_three_channels(2.0, 2.4, 2.8),)).curve
    middles = [float(np.interp(0.5, apart.encoded, row)) for row in apart.linear]
    for exponent, shown in zip((2.0, 2.4, 2.8), middles, strict=True):
        assert shown == pytest.approx(0.5**exponent, abs=0.03)
    assert np.ptp(alike.linear, axis=0).max() < 1e-9
    assert (np.diff(apart.linear, axis=1) > 0).all()


def test_channels_are_alike_where_the_photo_contradicts_or_another_camera_is_named():
    measured = (in_three_channels(2.4, 2.9, 3.4),)
    for photos in (
        [said(1.6, 400.0)],
        [said(2.9, 0.5), said(2.9, 0.5, model="Two")],
        [said(2.9, 0.5, model="Two")],
    ):
        found = conclude(photos, cameras=measured).curve
        assert np.array_equal(found.linear[0], found.linear[2])


@pytest.mark.parametrize("shared", [False, True])
def test_all_channels_share_a_curve_if_asked_for_whatever_was_measured(
    tmp_path, monkeypatch, shared
):
    monkeypatch.setenv("FACECRF_CAMERAS", str(tmp_path / "mine.json"))
    write_registry(tmp_path / "mine.json", [in_three_channels(2.0, 2.4, 2.8)], overwrite=False)
    photo, settings = said(2.4, 0.5), Settings(shared_curve=shared)
    monkeypatch.setattr("facecrf_ocio.together.gather", lambda *_: photo)
    gray = Photo(np.full((8, 8, 3), 0.5, np.float32))
    alone = calibrate(gray, settings=settings, evidence=photo)
    assert (SAME_CURVE in alone.assumptions) == shared
    for found in (alone, calibrate_together([gray, gray], settings=settings).estimate):
        assert (found.curve.linear == found.curve.linear[0]).all() == shared


def test_evidence_keeps_the_camera_s_name():
    photo = said(2.0, 0.5)
    assert PhotoEvidence.from_json(photo.to_json()).camera == ("Acme Inc.", "One")
    old = photo.to_json().replace('"camera"', '"was"')
    assert PhotoEvidence.from_json(old).camera == ("", "")


@pytest.mark.parametrize(
    ("name", "model"),
    [
        ("Nikon D7000 (Kim/Lin/Brown 2012, Normal, RGB)", "D7000"),
        ("darktable basecurve: NIKON D7500", "D7500"),
        ("Canon EOS 550D (exposure stacks)", "550D"),
        ("darktable basecurve: pentax like", ""),
    ],
)
def test_models_are_told_by_name(name, model):
    assert model_of(name) == model


@pytest.mark.slow
@pytest.mark.usefixtures("held_out_weights")
def test_a_third_less_error_by_another_s_measurement(development_data):
    """It was half, before the networks knew more of real cameras by themselves."""
    folder = development_data / "crf"
    files = [read_responses(folder / f"modern_{name}.npz") for name in ("dev", "stacks")]
    images = find_linear_images(development_data / "faces" / "rendered" / "img", "dev_*_clean.exr")
    assert len(known_cases(files)) == 15
    results = list(measure_known(images.images, files, repeat=1))
    table = known_markdown(results)
    alone, both = (np.array([100 * one.scores[k].rmse for one in results]) for k in (0, 1))
    assert np.median(both) < 0.67 * np.median(alone), table
    assert np.median([one.scores[1].mid for one in results]) < 0.1, table
