"""Curves that need no photo, against published values."""

from __future__ import annotations

import numpy as np
import pytest

from facecrf_ocio.errors import SettingsError
from facecrf_ocio.estimators import FIXED_CURVES
from facecrf_ocio.response.fixed import fixed_curve
from facecrf_ocio.response.model import dorf_model

ENCODED = np.linspace(0.0, 1.0, 256)


def curve(name, encoded=ENCODED):
    return fixed_curve(name, np.asarray(encoded, float), dorf_model())


@pytest.mark.parametrize("name", FIXED_CURVES)
def test_every_one_runs_from_0_to_1_and_rises(name):
    linear = curve(name)
    assert (linear[0], linear[-1]) == (0.0, pytest.approx(1.0))
    assert (np.diff(linear) > 0).all()


def test_srgb_has_its_standard_s_values():
    """IEC 61966-2-1: 12.92 up to 0.04045; 50 % gray codes 0.21404, 18 % gray lies at 0.46136."""
    assert curve("srgb", [0.04045, 0.46135613, 0.5, 0.73535698]) == pytest.approx(
        [0.0031308, 0.18, 0.21404114, 0.5], rel=2e-5
    )


def test_the_pieces_of_srgb_meet():
    below, above = curve("srgb", [0.04045, np.nextafter(0.04045, 1)])
    assert above - below < 1e-7


def test_the_others_are_what_they_are_called():
    assert curve("gamma22", [0.5]) == pytest.approx([0.5**2.2])
    assert np.array_equal(curve("identity"), ENCODED)
    assert np.array_equal(curve("mean", dorf_model().grid), dorf_model().mean)


def test_an_unknown_one_is_refused_with_those_that_are_known():
    with pytest.raises(SettingsError, match="no fixed curve 'log'; known: mean, srgb"):
        curve("log")
