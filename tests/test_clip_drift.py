"""Whether a clip's curve changes: seen in points of fixed light, and feigned by nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from facecrf_ocio.clip.curve_drift import drift_of_curves, drift_of_points
from facecrf_ocio.clip.drift_evidence import Drift
from facecrf_ocio.clip.tracked_points import TrackedPoints, thinned
from facecrf_ocio.joint import shipped_joint
from facecrf_ocio.joint.prior import Posterior
from facecrf_ocio.response.model import inverse_crf

PRIOR = shipped_joint().prior
SIZE = PRIOR.basis.shape[0]
ROUGHLY = np.linalg.lstsq(PRIOR.basis.T, PRIOR.grid**1.1 - PRIOR.mean, rcond=None)[0]
FACES = Posterior(np.ones(1), ROUGHLY[None], 0.1 * np.eye(SIZE)[None])
TIMES = np.linspace(-0.5, 0.5, 12)
WANDERING = np.array([0.0, 0.8, -0.7, -1.0, 1.0, 0.2, -0.4, 0.6, -0.9, 0.5, -0.2, 0.1])  # [stop]
STILL = np.zeros(12)
GRID = np.linspace(0.0, 1.0, 1024)
COUNT = 900


def bent(size):
    """The curve of an exponent of 2.2, with waves of this height [stop] over codes."""
    stops = 2.2 * np.log2(np.maximum(GRID, 1e-3)) + size * np.sin(3.0 * np.pi * GRID)
    return np.exp2(stops - stops[-1])


def seen(curves, stops=STILL, moving=None):
    """The drift of a clip of points over a picture, each channel a light of its own.

    `moving` gives (J, N) [stop] of light that is not the same in all frames, by places and light.
    """
    generator = np.random.default_rng(0)
    places = generator.uniform(size=(COUNT, 2))
    light = generator.uniform(-5.0, -1.2, (COUNT, 3))
    moved = 0.0 if moving is None else moving(places, light.mean(axis=1))[:, :, None]
    shown = np.exp2(light + np.asarray(stops)[:, None, None] + moved)
    codes = np.stack(
        [255.0 * np.interp(one, curve, GRID) for one, curve in zip(shown, curves, strict=True)]
    )
    codes = np.rint(4.0 * (codes + generator.normal(0.0, 0.3, codes.shape))) / 4.0
    usable = (codes.min(axis=2) > 5) & (codes.max(axis=2) < 247)
    points = TrackedPoints(codes, usable, places)
    return drift_of_points(FACES, points, TIMES, PRIOR, 1.0)


@pytest.mark.parametrize("stops", [STILL, WANDERING])
def test_an_exponent_that_changes_is_seen(stops):
    found = seen([GRID**e for e in 2.2 + 0.1 * TIMES], stops)
    assert found.is_sure
    assert 0.02 < found.stops < 0.12  # [stop]: 0.1 of the deviation of log2 of the codes


@pytest.mark.parametrize("stops", [STILL, WANDERING, 1.5 * TIMES, -1.5 * TIMES])
@pytest.mark.parametrize("size", [0.0, 0.1])
def test_a_curve_that_stays_does_not_drift_whatever_its_bends(size, stops):
    assert not seen([bent(size)] * 12, stops).is_sure


@pytest.mark.parametrize(("stops", "hidden"), [(STILL, False), (1.5 * TIMES, True)])
def test_where_exposure_only_rises_nothing_can_be_told(stops, hidden):
    assert seen([GRID**2.2] * 12, stops).is_hidden is hidden


@pytest.mark.parametrize("course", [TIMES, 0.5 * WANDERING])
def test_light_that_moves_over_the_picture_is_no_drift(course):
    def across(places, _):
        return 0.4 * np.outer(course, places @ (1.0, 0.5))

    assert not seen([GRID**2.2] * 12, WANDERING, across).is_sure


def test_a_drift_is_seen_through_light_that_moves():
    def across(places, _):
        return 0.2 * np.outer(TIMES, places[:, 0])

    assert seen([GRID**e for e in 2.2 + 0.2 * TIMES], WANDERING, across).is_sure


def turning(_, light):
    """What a head does that turns: light goes with the brightness of points, and each its own way.

    It is the same in all channels.
    """
    own = np.random.default_rng(1).normal(0.0, 0.1, light.size)
    return np.outer(TIMES, 0.06 * (light - light.mean()) + own)


def test_light_that_goes_with_brightness_is_no_drift_as_colors_stay():
    assert not seen([GRID**2.2] * 12, WANDERING, turning).is_sure


def test_a_drift_is_seen_through_light_that_goes_with_brightness():
    assert seen([GRID**e for e in 2.2 + 0.2 * TIMES], WANDERING, turning).is_sure


def test_a_drift_is_seen_though_one_frame_shows_no_point():
    stops = STILL.copy()
    stops[5] = -12.0
    assert seen([GRID**e for e in 2.2 + 0.2 * TIMES], stops).is_sure


def test_few_frames_or_points_in_one_corner_tell_nothing():
    curves = [GRID**2.1, GRID**2.3]
    light = np.exp2(np.linspace(-5.0, -1.2, 200))
    codes = np.array([[255.0 * np.interp(light, curve, GRID)] * 3 for curve in curves])
    three = np.ascontiguousarray(codes.transpose(0, 2, 1))
    places = np.full((200, 2), 0.05)
    two = TrackedPoints(three, np.ones((2, 200), bool), places)
    assert drift_of_points(FACES, two, np.array([-0.5, 0.5]), PRIOR, 1.0) == Drift()
    six = TrackedPoints(np.repeat(three, 3, axis=0), np.ones((6, 200), bool), places)
    assert drift_of_points(FACES, six, np.linspace(-0.5, 0.5, 6), PRIOR, 1.0) == Drift()
    assert Drift().is_hidden


def test_where_no_points_are_frames_own_curves_tell_a_drift_beyond_their_scatter():
    codes, told = np.linspace(0.0, 1.0, 256), 0
    for seed in range(10):
        generator = np.random.default_rng(seed)
        scatter = generator.normal(0.0, 0.03, 12)
        drifting, still = (
            [inverse_crf(codes, np.tile(codes**e, (3, 1))) for e in ends + scatter]
            for ends in (np.linspace(2.05, 2.25, 12), np.full(12, 2.2))
        )
        told += drift_of_curves(drifting).is_sure
        assert not drift_of_curves(still).is_sure
    assert told >= 8
    assert drift_of_curves(drifting[:3]) == Drift()


def test_fewer_points_are_as_many_dark_ones_as_bright_ones():
    codes = np.repeat(np.repeat([[20.0] * 900 + [200.0] * 100], 4, axis=0)[:, :, None], 3, axis=2)
    points = TrackedPoints(codes, np.ones((4, 1000), bool), np.zeros((1000, 2)))
    fewer = thinned(points, 320).codes[0, :, 0]
    assert [(fewer == code).sum() for code in (20.0, 200.0)] == [20, 20]
