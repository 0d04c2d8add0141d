"""EXIF's exposure times are names; what the shutter does stands on a grid."""

from __future__ import annotations

import numpy as np
import pytest

from facecrf_ocio.pair.exposure_grid import exposure_stops

THIRDS = (1, 0.8, 0.6, 0.5, 0.4, 0.3, *(1 / n for n in (4, 5, 6, 8, 10, 13, 15, 20, 25)))
HALVES = (
    1.5,
    1,
    0.7,
    0.5,
    0.3,
    1 / 4,
    1 / 6,
    1 / 8,
    1 / 10,
    1 / 15,
    1 / 20,
    1 / 30,
    1 / 45,
    1 / 60,
)


def steps(times, apertures=None, iso=None):
    count = len(times)
    return np.diff(exposure_stops(times, apertures or [4.0] * count, iso or [100.0] * count))


@pytest.mark.parametrize(("times", "step"), [(THIRDS, 1 / 3), (HALVES, 1 / 2)])
def test_named_times_are_even_steps(times, step):
    assert steps(times) == pytest.approx(-step)


def test_f_numbers_and_sensitivities_too():
    assert steps([0.01] * 4, apertures=[4, 5.6, 8, 11]) == pytest.approx(-1.0)
    assert steps([0.01] * 4, apertures=[4, 4.5, 5, 5.6]) == pytest.approx(-1 / 3)
    assert steps([0.01] * 3, iso=[100, 125, 160]) == pytest.approx(1 / 3)


def test_a_phone_s_times_are_what_they_say():
    assert steps([1 / 1437, 1 / 719, 1 / 361]) == pytest.approx(np.log2([1437 / 719, 719 / 361]))


def test_what_is_not_told_of_one_photo_is_left_out_of_all():
    assert steps([1 / 30, 1 / 15], iso=[0.0, 400.0]) == pytest.approx(1.0)
