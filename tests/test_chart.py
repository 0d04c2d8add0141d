"""A color chart: known responses come back, however it lies and is lit."""

from __future__ import annotations

import io

import cv2
import numpy as np
import pytest
from command_line import CommandLine
from face_photos import grace_hopper
from PIL import Image

from facecrf_ocio.benchmark.peers.drawn_chart import lit_chart, shot
from facecrf_ocio.cameras.known_cameras import read_registry
from facecrf_ocio.chart.calibrate_chart import calibrate_chart
from facecrf_ocio.chart.find_chart import by_corners, can_find, find_chart, to_pixels
from facecrf_ocio.chart.reflectances import GRAYS, reflectances
from facecrf_ocio.errors import PhotoError, SettingsError
from facecrf_ocio.record.calibration_record import read_record
from facecrf_ocio.response.model import inverse_crf
from facecrf_ocio.response.stops import stops_error, uniform
from facecrf_ocio.synthetic import gamma_curve
from facecrf_ocio.values import Outcome, Photo

GRID = np.linspace(0.0, 1.0, 1024)
KNOWN = {
    "srgb": inverse_crf(
        GRID, [np.where(GRID < 0.04045, GRID / 12.92, ((GRID + 0.055) / 1.055) ** 2.4)] * 3
    ),
    "contrasty": inverse_crf(GRID, [0.12 * GRID**1.2 + 0.88 * GRID**3.1] * 3),
    "unlike channels": inverse_crf(
        GRID, [0.12 * GRID**1.2 + 0.88 * GRID**e for e in (2.6, 2.5, 2.4)]
    ),
}


def worst(found, truth):
    """[stop] mean error of the worst channel over codes 64 to 235, each with its own factor."""
    pairs = zip(uniform(found), uniform(truth), strict=True)
    return max(stops_error(one, other).mid for one, other in pairs)


def shadows(found, truth):
    pairs = zip(uniform(found), uniform(truth), strict=True)
    return max(stops_error(one, other).shadows for one, other in pairs)


def test_the_gray_row_is_gray_and_white_paper_is_one():
    for edition, white in (("2014", 0.88), ("2005", 0.91)):
        grays = reflectances(edition)[GRAYS]
        assert (np.ptp(grays, axis=1) < 0.09 * grays.mean(axis=1)).all()
        assert grays[0, 1] == pytest.approx(white, abs=0.01)
        assert (np.diff(np.log2(grays), axis=0) < -0.5).all()


@pytest.mark.parametrize("curve", KNOWN)
@pytest.mark.parametrize(("fall", "turn", "quality"), [(0.0, 0.0, 95), (0.8, 30.0, 75)])
def test_a_known_response_comes_back(curve, fall, turn, quality):
    truth = KNOWN[curve]
    white = 0.55 if fall else 0.75
    light, corners = lit_chart(3, white=white, fall=fall, turn=turn)
    found = calibrate_chart(shot(light, truth, quality=quality)[1], corners)
    assert worst(found.estimate.curve, truth) < 0.05
    assert shadows(found.estimate.curve, truth) < 0.15
    told = found.estimate.confidence.in_stops
    assert 0.01 < told.mid < 0.08


@pytest.mark.parametrize("glare", [0.003, 0.009])
def test_glare_of_the_lens_is_allowed_for(glare):
    """Black patches look brighter than they are: the shadows' curve must not be bent by that."""
    truth = KNOWN["contrasty"]
    light, corners = lit_chart(3, white=0.75, glare=glare)
    found = calibrate_chart(shot(light, truth, quality=95)[1], corners).estimate
    assert shadows(found.curve, truth) < 0.35
    assert shadows(found.curve, truth) < 2.0 * found.confidence.in_stops.shadows


def test_light_that_falls_off_is_measured():
    light, corners = lit_chart(1, white=0.5, fall=1.0)
    found = calibrate_chart(shot(light, KNOWN["srgb"])[1], corners)
    centers = np.array([[k % 6, k // 6] for k in range(24)], float)
    x, y = to_pixels(found.homography, centers).T
    truth = (x / 820 - 0.5) * 0.8 + (y / 640 - 0.5) * 0.6 - 0.5 * (x / 820 - 0.5) ** 2
    assert np.ptp(found.light - truth) < 0.06
    assert np.ptp(truth) > 0.4


@pytest.mark.parametrize("first", range(4))
def test_corners_may_begin_anywhere(first):
    light, corners = lit_chart(2)
    photo = shot(light, KNOWN["srgb"])[1]
    turned = calibrate_chart(photo, np.roll(corners, first, axis=0))
    assert np.allclose(turned.patches.mean, calibrate_chart(photo, corners).patches.mean, atol=2e-3)


@pytest.mark.skipif(not can_find(), reason="the installed OpenCV has no mcc")
@pytest.mark.parametrize("turn", [0.0, 160.0])
def test_it_is_found(turn):
    light, corners = lit_chart(4, turn=turn)
    photo = shot(light, KNOWN["srgb"])[1]
    assert find_chart(photo.encoded) is not None
    found, given = (calibrate_chart(photo, at) for at in (None, corners))
    centers = np.array([[0.0, 0.0], [5.0, 0.0], [5.0, 3.0], [0.0, 3.0]])
    away = to_pixels(found.homography, centers) - to_pixels(given.homography, centers)
    assert np.abs(away).max() < 12.0  # [px] of patches of 60
    assert worst(found.estimate.curve, given.estimate.curve) < 0.02


def test_what_is_clipped_is_left_out_and_too_little_is_refused():
    light, corners = lit_chart(5, white=1.3)
    found = calibrate_chart(shot(light, KNOWN["srgb"])[1], corners)
    assert not found.patches.usable[18].any()
    assert worst(found.estimate.curve, KNOWN["srgb"]) < 0.1
    light, corners = lit_chart(5, white=5.0)
    refused = calibrate_chart(shot(light, KNOWN["srgb"])[1], corners).estimate
    assert refused.outcome is Outcome.NOT_CALIBRATED
    assert "fewer than 4 grays" in refused.reason


@pytest.mark.parametrize("factors", [(0.5, 2.2), (0.4, 2.5), (0.6, 1.6)])
def test_grays_that_no_curve_joins(factors):
    light, corners = lit_chart(6)
    spoiled = light.copy()
    quad = by_corners(corners)
    for column, factor in zip((1, 3), factors, strict=True):
        x, y = np.rint(to_pixels(quad, np.array([[column, 3.0]]))[0]).astype(int)
        spoiled[y - 24 : y + 24, x - 24 : x + 24] *= factor
    estimate = calibrate_chart(shot(spoiled, KNOWN["srgb"])[1], corners).estimate
    assert estimate.outcome is Outcome.NOT_CALIBRATED
    assert "no curve joins the grays" in estimate.reason


class TestBadInput:
    def test_no_chart_there(self):
        with pytest.raises(PhotoError, match="something else there than a ColorChecker"):
            calibrate_chart(Photo(grace_hopper()), [[100, 60], [400, 60], [400, 260], [100, 260]])

    @pytest.mark.skipif(not can_find(), reason="the installed OpenCV has no mcc")
    def test_no_chart_at_all(self):
        with pytest.raises(PhotoError, match=r"shows (no chart|something else)"):
            calibrate_chart(Photo(np.full((300, 400, 3), 0.5, np.float32)))

    def test_a_picture_of_one_row(self):
        assert find_chart(np.zeros((1, 3000, 3), np.float32)) is None

    def test_no_detector(self, monkeypatch):
        monkeypatch.delattr(cv2, "mcc", raising=False)
        with pytest.raises(PhotoError, match=r"has no detector.*corners_xy="):
            calibrate_chart(Photo(grace_hopper()))

    def test_cut_off_or_linear(self):
        photo = Photo(grace_hopper())
        with pytest.raises(PhotoError, match="cut off or too small"):
            calibrate_chart(photo, [[-90, 0], [400, 0], [400, 300], [-90, 300]])
        with pytest.raises(PhotoError, match="is scene-linear"):
            calibrate_chart(Photo(grace_hopper(), scene_linear=True))
        with pytest.raises(SettingsError, match="four corners"):
            calibrate_chart(photo, [[0, 0], [1, 1], [2, 2]])


def test_the_command_and_the_registry(capfd, tmp_path, monkeypatch):
    monkeypatch.setenv("FACECRF_CAMERAS", str(tmp_path / "cameras.json"))
    light, corners = lit_chart(7)
    content, _ = shot(light, gamma_curve(2.2))
    photo = tmp_path / "chart.jpg"
    photo.write_bytes(with_camera(content))
    run = CommandLine(capfd)
    given = [f"{x:.1f},{y:.1f}" for x, y in corners]
    ended = run("chart", photo, "--corners", *given, "-o", tmp_path, "--formats", "clf", "--plot")
    assert ended.code == 0, ended.err
    record = tmp_path / "chart.jpg.crf.json"
    told = read_record(record).estimate
    assert told.estimator == "chart"
    assert worst(told.curve, gamma_curve(2.2)) < 0.05
    assert run("cameras", "add", record).code == 0
    (one,) = read_registry(tmp_path / "cameras.json")
    assert (one.make, one.model, one.method) == ("Acme", "One", "chart")
    ended = run("chart", photo, "--corners", "1,2", "3,4", "5", "6,7", "-o", tmp_path)
    assert ended.code == 2
    assert "give pixels as x,y" in ended.err


def with_camera(content):
    """The JPEG with a make and model in EXIF."""
    picture = Image.open(io.BytesIO(content))
    exif = Image.Exif()
    exif[0x010F], exif[0x0110] = "Acme", "One"
    stored = io.BytesIO()
    picture.save(stored, "jpeg", quality="keep", exif=exif)
    return stored.getvalue()
