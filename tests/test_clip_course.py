"""A curve that changes within a shot: when, and the curve of each stretch of frames."""

from __future__ import annotations

import cv2
import numpy as np
import OpenImageIO as oiio  # noqa: N813
import pytest
from archive_photos import linear_face
from command_line import CommandLine

from facecrf_ocio.clip.curve_course import course_of_points, levels_of, posterior_at
from facecrf_ocio.clip.tracked_points import TrackedPoints
from facecrf_ocio.joint import shipped_joint
from facecrf_ocio.joint.prior import Posterior
from facecrf_ocio.synthetic import encode, gamma_curve

PRIOR = shipped_joint().prior
SIZE = PRIOR.basis.shape[0]
GRID = np.linspace(0.0, 1.0, 1024)
TIMES = np.linspace(-0.5, 0.5, 12)
WANDERING = np.array([0.0, 0.8, -0.7, -1.0, 1.0, 0.2, -0.4, 0.6, -0.9, 0.5, -0.2, 0.1])  # [stop]
ROUGHLY = np.linalg.lstsq(PRIOR.basis.T, PRIOR.grid**1.1 - PRIOR.mean, rcond=None)[0]
FACES = Posterior(np.ones(1), ROUGHLY[None], 0.1 * np.eye(SIZE)[None])
EVENLY = 2.2 + 0.2 * TIMES
AT_ONCE = np.where(np.arange(12) < 5, 2.1, 2.3)


def course(exponents, stops=WANDERING):
    """Of gray points of known light whose curve has these exponents over time."""
    light = np.exp2(np.linspace(-5.0, -1.2, 200))
    codes = [
        np.rint(255.0 * (light * 2.0**stop) ** (1.0 / exponent))
        for exponent, stop in zip(exponents, stops, strict=True)
    ]
    three = np.repeat(np.array(codes)[:, :, None], 3, axis=2)
    usable = (three.min(axis=2) > 5) & (three.max(axis=2) < 247)
    points = TrackedPoints(three, usable, np.zeros((200, 2)))
    return course_of_points(FACES, points, TIMES, PRIOR)


def apart(one, other, span=(0.25, 0.75)):
    """[stop] RMS difference of two curves, but for their scale, over codes that points show."""
    seen = (PRIOR.grid > span[0]) & (PRIOR.grid < span[1])
    stops = np.log2(one[seen] / other[seen])
    return float(np.std(stops))


@pytest.mark.parametrize("stops", [WANDERING, np.zeros(12)])
def test_a_curve_that_goes_evenly_has_three_stretches(stops):
    found = levels_of(course(EVENLY, stops).places, TIMES)
    assert found.even
    assert [(one.first, one.last) for one in found.parts] == [(0, 3), (4, 7), (8, 11)]


@pytest.mark.parametrize("stops", [WANDERING, np.zeros(12)])
def test_a_curve_that_jumps_has_a_stretch_on_either_side(stops):
    found = levels_of(course(AT_ONCE, stops).places, TIMES)
    assert not found.even
    assert [(one.first, one.last) for one in found.parts] == [(0, 4), (5, 11)]


def test_each_stretch_changes_the_clips_curve_as_it_is_true():
    went = course(AT_ONCE)
    before, after = levels_of(went.places, TIMES).parts
    mean = np.average([2.1, 2.3], weights=[5, 7])
    whole = Posterior(np.ones(1), FACES.means, 1e-3 * FACES.covariances)
    for level, exponent in ((before, 2.1), (after, 2.3)):
        own = posterior_at(level.place, went, whole, 1.0)
        once = PRIOR.samples(whole.mean) * np.maximum(PRIOR.grid, 1e-3) ** (exponent - mean)
        assert apart(PRIOR.samples(own.mean), once) < 0.005
        assert apart(PRIOR.samples(whole.mean), once) > 0.03
        assert np.trace(own.covariance) > np.trace(whole.covariance)


def test_exposure_that_goes_one_way_can_feign_a_course():
    assert course(EVENLY, 1.5 * TIMES).with_exposure
    assert not course(EVENLY, WANDERING).with_exposure


def test_a_course_that_scatters_as_much_as_it_goes_is_not_told():
    generator = np.random.default_rng(0)
    assert levels_of(0.3 * TIMES + generator.normal(0.0, 0.3, 12), TIMES) is None
    assert levels_of(np.array([0.0, 0.0, 1.0, 1.0]), np.linspace(-0.5, 0.5, 4)) is None


@pytest.mark.slow
def test_a_clip_whose_curve_jumps_gets_a_lut_a_stretch_and_frames_of_its_curve(capfd, tmp_path):
    light = cv2.GaussianBlur(linear_face(3), (0, 0), 1.0)
    for number in range(16):
        seen = np.roll(light * np.float32(2.0 ** (0.4 * np.sin(number))), number, axis=1)
        codes = encode(np.clip(seen, 0, 1), gamma_curve(2.0 if number < 8 else 2.4))
        (tmp_path / "in").mkdir(exist_ok=True)
        pixels = np.rint(255.0 * codes[..., ::-1]).astype(np.uint8)
        cv2.imwrite(str(tmp_path / "in" / f"take.{number + 1:04d}.png"), pixels)
    command = ("clip", tmp_path / "in", "-o", tmp_path / "out", "--frames", "8", "--exr")
    ended = CommandLine(capfd)(*command, "--formats", "spi1d")
    assert ended.code == 0, ended.err
    assert "its curve jumps between frames that were looked at: stretch 1" in " ".join(
        ended.out.split()
    )
    assert (tmp_path / "out" / "in.stretch1.spi1d").exists()
    assert (tmp_path / "out" / "in.stretch2.crf.json").exists()
    curves = [
        oiio.ImageInput.open(str(path)).spec().get_string_attribute("facecrf:curve")
        for path in sorted((tmp_path / "out" / "in.exr").iterdir())
    ]
    assert len(curves) == 16
    assert len(set(curves[:7])) == len(set(curves[9:])) == 1
    assert curves[0] != curves[-1]
